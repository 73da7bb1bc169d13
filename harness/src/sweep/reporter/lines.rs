//! Plain lines: one for every evaluation and ending.

use std::sync::Mutex;

use reports::wording::counted;

use super::tally::{Running, Tally};
use super::{Reporter, ending_text};
use crate::console;
use crate::pace::{self, human};
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};

/// Writes to standard error.
pub(super) struct Lines(Mutex<Tally>);

impl Lines {
    pub(super) fn new(jobs: &[Job], parallel: usize) -> Self {
        let lines = Self(Mutex::new(Tally::new(jobs)));
        let open = jobs.iter().filter(|job| job.is_open()).count();
        lines.note(&format!("{}, {open} to do, {parallel} at a time", counted(jobs.len(), "run")));
        lines
    }
}

impl Reporter for Lines {
    fn started(&self, job: &Job) {
        self.0.lock().expect("no holder of this lock panics").started(job);
    }

    fn event(&self, job: &Job, event: &Event) {
        let mut tally = self.0.lock().expect("no holder of this lock panics");
        let speed = tally.heard(job, event).and_then(Running::steps_per_s);
        let Event::Evaluated { step, success_rate } = event else { return };
        let speed = speed.map_or(String::new(), |speed| format!("  {} steps/s", pace::rounded(speed)));
        let left = tally.left().map_or(String::new(), |left| format!(", {} left", human(left)));
        self.note(&format!(
            "{}  step {}  success {success_rate:.2}{speed}  | all: {}{left}",
            job.run(),
            pace::of_steps(*step, job.steps()),
            tally.of_runs(),
        ));
    }

    fn ended(&self, job: &Job, ending: &Ending) {
        let mut tally = self.0.lock().expect("no holder of this lock panics");
        let last = tally.ended(job, ending);
        let when = last.map_or_else(
            || " (kept from before)".to_owned(),
            |last| format!(" in {}", human(last.elapsed())),
        );
        self.note(&format!("{}  {}{when}  | all: {}", job.run(), ending_text(ending), tally.of_runs()));
    }

    fn note(&self, text: &str) {
        console::complain(text);
    }
}
