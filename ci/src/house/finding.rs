//! A place that breaks a rule.

use std::fmt;

/// Where, and which rule.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Finding {
    /// The rule in one sentence.
    pub(crate) rule: &'static str,
    /// The file, from the project folder.
    pub(crate) file: String,
    /// Line, from 1.
    pub(crate) line: usize,
    /// What is there.
    pub(crate) what: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rule, file, line, what } = self;
        write!(formatter, "{file}:{line}: {what} ({rule})")
    }
}
