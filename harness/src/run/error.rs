//! What ends a run early.

use agents::AgentError;
use curricula::CurriculumError;
use envs::EnvError;

/// Why a run cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The environment broke down.
    #[error(transparent)]
    Environment(#[from] EnvError),
    /// The student broke down.
    #[error(transparent)]
    Student(#[from] AgentError),
    /// The teacher broke down.
    #[error(transparent)]
    Teacher(#[from] CurriculumError),
    /// The teacher asked for a goal that the pool does not hold.
    #[error("the curriculum proposed pool goal {index}, but the pool holds {size}")]
    NoSuchGoal {
        /// What it asked for.
        index: usize,
        /// Goals in the pool.
        size: usize,
    },
    /// What a shadow answered cannot be used; the run itself is well.
    #[error(transparent)]
    Shadow(Box<dyn std::error::Error + Send + Sync>),
    /// The checkpoint is that of a run with other shadows.
    #[error("the checkpoint holds the shadows [{found}], but the run has [{own}]")]
    OtherShadows {
        /// Those of the checkpoint.
        found: String,
        /// Those of the run.
        own: String,
    },
    /// The student's experience cannot be kept; the run itself is well.
    #[error("cannot save a checkpoint")]
    Unsaved(#[source] AgentError),
    /// Something cannot be recorded; the run itself is well.
    #[error("cannot record")]
    Unrecorded(#[from] std::io::Error),
}

impl RunError {
    /// Whether libtorch failed, in the student or in a teacher. Shapes were checked before, so the machine is
    /// to blame: there is no memory, or a device went away.
    pub(crate) fn is_libtorch(&self) -> bool {
        matches!(
            self,
            Self::Student(AgentError::Torch(_))
                | Self::Teacher(CurriculumError::Student(AgentError::Torch(_)))
        )
    }
}
