//! What a user sees while runs go on: bars on a terminal, plain lines elsewhere, JSON lines for scripts.

mod bars;
mod json;
mod lines;

use std::io::IsTerminal;
use std::time::Duration;

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

/// Bars if standard error is a terminal, lines if not.
pub fn for_stderr(jobs: &[Job], parallel: usize) -> Box<dyn Reporter> {
    if std::io::stderr().is_terminal() {
        Box::new(bars::Bars::new(jobs, parallel))
    } else {
        lines(jobs, parallel)
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

/// `1h 05m`, `3m 20s`, `7s`.
pub(crate) fn human(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, s) => format!("{s}s"),
        (0, m, s) => format!("{m}m {s:02}s"),
        (h, m, _) => format!("{h}h {m:02}m"),
    }
}

/// What is left of `total` steps at the speed seen so far.
fn time_left(done: u64, total: u64, elapsed: Duration) -> Option<Duration> {
    let left = total.saturating_sub(done) as f64 / done as f64;
    Duration::try_from_secs_f64(elapsed.as_secs_f64() * left).ok()
}

/// How a run ended, in words.
fn ending_text(ending: &Ending) -> String {
    use reports::schema::Outcome;
    match ending {
        Ending::Ended(Outcome::Finished { step }) => format!("finished after {step} steps"),
        Ending::Ended(Outcome::Failed { step, reason }) => format!("FAILED at step {step}: {reason}"),
        Ending::Stopped => "stopped; goes on another time".into(),
        Ending::Taken => "left to another process, which is carrying it out".into(),
        Ending::Crashed { reason } => format!("CRASHED: {reason}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_naturally() {
        assert_eq!(human(Duration::from_secs(7)), "7s");
        assert_eq!(human(Duration::from_secs(200)), "3m 20s");
        assert_eq!(human(Duration::from_secs(3900)), "1h 05m");
        assert_eq!(time_left(250, 1000, Duration::from_secs(10)), Some(Duration::from_secs(30)));
        assert_eq!(time_left(0, 1000, Duration::from_secs(10)), None);
    }
}
