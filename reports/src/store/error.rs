//! What keeps a results folder, or a single file of it, from being read.

use std::io;
use std::path::{Path, PathBuf};

use crate::schema::RunKey;

/// A file that cannot be used, for readers that need all of it. What failed below is the error's source and
/// not part of its text.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The folder is not a results folder.
    #[error(
        "{path}: is no results folder; expected `runs/ENVIRONMENT/CURRICULUM/VARIANT/seed-N/manifest.json` in it"
    )]
    NotResults {
        /// The path given.
        path: PathBuf,
    },
    /// The folder holds the trials of a search, and no run of the experiment yet.
    #[error(
        "{path}: holds the trials of a search and nothing else yet; they are results by themselves, in {}",
        path.join("tuning").display()
    )]
    OnlyTrials {
        /// The path given.
        path: PathBuf,
    },
    /// The system refused.
    #[error("{path}: cannot {action}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried, as in `read this file`.
        action: &'static str,
        /// Why it failed.
        source: io::Error,
    },
    /// A JSON file that is not what was written.
    #[error("{path}: was cut off or altered; delete the folder that it lies in to begin anew")]
    Json {
        /// The file.
        path: PathBuf,
        /// The first thing wrong with it.
        source: serde_json::Error,
    },
    /// A line that is not what the schema says.
    #[error("{path}:{line}: not a valid {expected}")]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What belongs there.
        expected: &'static str,
        /// The first thing wrong with it; its line counts within the single line.
        source: serde_json::Error,
    },
    /// A last line without its newline.
    #[error("{path}:{line}: incomplete last line ({bytes} bytes without a newline)")]
    Incomplete {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// Bytes in it.
        bytes: usize,
    },
    /// A file of a run that is not what it was, or is gone.
    #[error("{path}: {reason}")]
    Altered {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A manifest in the folder of another run.
    #[error("{path}: belongs to the run {found}, whose place is elsewhere")]
    Misplaced {
        /// The manifest.
        path: PathBuf,
        /// The run that it names.
        found: RunKey,
    },
}

impl StoreError {
    /// For `map_err` on file operations: `.map_err(StoreError::io(path, "read this file"))`.
    pub fn io(path: impl Into<PathBuf>, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, action, source }
    }

    /// The file or folder that it is about.
    pub fn path(&self) -> &Path {
        match self {
            Self::NotResults { path }
            | Self::OnlyTrials { path }
            | Self::Io { path, .. }
            | Self::Json { path, .. }
            | Self::Line { path, .. }
            | Self::Incomplete { path, .. }
            | Self::Altered { path, .. }
            | Self::Misplaced { path, .. } => path,
        }
    }

    /// Whether the same file may be read another time: the system refused. Damaged data stays damaged.
    pub fn is_transient(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() != io::ErrorKind::InvalidData)
    }
}

/// For readers that deal with I/O errors: damaged data is [`InvalidData`](io::ErrorKind::InvalidData).
impl From<StoreError> for io::Error {
    fn from(error: StoreError) -> Self {
        let kind = match &error {
            StoreError::Io { source, .. } => source.kind(),
            _ => io::ErrorKind::InvalidData,
        };
        Self::new(kind, error)
    }
}
