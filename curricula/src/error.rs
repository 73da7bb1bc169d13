//! What can go wrong with a teacher.

use std::error::Error;

/// Errors of teachers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CurriculumError {
    /// A value of the config is out of its range.
    #[error("{field}: {reason}")]
    Config {
        /// The field within the method's table, as in `window`.
        field: String,
        /// What was wrong, and what is accepted.
        reason: String,
    },
    /// Values that must be finite are not.
    #[error("{what} of goal {index} is {value}; every value must be finite")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// Goal index.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Saved state that does not fit.
    #[error("saved teacher state: {reason}")]
    State {
        /// What is wrong with it.
        reason: String,
        /// What was found out when it was read.
        source: Option<Box<dyn Error + Send + Sync>>,
    },
    /// The program that teaches does not.
    #[error(transparent)]
    Process(#[from] crate::methods::process::ProcessError),
    /// The student, or networks of the teacher's own, could not answer.
    #[error(transparent)]
    Student(#[from] agents::AgentError),
}

impl CurriculumError {
    /// Refuses the value `got` of `field` unless it is `accepted`, as in "at least 2".
    ///
    /// ```
    /// use curricula::CurriculumError;
    ///
    /// let refused = CurriculumError::require(false, "window", "at least 2", 1).unwrap_err();
    /// assert_eq!(refused.to_string(), "window: must be at least 2, got 1");
    /// ```
    ///
    /// # Errors
    /// [`CurriculumError::Config`] if not `ok`.
    pub fn require(ok: bool, field: &str, accepted: &str, got: impl std::fmt::Display) -> Result<(), Self> {
        if ok {
            Ok(())
        } else {
            Err(Self::Config { field: field.into(), reason: format!("must be {accepted}, got {got}") })
        }
    }
}
