//! What a replay measured.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::mujoco::Physics;

/// The outcome of replaying one file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileReport {
    /// The file. Where it is written as JSON, what is no UTF-8 in its name is replaced by U+FFFD.
    #[serde(serialize_with = "as_text")]
    pub file: PathBuf,
    /// Registry id of the environment.
    pub environment: &'static str,
    /// The physics it was recorded with; none for mazes.
    pub physics: Option<Physics>,
    /// Largest absolute deviation that passes after a simulated step.
    pub tolerance: f64,
    /// Replayed traces.
    pub traces: usize,
    /// Replayed steps of all traces.
    pub steps: usize,
    /// Replayed resets.
    pub resets: usize,
    /// Largest absolute deviations.
    pub deviations: Deviations,
    /// Steps with another reward.
    pub reward_mismatches: usize,
    /// Steps with another success.
    pub success_mismatches: usize,
    /// The first difference beyond the tolerance.
    pub first_failure: Option<Divergence>,
    /// Entries of `meta` with no counterpart in the environment, such as versions of Python packages.
    pub not_compared: Vec<String>,
}

fn as_text<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

impl FileReport {
    /// Whether everything agreed.
    pub fn passed(&self) -> bool {
        self.first_failure.is_none()
    }
}

/// Largest absolute deviations, in the units of each quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Deviations {
    /// Of observations.
    pub observation: f64,
    /// Of achieved goals.
    pub achieved_goal: f64,
    /// Of positions.
    pub qpos: f64,
    /// Of velocities.
    pub qvel: f64,
    /// Of the goals that resets draw.
    pub goal: f64,
    /// Of the constants in `meta`.
    pub constants: f64,
}

/// Two values that should agree and do not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Divergence {
    /// Where.
    pub place: Place,
    /// Which quantity.
    pub field: String,
    /// Its component; none for a value that is no list.
    pub index: Option<usize>,
    /// The recorded value.
    pub expected: Value,
    /// Ours.
    pub got: Value,
}

/// A place in a trace file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Place {
    /// The constants.
    Meta,
    /// The reset with this index, from 0.
    Reset(usize),
    /// A trace.
    Trace {
        /// Its index, from 0.
        trace: usize,
        /// The seed it was recorded with; `x` for the scripted one.
        seed: String,
        /// The step, from 1; 0 is the start.
        step: usize,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Meta => write!(f, "meta"),
            Self::Reset(index) => write!(f, "reset {index}"),
            Self::Trace { trace, seed, step: 0 } => write!(f, "trace {trace} (seed {seed}), start"),
            Self::Trace { trace, seed, step } => write!(f, "trace {trace} (seed {seed}), step {step}"),
        }
    }
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.field)?;
        if let Some(index) = self.index {
            write!(f, "[{index}]")?;
        }
        write!(f, " is recorded as {}, replayed as {}", self.expected, self.got)
    }
}
