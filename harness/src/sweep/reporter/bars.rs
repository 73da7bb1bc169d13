//! A bar per run in progress and one for the whole.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use reports::schema::RunKey;

use super::{Reporter, ending_text};
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};

const RUN: &str = "{prefix:<44!} {bar:20} {pos:>7}/{len:7} {msg:13} {per_sec:>12} {eta:>4} left";
const WHOLE: &str = "{prefix:<44!} {bar:20} {msg} {per_sec:>12} {eta:>4} left";

/// Draws on standard error, a terminal.
pub(super) struct Bars {
    screen: MultiProgress,
    whole: ProgressBar,
    runs: usize,
    state: Mutex<Inner>,
}

struct Inner {
    ended: usize,
    bars: BTreeMap<RunKey, ProgressBar>,
}

impl Bars {
    pub(super) fn new(jobs: &[Job], parallel: usize) -> Self {
        let open = jobs.iter().filter(|job| job.is_open());
        let screen = MultiProgress::new();
        let whole = screen.add(ProgressBar::new(open.map(|job| job.steps()).sum()).with_style(style(WHOLE)));
        whole.set_prefix(format!("all runs, {parallel} at a time"));
        whole.enable_steady_tick(Duration::from_millis(500));
        let state = Mutex::new(Inner { ended: 0, bars: BTreeMap::new() });
        let bars = Self { screen, whole, runs: jobs.len(), state };
        bars.show_count(0);
        bars
    }

    fn show_count(&self, ended: usize) {
        self.whole.set_message(format!("{ended}/{} runs", self.runs));
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is a constant").progress_chars("=> ")
}

impl Reporter for Bars {
    fn started(&self, job: &Job) {
        let bar = ProgressBar::new(0).with_style(style(RUN)).with_prefix(job.run().to_string());
        let bar = self.screen.insert_before(&self.whole, bar);
        self.state.lock().expect("no holder of this lock panics").bars.insert(job.run().clone(), bar);
    }

    fn event(&self, job: &Job, event: &Event) {
        let state = self.state.lock().expect("no holder of this lock panics");
        let Some(bar) = state.bars.get(job.run()) else { return };
        if let Event::Evaluated { success_rate, .. } = event {
            bar.set_message(format!("success {success_rate:.2}"));
        }
        if let Event::Step { step } | Event::Evaluated { step, .. } = event {
            let step = (*step).min(job.steps());
            if bar.length() == Some(0) {
                // A worker's first message. Steps that its checkpoint brings along say nothing of this
                // sweep's speed.
                bar.set_length(job.steps());
                bar.set_position(step);
                bar.reset_eta();
                self.whole.set_length(self.whole.length().unwrap_or(0).saturating_sub(step));
                return;
            }
            self.whole.inc(step.saturating_sub(bar.position()));
            bar.set_position(step);
        }
    }

    fn ended(&self, job: &Job, ending: &Ending) {
        let mut state = self.state.lock().expect("no holder of this lock panics");
        state.ended += 1;
        if let Some(bar) = state.bars.remove(job.run()) {
            self.whole.inc(job.steps().saturating_sub(bar.position()));
            let last = bar.message();
            bar.finish_and_clear();
            self.note(&format!("{}  {}  {last}", job.run(), ending_text(ending)));
        }
        self.show_count(state.ended);
        if state.ended == self.runs {
            self.whole.finish_and_clear();
        }
    }

    fn note(&self, text: &str) {
        // A terminal that went away must not stop a sweep.
        let _ = self.screen.println(guard::text::shown(text));
    }
}
