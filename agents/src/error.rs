//! What can go wrong with a student. An error's text never repeats its cause, which is its source.

use std::path::PathBuf;

use crate::seal::SealError;

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
    #[error("saved student state")]
    State {
        /// What is wrong with it.
        source: StateProblem,
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
    #[error("device {device}")]
    Device {
        /// The device.
        device: &'static str,
        /// What is missing. A process tries a device only once and remembers the outcome.
        source: &'static DeviceProblem,
    },
    /// Products on a GPU cannot be rounded as asked for.
    #[error("student.tf32")]
    Tf32(#[from] SwitchProblem),
    /// libtorch refused an operation.
    #[error("libtorch")]
    Torch(#[source] TorchError),
}

impl From<tch::TchError> for AgentError {
    fn from(error: tch::TchError) -> Self {
        Self::Torch(TorchError(error))
    }
}

impl AgentError {
    /// A state that is whole, but of another student.
    pub(crate) fn misfit(reason: String) -> Self {
        Self::State { source: StateProblem::Misfit(reason) }
    }
}

/// What is wrong with a saved state.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StateProblem {
    /// It is something else, of another version, cut off or altered.
    #[error(transparent)]
    Sealed(#[from] SealError),
    /// It is not an ensemble's.
    #[error("no ensemble")]
    Ensemble(#[source] postcard::Error),
    /// It is whole, but belongs to a student of another shape or task.
    #[error("{0}")]
    Misfit(String),
}

/// Why a CUDA device cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceProblem {
    /// Where libtorch was loaded from is unknown.
    #[error("the folder of the loaded libtorch_cpu.so could not be found")]
    NoFolder,
    /// libtorch's CUDA half does not lie beside its CPU half.
    #[error(
        "{} is missing; point LD_LIBRARY_PATH at the lib folder of a CUDA build of libtorch {version}, such as \
         torch/lib in a Python install of it",
        library.display()
    )]
    Missing {
        /// Where it should lie.
        library: PathBuf,
        /// The version of libtorch that this process runs on.
        version: String,
    },
    /// The system does not load it.
    #[error("{} does not load", library.display())]
    Loading {
        /// The file.
        library: PathBuf,
        /// Why not.
        source: libloading::Error,
    },
    /// The trial product has the wrong value.
    #[error("libtorch multiplies wrongly on a CUDA device: 4 is {0}")]
    Wrong(f64),
    /// The trial product failed.
    #[error("libtorch cannot use a CUDA device")]
    Unusable(#[source] TorchError),
}

/// Why libtorch's switch for TF32 is not as it should be.
#[derive(Debug, thiserror::Error)]
pub enum SwitchProblem {
    /// It is not where it is looked for.
    #[error("libtorch {version} does not show its switch for TF32")]
    Missing {
        /// The version of libtorch that this process runs on.
        version: String,
        /// What is missing.
        source: libloading::Error,
    },
    /// It does not do what it is told.
    #[error("libtorch's switch for TF32 stays {0}")]
    Stays(&'static str),
}

/// What libtorch says. Only the first line of its message is shown: the others say where in its own sources
/// something happened.
#[derive(Debug, thiserror::Error)]
#[error("{}", .0.to_string().lines().next().unwrap_or_default())]
pub struct TorchError(pub tch::TchError);

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
