//! A bar per run in progress and one for the whole.

use std::collections::BTreeMap;
use std::sync::Mutex;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use reports::schema::RunKey;

use super::row::Row;
use super::tally::{Running, Tally};
use super::{Reporter, ending_text};
use crate::console;
use crate::pace;
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};

/// Draws on standard error, a terminal whose width is known.
pub(super) struct Bars {
    screen: MultiProgress,
    whole: ProgressBar,
    name: String,
    state: Mutex<Inner>,
}

struct Inner {
    tally: Tally,
    bars: BTreeMap<RunKey, ProgressBar>,
}

impl Bars {
    pub(super) fn new(jobs: &[Job], parallel: usize) -> Self {
        let screen = MultiProgress::new();
        let whole = screen.add(line());
        let state = Inner { tally: Tally::new(jobs), bars: BTreeMap::new() };
        let bars =
            Self { screen, whole, name: format!("all runs, {parallel} at a time"), state: Mutex::new(state) };
        bars.show_whole(&Tally::new(jobs));
        bars
    }

    fn show_whole(&self, tally: &Tally) {
        let row = Row {
            name: &self.name,
            share: tally.share(),
            count: tally.of_runs(),
            success: None,
            steps_per_s: tally.steps_per_s(),
            left: tally.left(),
        };
        show(&self.whole, &row);
    }
}

/// A line of the screen that is written anew with every message.
fn line() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg}").expect("the template is a constant");
    ProgressBar::new_spinner().with_style(style)
}

/// Shows `row` as wide as the terminal is now. Its last column stays free: some terminals wrap there.
fn show(bar: &ProgressBar, row: &Row<'_>) {
    bar.set_message(row.fit(console::columns().unwrap_or(console::FEWEST_COLUMNS) - 1));
}

fn of_run<'a>(job: &Job, name: &'a str, running: Option<&Running>) -> Row<'a> {
    let step = running.map_or(0, |running| running.step);
    Row {
        name,
        share: (step as f64 / job.steps().max(1) as f64).min(1.0),
        count: pace::of_steps(step, job.steps()),
        success: running.and_then(|running| running.success),
        steps_per_s: running.and_then(Running::steps_per_s),
        left: running.and_then(|running| running.left(job.steps())),
    }
}

impl Reporter for Bars {
    fn started(&self, job: &Job) {
        let mut state = self.state.lock().expect("no holder of this lock panics");
        state.tally.started(job);
        let bar = self.screen.insert_before(&self.whole, line());
        show(&bar, &of_run(job, &job.run().to_string(), None));
        state.bars.insert(job.run().clone(), bar);
    }

    fn event(&self, job: &Job, event: &Event) {
        let state = &mut *self.state.lock().expect("no holder of this lock panics");
        let (Some(bar), Some(progress)) = (state.bars.get(job.run()), state.tally.heard(job, event)) else {
            return;
        };
        show(bar, &of_run(job, &job.run().to_string(), Some(progress)));
        self.show_whole(&state.tally);
    }

    fn ended(&self, job: &Job, ending: &Ending) {
        let state = &mut *self.state.lock().expect("no holder of this lock panics");
        let last = state.tally.ended(job, ending);
        if let Some(bar) = state.bars.remove(job.run()) {
            bar.finish_and_clear();
            let success = last.and_then(|progress| progress.success);
            let success = success.map_or(String::new(), |rate| format!("  success {rate:.2}"));
            self.note(&format!("{}  {}{success}", job.run(), ending_text(ending)));
        }
        self.show_whole(&state.tally);
    }

    fn note(&self, text: &str) {
        // A terminal that went away must not stop a sweep.
        let _ = self.screen.println(guard::text::shown(text));
    }
}

impl Drop for Bars {
    fn drop(&mut self) {
        self.whole.finish_and_clear();
    }
}
