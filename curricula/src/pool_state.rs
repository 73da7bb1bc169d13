//! What teachers that weigh the pool by the student's confidence have in common.

use envs::rng::Rng;
use serde::{Deserialize, Serialize};

use crate::curriculum::{Proposal, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::probe::Probe;
use crate::snapshot;

/// The probe that measures confidence, and the curriculum that follows from it: part of such a teacher's
/// state.
///
/// ```
/// use curricula::{Distribution, PoolState};
///
/// let state = PoolState::new(Distribution::uniform(4), 2);
/// assert_eq!(state.summary().weights, Some(&[0.25; 4][..]));
/// ```
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

    /// The curriculum's weights; its numbers, then those of the probe.
    pub fn summary(&self) -> TeacherSummary<'_> {
        let mut summary = self.curriculum.summary();
        summary.statistics.extend(self.probe.statistics());
        summary
    }
}

/// A [`PoolState`] whose curriculum was made from a score of every goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScoredPool {
    /// Probe and curriculum.
    pub common: PoolState,
    /// The score of every goal, shape `[N]`, that the curriculum was made from; empty before the first.
    pub scores: Vec<f64>,
}

impl ScoredPool {
    /// A uniform draw from a pool of `goals`, before anything is measured; a probe that will remember
    /// `window` evaluations.
    pub fn new(goals: usize, window: usize) -> Self {
        Self { common: PoolState::new(Distribution::uniform(goals), window), scores: Vec::new() }
    }

    /// A goal drawn from the curriculum, with its score.
    pub fn propose(&self, rng: &mut Rng) -> Proposal {
        let goal = self.common.curriculum.draw(rng);
        Proposal::pool(goal).scored(self.scores.get(goal).copied())
    }

    /// The score of every goal, shape `[N]`; `None` before the first.
    pub fn scores(&self) -> Option<Vec<f64>> {
        (!self.scores.is_empty()).then(|| self.scores.clone())
    }

    /// Refuses a loaded state that is of another pool than one of `goals`, or compares other than `window`
    /// evaluations.
    ///
    /// # Errors
    /// [`CurriculumError::State`] if it is.
    pub fn check(&self, goals: usize, window: usize) -> Result<(), CurriculumError> {
        if !self.scores.is_empty() {
            snapshot::require_goals(self.scores.len(), goals)?;
        }
        self.common.probe.check(goals, window)
    }
}
