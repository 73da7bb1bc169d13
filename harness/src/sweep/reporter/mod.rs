//! What a user sees while runs go on: bars on a terminal, plain lines elsewhere, JSON lines for scripts.

mod bars;
mod json;
mod lines;
mod quiet;
mod row;
mod tally;

use reports::wording::counted_u64;

use crate::console;
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};

/// Shows what happens to the runs of a sweep. Several threads call it.
pub trait Reporter: Sync {
    /// A run's worker is started.
    fn started(&self, job: &Job);
    /// A worker told something.
    fn event(&self, job: &Job, event: &Event);
    /// A run has ended, or had ended before.
    fn ended(&self, job: &Job, ending: &Ending);
    /// Anything else worth showing.
    fn note(&self, text: &str);
}

/// How much a user wants to see.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// What goes wrong.
    Quiet,
    /// Bars if standard error is a terminal that can show them, lines if not.
    #[default]
    Fitting,
    /// Lines, whatever standard error is.
    Lines,
}

/// On standard error, in this detail.
pub fn for_stderr(jobs: &[Job], parallel: usize, detail: Detail) -> Box<dyn Reporter> {
    match (detail, console::columns()) {
        (Detail::Quiet, _) => Box::new(quiet::Quiet),
        (Detail::Fitting, Some(_)) => Box::new(bars::Bars::new(jobs, parallel)),
        (Detail::Fitting, None) | (Detail::Lines, _) => lines(jobs, parallel),
    }
}

/// Plain lines, whatever standard error is.
pub fn lines(jobs: &[Job], parallel: usize) -> Box<dyn Reporter> {
    Box::new(lines::Lines::new(jobs, parallel))
}

/// JSON lines, one per event, each handed to `out`.
pub fn json(out: impl Fn(&str) + Sync + 'static) -> Box<dyn Reporter> {
    Box::new(json::Json { out })
}

/// How a run ended, in words.
fn ending_text(ending: &Ending) -> String {
    use reports::schema::Outcome;
    match ending {
        Ending::Ended(Outcome::Finished { step }) => format!("finished after {}", counted_u64(*step, "step")),
        Ending::Ended(Outcome::Failed { step, reason }) => format!("FAILED at step {step}: {reason}"),
        Ending::Stopped => "stopped; goes on another time".into(),
        Ending::Taken => "left to another process, which is carrying it out".into(),
        Ending::Crashed { reason } => format!("CRASHED: {reason}"),
    }
}
