//! Checkpoints: everything that a run is between two cycles, so that a killed run goes on as if nothing had
//! happened.
//!
//! `checkpoint.bin` holds the state, sealed with magic, version and CRC-32; the replay buffer's episodes lie
//! in the log beside it, which only grows. The file is replaced atomically after the log is written, so that
//! it fits the log whenever the process dies.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use agents::Seal;
pub use reports::store::layout::{CHECKPOINT, REPLAY};
use serde::{Deserialize, Serialize};

use super::folder::Extent;
use super::state::TrainerState;
use crate::files::new_file;

const SEAL: Seal = Seal { magic: *b"GBCK", version: 4, what: "a checkpoint" };

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
    /// It is not what was written.
    #[error("{path}: {reason}; delete this run's folder to train it anew")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
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
    file.persist(&path).map_err(|error| io(error.error))?;
    Ok(())
}

/// Reads the checkpoint of the run with manifest hash `run` in `folder`; `None` if there is none.
///
/// # Errors
/// [`CheckpointError::Damaged`] if it is cut off, altered, of another version or of another config.
pub fn read(folder: &Path, run: &str) -> Result<Option<Checkpoint>, CheckpointError> {
    let path = folder.join(CHECKPOINT);
    let bytes = match fs::read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(CheckpointError::Io { path, action: "read this checkpoint", source }),
    };
    let checkpoint: Checkpoint = SEAL
        .open(&bytes)
        .map_err(|error| CheckpointError::Damaged { path: path.clone(), reason: error.to_string() })?;
    if checkpoint.run != run {
        return Err(CheckpointError::Damaged {
            path,
            reason: "it belongs to a run with another config".into(),
        });
    }
    Ok(Some(checkpoint))
}
