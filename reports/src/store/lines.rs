//! JSON Lines, strictly: every line is a value, or it is known what is wrong with it.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::error::StoreError;
use super::problem::Fault;

/// A line that is no value.
pub(super) enum BadLine {
    /// The last one, without its newline.
    Incomplete { bytes: usize },
    /// Not what was expected.
    Json(serde_json::Error),
}

/// Every line of `bytes` with its number, counted from 1.
pub(super) fn parse<T: DeserializeOwned>(bytes: &[u8]) -> impl Iterator<Item = (usize, Result<T, BadLine>)> {
    (1..).zip(bytes.split_inclusive(|&byte| byte == b'\n')).map(|(number, text)| {
        // A writer appends the newline last: without it even a line that parses may be cut (`0.1` of
        // `0.15}`).
        let value = match text.strip_suffix(b"\n") {
            Some(text) => serde_json::from_slice(text).map_err(BadLine::Json),
            None => Err(BadLine::Incomplete { bytes: text.len() }),
        };
        (number, value)
    })
}

impl BadLine {
    /// For readers that use the other lines all the same.
    pub(super) fn fault(self, expected: &'static str) -> Fault {
        match self {
            Self::Incomplete { bytes } => Fault::Incomplete { bytes },
            Self::Json(error) => Fault::Malformed { expected, reason: without_line(&error) },
        }
    }

    /// For readers that need all lines.
    pub(super) fn error(self, path: &Path, line: usize, expected: &'static str) -> StoreError {
        let path = path.to_owned();
        match self {
            Self::Incomplete { bytes } => StoreError::Incomplete { path, line, bytes },
            Self::Json(source) => StoreError::Line { path, line, expected, source },
        }
    }
}

/// The parser's message without its `at line 1`, which counts within the single line it was given.
fn without_line(error: &serde_json::Error) -> String {
    let message = error.to_string();
    match message.rsplit_once(" at line ") {
        Some((what, _)) => format!("{what} at column {}", error.column()),
        None => message,
    }
}
