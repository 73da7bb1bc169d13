//! What teachers that weigh the pool by the student's confidence have in common.

use serde::{Deserialize, Serialize};

use crate::curriculum::Statistics;
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::probe::Probe;
use crate::snapshot;

/// The probe that measures confidence, and the curriculum that follows from it: part of such a teacher's state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoolState {
    /// Measures confidence and remembers it.
    pub probe: Probe,
    /// A probability for every goal of the pool.
    pub curriculum: Distribution,
}

impl PoolState {
    /// `curriculum`, before anything is measured; a probe that will remember `window` evaluations.
    pub fn new(curriculum: Distribution, window: usize) -> Self {
        Self { probe: Probe::new(window), curriculum }
    }

    /// Numbers to record: those of the curriculum, then those of the probe.
    pub fn statistics(&self) -> Statistics {
        let mut statistics = self.curriculum.statistics().to_vec();
        statistics.extend(self.probe.statistics());
        statistics
    }

    /// Refuses a loaded state that is of another pool than one of `goals`, or compares other than `window` evaluations.
    ///
    /// # Errors
    /// [`CurriculumError::State`] if it is.
    pub fn check(&self, goals: usize, window: usize) -> Result<(), CurriculumError> {
        snapshot::require_goals(self.curriculum.probabilities().len(), goals)?;
        self.probe.check(goals, window)
    }
}
