//! What a process tells the one that started it, one JSON line each on its standard output. Standard error is
//! for people.

use std::io::Write;

use reports::schema::Outcome;
use serde::{Deserialize, Serialize};

/// What a worker tells of one of its runs, or of all that have not ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// Which run: its index among the folders that the worker was given. None where all are meant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lane: Option<usize>,
    /// What.
    #[serde(flatten)]
    pub event: Event,
}

/// A message about a run. The last one says how its worker ended; a worker that was killed sends none.
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

impl Told {
    /// Of the run with this index.
    pub fn of(lane: usize, event: Event) -> Self {
        Self { lane: Some(lane), event }
    }

    /// Of all runs that have not ended.
    pub fn of_all(event: Event) -> Self {
        Self { lane: None, event }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_told_is_read_back() {
        let event = || Event::Stopped { step: 7 };
        for told in [Told::of(3, event()), Told::of_all(event())] {
            let line = serde_json::to_string(&told).expect("plain data");
            assert_eq!(serde_json::from_str::<Told>(&line).expect("the same"), told, "{line}");
        }
    }
}
