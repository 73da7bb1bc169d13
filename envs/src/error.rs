//! What can go wrong with an environment.

use std::path::PathBuf;

/// Errors of environments. Each message says what was expected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EnvError {
    /// No environment has this id.
    #[error("unknown environment `{id}`; there are {}", known.join(", "))]
    Unknown {
        /// The id asked for.
        id: String,
        /// The ids there are.
        known: Vec<&'static str>,
    },
    /// No suite has this name.
    #[error("unknown suite `{name}`; there are {}", known.join(", "))]
    UnknownSuite {
        /// The name asked for.
        name: String,
        /// The suites there are.
        known: Vec<&'static str>,
    },
    /// A goal of the wrong length.
    #[error("{env}: a goal has {expected} numbers, got {got}")]
    GoalLength {
        /// Environment id.
        env: &'static str,
        /// G.
        expected: usize,
        /// What came.
        got: usize,
    },
    /// An action of the wrong length.
    #[error("{env}: an action has {expected} numbers, got {got}")]
    ActionLength {
        /// Environment id.
        env: &'static str,
        /// A.
        expected: usize,
        /// What came.
        got: usize,
    },
    /// NaN or infinity where a number is needed.
    #[error("{env}: {what}[{index}] is {value}; every number must be finite")]
    NotFinite {
        /// Environment id.
        env: &'static str,
        /// `action` or `goal`.
        what: &'static str,
        /// Position in it.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// The simulation left the range where it means anything.
    #[error("{env}: the simulation became unstable: {reason}")]
    Unstable {
        /// Environment id.
        env: &'static str,
        /// MuJoCo's warning or the non-finite quantity.
        reason: String,
    },
    /// A model file is missing or damaged.
    #[error("{}: {reason}; `cargo setup` restores it", path.display())]
    Asset {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
        /// What the system or MuJoCo says about it.
        source: Option<Box<dyn std::error::Error + Send + Sync>>,
    },
    /// Another libmujoco than the one the environments were checked against.
    #[error("libmujoco {loaded} is loaded, {expected} is needed; `cargo setup` restores it")]
    MujocoVersion {
        /// Version at hand.
        loaded: String,
        /// Version needed.
        expected: &'static str,
    },
}
