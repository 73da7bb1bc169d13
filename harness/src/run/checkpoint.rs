//! Checkpoints: everything that a run is between two cycles, so that a killed run goes on as if nothing had
//! happened.
//!
//! `checkpoint.bin` holds the state, sealed with magic, version and CRC-32; the replay buffer's episodes lie
//! in the log beside it, which only grows. The file is replaced atomically after the log is written, so that
//! it fits the log whenever the process dies.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use agents::{Seal, SealError};
use reports::schema::Manifest;
use reports::store::checksums::is_hash_of;
pub use reports::store::layout::{CHECKPOINT, REPLAY};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::folder::{CommonExtent, Extent, MeasuredExtent};
use super::state::{ProbedState, TrainerState, TrainingState};
use crate::error::HarnessError;
use crate::files::new_file;

const SEAL: Seal = Seal { magic: *b"GBCK", version: 7, what: "a checkpoint" };

/// The version of programs without shadows: their runs can still be used.
const WITHOUT_SHADOWS: Seal = Seal { version: 6, ..SEAL };

/// The version of programs that did not measure the frontier either.
const WITHOUT_FRONTIER: Seal = Seal { version: 5, ..SEAL };

/// The version of programs without probe rollouts either.
const WITHOUT_ROLLOUTS: Seal = Seal { version: 4, ..SEAL };

/// A run between two cycles.
#[derive(Serialize, Deserialize)]
pub struct Checkpoint {
    /// Hash of the run's manifest: a checkpoint of another config is never taken up.
    pub run: String,
    /// Student, teacher, streams and counters.
    pub trainer: TrainerState,
    /// How far the records had come.
    pub progress: Extent,
}

/// The same as earlier programs wrote it.
#[derive(Deserialize)]
struct EarlierCheckpoint<T, P> {
    run: String,
    trainer: T,
    progress: P,
}

impl<T: Into<ProbedState>, P: Into<Extent>> From<EarlierCheckpoint<T, P>> for Checkpoint {
    fn from(EarlierCheckpoint { run, trainer, progress }: EarlierCheckpoint<T, P>) -> Self {
        Self { run, trainer: trainer.into().into(), progress: progress.into() }
    }
}

/// The checkpoint that `bytes` are.
fn open(bytes: &[u8]) -> Result<Checkpoint, SealError> {
    /// What a program of an earlier version wrote.
    fn earlier<T, P>(seal: Seal, bytes: &[u8]) -> Result<Checkpoint, SealError>
    where
        T: DeserializeOwned + Into<ProbedState>,
        P: DeserializeOwned + Into<Extent>,
    {
        seal.open::<EarlierCheckpoint<T, P>>(bytes).map(Checkpoint::from)
    }
    match SEAL.open(bytes) {
        Err(SealError::Version { found, .. }) if found == WITHOUT_SHADOWS.version => {
            earlier::<ProbedState, MeasuredExtent>(WITHOUT_SHADOWS, bytes)
        }
        Err(SealError::Version { found, .. }) if found == WITHOUT_FRONTIER.version => {
            earlier::<ProbedState, CommonExtent>(WITHOUT_FRONTIER, bytes)
        }
        Err(SealError::Version { found, .. }) if found == WITHOUT_ROLLOUTS.version => {
            earlier::<TrainingState, CommonExtent>(WITHOUT_ROLLOUTS, bytes)
        }
        opened => opened,
    }
}

/// Why a checkpoint cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// It cannot be read or written.
    #[error("{path}: cannot {action}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried, as in `read this checkpoint`.
        action: &'static str,
        /// Why it failed.
        source: std::io::Error,
    },
    /// A program of another version wrote it.
    #[error("{path}: {source}")]
    Version {
        /// The file.
        path: PathBuf,
        /// Which version.
        source: SealError,
    },
    /// It is not what was written.
    #[error("{path}: {reason}; delete this run's folder to train it anew")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

impl From<CheckpointError> for HarnessError {
    fn from(error: CheckpointError) -> Self {
        let (path, reason) = match error {
            CheckpointError::Io { path, action, source } => return Self::Io { path, action, source },
            CheckpointError::Version { path, source } => (path, source.to_string()),
            CheckpointError::Damaged { path, reason } => (path, reason),
        };
        let reason = format!("{reason}; delete this run's folder to train it anew");
        Self::Damaged { path, reason }
    }
}

/// Replaces the checkpoint in `folder`, whole or not at all.
///
/// # Errors
/// [`CheckpointError::Io`]; the old checkpoint then stays.
pub fn write(folder: &Path, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
    let path = folder.join(CHECKPOINT);
    let io = |source| CheckpointError::Io { path: path.clone(), action: "write this checkpoint", source };
    let mut file = new_file(folder).map_err(io)?;
    file.write_all(&SEAL.close(checkpoint)).map_err(io)?;
    file.as_file().sync_all().map_err(io)?;
    guard::fresh::put(file, &path).map_err(io)?;
    Ok(())
}

/// Reads the checkpoint of the run of `manifest` in `folder`; `None` if there is none. It may be older than
/// the run's present budget.
///
/// # Errors
/// [`CheckpointError::Damaged`] if it is cut off, altered or of another config; [`CheckpointError::Version`].
pub fn read(folder: &Path, manifest: &Manifest) -> Result<Option<Checkpoint>, CheckpointError> {
    let path = folder.join(CHECKPOINT);
    let bytes = match guard::files::read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(CheckpointError::Io { path, action: "read this checkpoint", source }),
    };
    let checkpoint: Checkpoint = match open(&bytes) {
        Ok(checkpoint) => checkpoint,
        Err(source @ SealError::Version { .. }) => return Err(CheckpointError::Version { path, source }),
        Err(error) => return Err(CheckpointError::Damaged { path, reason: error.to_string() }),
    };
    if !is_hash_of(&checkpoint.run, manifest) {
        return Err(CheckpointError::Damaged {
            path,
            reason: "it belongs to a run with another config".into(),
        });
    }
    Ok(Some(checkpoint))
}

#[cfg(test)]
mod tests {
    use reports::schema::Teaching;

    use super::*;
    use crate::config::streams::{StreamSeeds, Streams};

    #[test]
    fn checkpoints_of_earlier_programs_are_still_read() {
        let training = || TrainingState {
            step: 200,
            evaluations: 3,
            streams: Streams::new(&StreamSeeds::default(), 0),
            teaching: Teaching::default(),
            ranks: Default::default(),
            student: vec![1, 2],
            teacher: Vec::new(),
        };
        let progress = CommonExtent::default();
        let four = WITHOUT_ROLLOUTS.close(&("hash", &training(), &progress));
        let probed = || ProbedState::from(training());
        let five = WITHOUT_FRONTIER.close(&("hash", &probed(), &progress));
        let six = WITHOUT_SHADOWS.close(&("hash", &probed(), &MeasuredExtent::default()));
        for bytes in [four, five, six] {
            let read = open(&bytes).expect("a checkpoint of an earlier version");
            let steps = (read.trainer.step(), read.trainer.training_steps());
            assert_eq!((read.run.as_str(), steps), ("hash", (200, 200)));
            assert_eq!(read.trainer.student(), [1, 2]);
            assert_eq!(read.progress, Extent::default());
            let again = open(&SEAL.close(&read)).expect("what this program writes");
            assert_eq!(again.trainer.step(), 200);
        }
        let unknown = Seal { version: 3, ..SEAL }.close(&0u8);
        assert!(matches!(open(&unknown), Err(SealError::Version { found: 3, own: 7, .. })));
    }
}
