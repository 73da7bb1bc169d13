//! Carrying out a plan: which runs are still to be done, and doing them in worker processes.

pub mod event;
pub mod local;
pub mod signals;
pub mod slurm;
pub mod worker;

use std::fs::{self, TryLockError};
use std::path::{Path, PathBuf};

use reports::schema::{Manifest, Outcome};
use reports::store::layout;

use crate::error::HarnessError;
use crate::protocol::plan::Plan;
use crate::run::folder::{self, State};
use crate::run::manifest::manifest;

/// A run of the plan with its folder and what was found there.
pub struct Job {
    /// The run's manifest.
    pub manifest: Manifest,
    /// Training steps it will take.
    pub steps: u64,
    /// Its folder.
    pub folder: PathBuf,
    /// What the folder held.
    pub state: State,
}

/// Compares the plan with the results folder and changes nothing.
///
/// # Errors
/// [`HarnessError`] if any run was recorded with another config or cannot be read.
pub fn survey(plan: &Plan, results: &Path) -> Result<Vec<Job>, HarnessError> {
    let jobs = plan.runs.iter().map(|run| {
        let manifest = manifest(run);
        let folder = layout::run_dir(results, &run.key);
        let state = folder::inspect(&folder, &manifest)?;
        Ok(Job { manifest, steps: run.config.budget.steps, folder, state })
    });
    jobs.collect()
}

/// Name of the file that a [`Lock`] is on.
const LOCK: &str = ".lock";

/// Holds a folder for one process: a results folder for one `goalbench run`, a run's folder for one worker. Released when
/// dropped or when the process ends, however it ends.
pub struct Lock {
    _file: fs::File,
}

impl Lock {
    /// Creates the folder if need be and takes it.
    ///
    /// # Errors
    /// [`HarnessError::Locked`] if another process has it, [`HarnessError::Io`] if it cannot be written.
    pub fn take(results: &Path) -> Result<Self, HarnessError> {
        fs::create_dir_all(results).map_err(HarnessError::io(results, "create this folder"))?;
        let path = results.join(LOCK);
        let file = fs::File::create(&path).map_err(HarnessError::io(results, "write in this folder"))?;
        match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::WouldBlock) => Err(HarnessError::Locked { folder: results.to_owned() }),
            Err(TryLockError::Error(source)) => {
                Err(HarnessError::Io { path, action: "lock this file", source })
            }
        }
    }
}

/// Whether some process holds `folder`. Looking takes a shared lock for a moment, so that two who look do not see each other.
pub fn is_locked(folder: &Path) -> bool {
    fs::File::open(folder.join(LOCK))
        .is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// How a run of the plan came out.
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
        /// How, with the end of what it said.
        reason: String,
    },
}

impl Ending {
    /// Whether the budget was used up.
    pub fn is_finished(&self) -> bool {
        matches!(self, Self::Ended(Outcome::Finished { .. }))
    }
}
