//! What stops a report from being made.

use std::error::Error;
use std::path::{Path, PathBuf};

use crate::store::StoreError;
use crate::store::problem::StoreProblem;
use crate::wording::counted;

/// Errors of this crate. What failed below is an error's source, not part of its text. What is wrong with
/// single files of a results folder is a [`StoreProblem`] instead: it is reported beside the figures and
/// never stops them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The results cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A results folder in which no evaluation can be used.
    #[error("{path}: no evaluation to report: {}, {}", counted(*runs, "readable run"), counted(problems.len(), "problem"))]
    NoRecords {
        /// The results folder.
        path: PathBuf,
        /// Runs whose manifest could be read.
        runs: usize,
        /// What is wrong with the files at hand.
        problems: Vec<StoreProblem>,
    },
    /// An option outside its range.
    #[error("option {option} is {value}; expected {accepted}")]
    Option {
        /// Name of the field of [`Options`](crate::ReportOptions).
        option: &'static str,
        /// The value given.
        value: String,
        /// What is accepted.
        accepted: &'static str,
    },
    /// A part of the results that is not there.
    #[error("--{option}: no run of the results has {value}; accepted: {there}")]
    NotInResults {
        /// Name of the field of [`Options`](crate::ReportOptions).
        option: &'static str,
        /// The name that was asked for.
        value: String,
        /// The names that runs have.
        there: String,
    },
    /// Results of others that cannot be drawn beside these.
    #[error("{name}: {reason}")]
    Guest {
        /// Their name.
        name: String,
        /// Why not.
        reason: String,
    },
    /// Something in the place of a report's file that no report wrote.
    #[error(
        "{path}: is in the way of the report, and {list} beside the page does not say that a report wrote it{}; nothing \
         was written. Move it, or the whole folder, to another place",
        more(*others)
    )]
    InTheWay {
        /// The first such file or folder.
        path: PathBuf,
        /// How many others there are.
        others: usize,
        /// Name of the list of a report's files.
        list: &'static str,
    },
    /// A folder or file that cannot be read or written.
    #[error("{path}: cannot {action}")]
    Io {
        /// The folder or file.
        path: PathBuf,
        /// What was tried, as in `write this file`.
        action: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// A data frame could not be built or written.
    #[error("cannot hold a table's data")]
    Frame(#[from] polars::error::PolarsError),
    /// A figure could not be drawn.
    #[error("cannot draw {figure}")]
    Figure {
        /// Which figure, or which part of one.
        figure: String,
        /// What failed.
        source: Box<dyn Error + Send + Sync>,
    },
}

/// ` (and 3 more)`; nothing for none.
fn more(others: usize) -> String {
    if others == 0 { String::new() } else { format!(" (and {others} more)") }
}

impl ReportError {
    /// For `map_err` on file operations at `path`.
    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::Io { path, action, source }
    }

    /// For `map_err` on drawing `figure`, or a part of one.
    pub(crate) fn figure<E: Into<Box<dyn Error + Send + Sync>>>(
        figure: &str,
    ) -> impl FnOnce(E) -> Self + use<E> {
        let figure = figure.to_owned();
        move |source| Self::Figure { figure, source: source.into() }
    }
}
