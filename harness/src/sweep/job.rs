//! A run of a sweep, before and after.

use std::path::PathBuf;

use reports::schema::{Manifest, Outcome, RunKey};

use crate::config::RunConfig;
use crate::run::folder::State;

/// A run of the plan with its folder and what was found there.
#[derive(Clone, Debug)]
pub struct Job {
    /// The run's manifest.
    pub manifest: Manifest,
    /// The config in it.
    pub config: RunConfig,
    /// Its folder.
    pub folder: PathBuf,
    /// What the folder held.
    pub state: State,
}

impl Job {
    /// Which run it is.
    pub fn run(&self) -> &RunKey {
        &self.manifest.run
    }

    /// Training steps that the run takes.
    pub fn steps(&self) -> u64 {
        self.config.budget.steps
    }

    /// Whether it is still to be done.
    pub fn is_open(&self) -> bool {
        !matches!(self.state, State::Ended(_))
    }
}

/// How a run of a sweep came out.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// It ended as its outcome says, now or earlier.
    Ended(Outcome),
    /// A signal stopped it; it goes on from its checkpoint another time.
    Stopped,
    /// Another process is carrying it out: a job array beside a local sweep, for one.
    Taken,
    /// Its workers went away without an outcome.
    Crashed {
        /// What the last of them said, or how it ended.
        reason: String,
    },
}
