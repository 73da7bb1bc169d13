//! What a process tells the one that started it, one JSON line each on its standard output. Standard error is
//! for people.

use std::io::Write;

use reports::schema::Outcome;
use serde::{Deserialize, Serialize};

/// A message of a worker. The last one says how it ended; a worker that was killed sends none.
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
    /// A signal stopped the run, and a checkpoint is saved.
    Stopped {
        /// Training steps so far.
        step: u64,
    },
    /// The run has ended.
    Ended {
        /// How.
        outcome: Outcome,
    },
    /// Another process is carrying out the run.
    Taken,
    /// What it was asked to do cannot be done, however often it is tried.
    Refused {
        /// Why.
        reason: String,
    },
    /// Something failed that may go better another time.
    Broken {
        /// What.
        reason: String,
    },
}

impl Event {
    /// Tells this process' parent.
    ///
    /// # Errors
    /// `BrokenPipe` if it is gone.
    pub fn send(&self) -> std::io::Result<()> {
        let mut line = serde_json::to_vec(self)?;
        line.push(b'\n');
        let mut out = std::io::stdout().lock();
        out.write_all(&line)?;
        out.flush()
    }
}
