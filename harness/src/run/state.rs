//! What a checkpoint keeps of a run.

use reports::schema::Teaching;
use serde::{Deserialize, Serialize};

use super::picks::Ranks;
use super::probing::ProbingState;
use super::shadow::ShadowsState;
use crate::config::streams::Streams;

/// A run between two turns, without the student's replay log. Environments need no state: a reset forgets
/// all.
#[derive(Serialize, Deserialize)]
pub struct TrainerState {
    pub(super) probed: ProbedState,
    pub(super) shadows: ShadowsState,
}

/// The same without shadows: what checkpoints kept before there were any.
#[derive(Serialize, Deserialize)]
pub struct ProbedState {
    pub(super) training: TrainingState,
    pub(super) probing: ProbingState,
}

/// The training of a run.
#[derive(Serialize, Deserialize)]
pub struct TrainingState {
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
        &self.probed.training.student
    }

    /// Steps of the budget that were taken.
    pub fn step(&self) -> u64 {
        self.probed.training.step
    }

    /// Those of them that the student was trained on.
    pub fn training_steps(&self) -> u64 {
        self.probed.training.step - self.probed.probing.charged()
    }
}

impl From<ProbedState> for TrainerState {
    /// A run without shadows.
    fn from(probed: ProbedState) -> Self {
        Self { probed, shadows: ShadowsState::default() }
    }
}

impl From<TrainingState> for ProbedState {
    /// A run without probe rollouts.
    fn from(training: TrainingState) -> Self {
        Self { training, probing: ProbingState::default() }
    }
}
