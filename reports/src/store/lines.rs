//! JSON Lines, strictly: every line is a value or a [`Problem`].

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::store::problem::{Fault, Problem};

/// Parses `bytes`, the content of the file `path` (as named in problems), into `(line, value)` pairs with lines
/// counted from 1. Values that are no `T` (an `expected`, in words) become problems.
pub(super) fn parse<T: DeserializeOwned>(
    bytes: &[u8],
    path: &Path,
    expected: &'static str,
    problems: &mut Vec<Problem>,
) -> Vec<(usize, T)> {
    let mut values = Vec::new();
    let mut fault = |line, fault| problems.push(Problem { path: path.to_owned(), line: Some(line), fault });
    for (index, text) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let line = index + 1;
        // A writer appends the newline last: without it even a line that parses may be cut (`0.1` of `0.15}`).
        let Some(text) = text.strip_suffix(b"\n") else {
            fault(line, Fault::Incomplete { bytes: text.len() });
            continue;
        };
        match serde_json::from_slice(text) {
            Ok(value) => values.push((line, value)),
            Err(error) => fault(line, Fault::Malformed { expected, reason: without_line(&error) }),
        }
    }
    values
}

/// The parser's message without its `at line 1`, which counts within the single line it was given.
fn without_line(error: &serde_json::Error) -> String {
    let message = error.to_string();
    match message.rsplit_once(" at line ") {
        Some((what, _)) => format!("{what} at column {}", error.column()),
        None => message,
    }
}
