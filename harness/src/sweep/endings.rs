//! How a sweep came out.

use reports::schema::{Outcome, RunKey};

use super::exit::ExitCode;
use super::job::{Ending, Job};
use crate::run::folder::State;

/// The endings of all runs of a sweep, in the order of its jobs.
#[derive(Clone, Debug)]
pub struct Endings(Vec<(RunKey, Ending)>);

impl Endings {
    pub(super) fn new(jobs: &[Job], endings: Vec<Ending>) -> Self {
        Self(jobs.iter().map(|job| job.run().clone()).zip(endings).collect())
    }

    /// Of those runs that had ended before.
    pub(super) fn of_ended(jobs: &[Job]) -> Self {
        let ended = jobs.iter().filter_map(|job| match &job.state {
            State::Ended(outcome) => Some((job.run().clone(), Ending::Ended(outcome.clone()))),
            State::New | State::Shorter(_) | State::Begun => None,
        });
        Self(ended.collect())
    }

    /// Every run with its ending.
    pub fn iter(&self) -> impl Iterator<Item = (&RunKey, &Ending)> {
        self.0.iter().map(|(run, ending)| (run, ending))
    }

    /// Number of runs.
    pub fn total(&self) -> usize {
        self.0.len()
    }

    /// Runs that broke down or whose workers crashed for good.
    pub fn failed(&self) -> usize {
        self.count(|ending| matches!(ending, Ending::Crashed { .. } | Ending::Ended(Outcome::Failed { .. })))
    }

    /// Runs that a signal stopped.
    pub fn stopped(&self) -> usize {
        self.count(|ending| matches!(ending, Ending::Stopped))
    }

    /// Runs that were left to another process.
    pub fn taken(&self) -> usize {
        self.count(|ending| matches!(ending, Ending::Taken))
    }

    fn count(&self, which: impl Fn(&Ending) -> bool) -> usize {
        self.0.iter().filter(|(_, ending)| which(ending)).count()
    }

    /// The exit code of the whole: a failure weighs more than a stop.
    pub fn exit_code(&self) -> ExitCode {
        match (self.failed(), self.stopped() + self.taken()) {
            (0, 0) => ExitCode::Success,
            (0, _) => ExitCode::Stopped,
            _ => ExitCode::Failed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_weighs_more_than_a_stop() {
        let run = RunKey {
            environment: "Point".into(),
            curriculum: "teach".into(),
            variant: "default".into(),
            seed: 0,
        };
        let code = |endings: &[Ending]| {
            Endings(endings.iter().map(|ending| (run.clone(), ending.clone())).collect()).exit_code()
        };
        let crashed = Ending::Crashed { reason: "no memory".into() };
        let finished = Ending::Ended(Outcome::Finished { step: 1 });
        assert_eq!(code(std::slice::from_ref(&finished)), ExitCode::Success);
        assert_eq!(code(&[finished, Ending::Taken]), ExitCode::Stopped);
        assert_eq!(code(&[Ending::Stopped, crashed]), ExitCode::Failed);
    }
}
