//! Plain lines: one for every evaluation and ending.

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Mutex;
use std::time::Instant;

use reports::schema::RunKey;

use super::{Reporter, ending_text, human, time_left};
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};

/// Writes to standard error.
pub(super) struct Lines {
    runs: usize,
    /// Steps of all runs that this sweep has to take.
    total_steps: u64,
    begun: Instant,
    state: Mutex<Tally>,
}

#[derive(Default)]
struct Tally {
    ended: usize,
    current: BTreeMap<RunKey, Current>,
    taken_by_ended: u64,
    /// Steps that runs had taken before this sweep.
    brought: BTreeMap<RunKey, u64>,
}

struct Current {
    begun: Instant,
    /// Step at which the worker began: 0, or that of its checkpoint.
    first: Option<u64>,
    step: u64,
}

impl Current {
    /// Steps taken since the worker began.
    fn taken(&self) -> u64 {
        self.step - self.first.unwrap_or(self.step).min(self.step)
    }
}

impl Lines {
    pub(super) fn new(jobs: &[Job], parallel: usize) -> Self {
        let open = jobs.iter().filter(|job| job.is_open());
        let lines = Self {
            runs: jobs.len(),
            total_steps: open.clone().map(|job| job.steps()).sum(),
            begun: Instant::now(),
            state: Mutex::default(),
        };
        lines.note(&format!("{} runs, {} of them to do, {parallel} at a time", jobs.len(), open.count()));
        lines
    }
}

impl Reporter for Lines {
    fn started(&self, job: &Job) {
        let mut state = self.state.lock().expect("no holder of this lock panics");
        state.current.insert(job.run().clone(), Current { begun: Instant::now(), first: None, step: 0 });
    }

    fn event(&self, job: &Job, event: &Event) {
        let mut state = self.state.lock().expect("no holder of this lock panics");
        let Some(current) = state.current.get_mut(job.run()) else { return };
        let (Event::Step { step } | Event::Evaluated { step, .. }) = event else { return };
        current.step = *step;
        let first = *current.first.get_or_insert(*step);
        let Event::Evaluated { step, success_rate } = event else { return };
        let speed = current.taken() as f64 / current.begun.elapsed().as_secs_f64().max(1e-9);
        // This sweep did not take the steps that a checkpoint brought along.
        state.brought.insert(job.run().clone(), first);
        let done = state.taken_by_ended + state.current.values().map(Current::taken).sum::<u64>();
        let total = self.total_steps.saturating_sub(state.brought.values().sum());
        let left = time_left(done, total, self.begun.elapsed());
        let left = left.map_or("?".into(), human);
        self.note(&format!(
            "{}  step {step}/{}  success {success_rate:.2}  {speed:.0} steps/s  | all: {}/{} runs, {left} left",
            job.run(), job.steps(), state.ended, self.runs
        ));
    }

    fn ended(&self, job: &Job, ending: &Ending) {
        let mut state = self.state.lock().expect("no holder of this lock panics");
        state.ended += 1;
        let text = match state.current.remove(job.run()) {
            Some(current) => {
                state.taken_by_ended += current.taken();
                format!("{} in {}", ending_text(ending), human(current.begun.elapsed()))
            }
            None => format!("{} (kept from before)", ending_text(ending)),
        };
        self.note(&format!("{}  {text}  | all: {}/{} runs", job.run(), state.ended, self.runs));
    }

    fn note(&self, text: &str) {
        // A closed standard error must not stop a sweep.
        let _ = writeln!(std::io::stderr(), "{}", guard::text::shown(text));
    }
}
