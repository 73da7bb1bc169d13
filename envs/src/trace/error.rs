//! What can be wrong with a trace file.

use std::path::PathBuf;

use super::Place;
use crate::error::EnvError;
use crate::playback::PlaybackError;

/// A trace file that cannot be replayed.
#[derive(Debug, thiserror::Error)]
#[error("{}", file.display())]
pub struct TraceError {
    /// The file or folder.
    pub file: PathBuf,
    /// What is wrong, and where in the file.
    #[source]
    pub problem: Box<Problem>,
}

/// What is wrong with a trace file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file or folder cannot be read, or the gzip data are damaged.
    #[error(transparent)]
    Read(#[from] std::io::Error),
    /// The folder holds no trace file.
    #[error("no file ends with .json.gz")]
    NoFiles,
    /// The JSON is damaged, or a field is missing, unknown or of another type.
    #[error("{field}")]
    Parse {
        /// The field, such as `traces[1].reward`.
        field: String,
        /// Why.
        source: serde_json::Error,
    },
    /// A constant is not recorded.
    #[error("meta.{field} is missing")]
    Missing {
        /// The constant.
        field: String,
    },
    /// The environment cannot be built, or no environment has this id.
    #[error(transparent)]
    Environment(#[from] EnvError),
    /// The environment has no recorded original.
    #[error("{id} cannot be replayed")]
    NotRecorded {
        /// The environment.
        id: &'static str,
    },
    /// Nothing to replay.
    #[error("holds neither resets nor traces")]
    Empty,
    /// A list has another length than the environment's.
    #[error("{place}: {field} holds {got} numbers, {expected} are needed")]
    Length {
        /// Where.
        place: Place,
        /// The list.
        field: &'static str,
        /// The length needed.
        expected: usize,
        /// The length found.
        got: usize,
    },
    /// The environment refused what was recorded.
    #[error("{place}")]
    Playback {
        /// Where.
        place: Place,
        /// Why.
        source: PlaybackError,
    },
}
