//! What can go wrong with a student. An error says its own part alone; its cause is its source.

use std::path::PathBuf;

/// Errors of students.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AgentError {
    /// A value of the hyper-parameters is out of its range.
    #[error("student.{field}: {reason}")]
    Config {
        /// The field.
        field: &'static str,
        /// What is accepted.
        reason: String,
    },
    /// No student has this name.
    #[error("student.agent: unknown agent `{name}`; accepted: {known}")]
    Unknown {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// Something of the wrong shape.
    #[error("{what} has {got} numbers, {expected} expected")]
    Shape {
        /// What it is.
        what: &'static str,
        /// What fits.
        expected: usize,
        /// What came.
        got: usize,
    },
    /// A network answered NaN or infinity.
    #[error("the {what} is not finite after {gradient_steps} gradient steps")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// When.
        gradient_steps: u64,
    },
    /// Learning diverged.
    #[error("learning diverged: the {what} is not finite at gradient step {gradient_steps}")]
    Diverged {
        /// The quantity.
        what: &'static str,
        /// When.
        gradient_steps: u64,
    },
    /// Learning was asked for before anything was experienced.
    #[error("the replay buffer is empty; observe an episode first")]
    EmptyReplay,
    /// Saved state that does not fit or is damaged.
    #[error("saved student state: {reason}")]
    State {
        /// What is wrong with it.
        reason: String,
    },
    /// The log of the replay buffer cannot be written or read, or is damaged.
    #[error("replay log {path}")]
    Log {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: LogProblem,
    },
    /// The device asked for is not usable here.
    #[error("device {device}: {reason}")]
    Device {
        /// The device.
        device: &'static str,
        /// What is missing.
        reason: String,
    },
    /// libtorch refused an operation. Only the first line of its message is shown: the others say where in
    /// its own sources that happened.
    #[error("libtorch: {}", first_line(.0))]
    Torch(#[from] tch::TchError),
}

/// What is wrong with a file of the replay buffer's log.
#[derive(Debug, thiserror::Error)]
pub enum LogProblem {
    /// The system refused to read or write it.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// It does not hold what it should.
    #[error("{0}")]
    Damaged(String),
}

/// The first line of what libtorch says.
pub(crate) fn first_line(error: &tch::TchError) -> String {
    error.to_string().lines().next().unwrap_or_default().to_owned()
}
