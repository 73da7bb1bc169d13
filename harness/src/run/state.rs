//! What a checkpoint keeps of a run.

use reports::schema::Teaching;
use serde::{Deserialize, Serialize};

use super::picks::Ranks;
use crate::config::streams::Streams;

/// A run between two cycles, without the student's replay log. Environments need no state: a reset forgets
/// all.
#[derive(Serialize, Deserialize)]
pub struct TrainerState {
    pub(super) step: u64,
    pub(super) evaluations: u64,
    pub(super) streams: Streams,
    pub(super) teaching: Teaching,
    pub(super) ranks: Ranks,
    #[serde(with = "serde_bytes")]
    pub(super) student: Vec<u8>,
    #[serde(with = "serde_bytes")]
    pub(super) teacher: Vec<u8>,
}

impl TrainerState {
    /// The student, as [`agents::Agent::save`] gave it.
    pub fn student(&self) -> &[u8] {
        &self.student
    }

    /// Training steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }
}
