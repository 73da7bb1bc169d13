//! What can go wrong with a program that teaches.

use std::io;
use std::process::ExitStatus;

/// Why a run cannot go on with its program.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProcessError {
    /// It does not start.
    #[error("the curriculum's program `{program}` cannot be started")]
    Start {
        /// What was to be started.
        program: String,
        /// What the system said.
        source: io::Error,
    },
    /// The system does not let it be talked with.
    #[error("cannot talk with the curriculum's program")]
    Talk(#[source] io::Error),
    /// It did not answer in time.
    #[error(
        "the curriculum's program gave no answer to `{message}` within {seconds} s (curriculum.process.timeout){words}"
    )]
    Silent {
        /// What it was to answer.
        message: &'static str,
        /// How long it had, seconds.
        seconds: f64,
        /// What it said last on standard error.
        words: LastWords,
    },
    /// It is no more.
    #[error("the curriculum's program ended ({status}) when it was to answer `{message}`{words}")]
    Ended {
        /// How it ended.
        status: ExitStatus,
        /// What it was to answer.
        message: &'static str,
        /// What it said last on standard error.
        words: LastWords,
    },
    /// It lives, but its standard output does not.
    #[error("the curriculum's program closed its standard output before it answered `{message}`{words}")]
    Closed {
        /// What it was to answer.
        message: &'static str,
        /// What it said last on standard error.
        words: LastWords,
    },
    /// It said something that is no answer.
    #[error(
        "the curriculum's program answered `{message}` with {said}, which is no message of this protocol{hint}"
    )]
    NoMessage {
        /// What it was to answer.
        message: &'static str,
        /// The beginning of what it said.
        said: String,
        /// What may be behind it.
        hint: &'static str,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// It said more than it was asked.
    #[error(
        "the curriculum's program printed {said} when nothing was asked; standard output is for answers alone, \
         everything else belongs on standard error"
    )]
    Unasked {
        /// The beginning of what it said.
        said: String,
    },
    /// Its answer is too long.
    #[error("the curriculum's program answered `{message}` with a line of more than {most} bytes")]
    TooLong {
        /// What it was to answer.
        message: &'static str,
        /// The most that is accepted.
        most: usize,
    },
    /// Its answer does not fit.
    #[error("the curriculum's program answered `{message}` wrongly: {reason}")]
    Wrong {
        /// What it was to answer.
        message: &'static str,
        /// What is wrong with it.
        reason: String,
    },
}

/// The last lines that a program said on standard error, on one line.
#[derive(Debug, Default)]
pub struct LastWords(String);

/// Lines that are kept.
const LINES: usize = 3;
/// The most characters of each.
const LONGEST: usize = 200;

impl LastWords {
    /// Of all that was said.
    pub(super) fn of(text: &[u8]) -> Self {
        let text = String::from_utf8_lossy(text);
        let lines: Vec<String> = text
            .lines()
            .rev()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .take(LINES)
            .map(|line| line.chars().filter(|c| !c.is_control()).take(LONGEST).collect())
            .collect();
        Self(lines.into_iter().rev().collect::<Vec<_>>().join(" | "))
    }
}

impl std::fmt::Display for LastWords {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, "; it had said: {}", self.0) }
    }
}
