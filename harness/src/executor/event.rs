//! What a worker tells its parent, one JSON line each on its standard output.

use reports::schema::Outcome;
use serde::{Deserialize, Serialize};

/// A worker's message.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "lowercase")]
pub enum Event {
    /// Training goes on.
    Step {
        /// Training steps so far.
        step: u64,
    },
    /// An evaluation is recorded.
    Evaluated {
        /// Training steps so far.
        step: u64,
        /// Its success rate.
        success_rate: f64,
    },
    /// The run was stopped by a signal after saving a checkpoint; the last message.
    Stopped {
        /// Training steps so far.
        step: u64,
    },
    /// The run has ended; the last message.
    Ended {
        /// How.
        outcome: Outcome,
    },
}
