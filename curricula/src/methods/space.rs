//! SPaCE: train on a small set of goals and let it grow when progress stagnates (Eimer, Biedenkapp, Hutter and
//! Lindauer, "Self-Paced Context Evaluation for Contextual Reinforcement Learning", ICML 2021, Algorithm 1).
//!
//! The set's K goals are trained on in turn. At each update t the confidence V_i = C(g_i) in every goal of the pool
//! is measured, with m_t its mean over the set. If m has hardly moved, | |m_t| − |m_{t−1}| | ≤ η |m_{t−1}|
//! ([`stagnates`]), K grows by κ. Then the set is chosen anew: the K goals that rank first ([`Order`]), by default
//! those whose value improved most since the last update.
//!
//! # Deviations and choices
//! - The set grows when progress *stagnates*, as in the paper and its code; TEACH's summary reads the other way
//!   round.
//! - An update falls due whenever the networks have changed, that is once per cycle of the student, with the
//!   start state of the coming episode. The authors' code trains 100 K steps or 2048 steps in between.
//! - The first set is the first goal of the pool (drawn at random, so any would do). At the first update there
//!   is nothing to compare with: K stays, and goals rank as if their values had been 0 before, as in the
//!   authors' code. Their code also applies the growth test to that 0.
//! - The authors' code compares with η |m_t|, having overwritten m_{t−1} just before; here η |m_{t−1}| as in the
//!   paper.
//! - Goals take turns in the order of their rank, and the turn goes on counting across updates; were it to start
//!   again, only the first goals of a large set would ever be trained on.
//! - `relative` divides by |V_i(t−1)|. The authors' code divides by V_i(t−1), which turns the order round for the
//!   negative values of this benchmark's reward, and at the first update by 0: all goals are then equal. Here that
//!   first update ranks like `signed`. Later, a goal that declines from exactly 0 ranks last.
//! - The critic is the student's own Q at the greedy action, in place of the V of the authors' TRPO and PPO.
//! - Goals of the pool are set at other starts than they were drawn for: for HandManipulate* see
//!   [`her_iid_pool`](super::her_iid_pool).

use std::sync::Arc;

use agents::Network;
use envs::Goals;
use serde::{Deserialize, Serialize};

use crate::curriculum::{Curriculum, Lesson, Proposal, Setting, Statistics};
use crate::distribution::{Distribution, require_finite};
use crate::error::CurriculumError;
use crate::pool_state::PoolState;
use crate::probe::{Answer, ProbeConfig, StateSource};
use crate::registry::Method;
use crate::snapshot;

/// Version of [`State`] in saved bytes.
const VERSION: u32 = 2;

/// SPaCE's options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpaceConfig {
    /// η, relative change of the set's mean value that still counts as stagnation; finite, at least 0.
    /// Paper: 0.1.
    pub eta: f64,
    /// κ, goals added when progress stagnates; at least 1. Paper: 1.
    pub kappa: usize,
    /// What ranks goals for the set: `signed` (paper), `absolute` (default of the authors' code) or `relative`.
    pub order: Order,
    /// Networks that answer: `online` (paper) or `target`.
    pub confidence: Network,
    /// States that C(g) averages over: `initial` (paper) or `replay`.
    pub states: StateSource,
    /// Number of states with `states = "replay"`; 1 to 1024. Choice: 8.
    pub replay_states: usize,
}

/// What ranks goals, best first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// Largest improvement V(t) − V(t−1).
    #[default]
    Signed,
    /// Lowest value V(t).
    Absolute,
    /// Largest improvement relative to the last value, (V(t) − V(t−1)) / |V(t−1)|.
    Relative,
}

impl Default for SpaceConfig {
    fn default() -> Self {
        Self {
            eta: 0.1,
            kappa: 1,
            order: Order::Signed,
            confidence: Network::Online,
            states: StateSource::Initial,
            replay_states: 8,
        }
    }
}

impl SpaceConfig {
    fn probe(&self) -> ProbeConfig {
        ProbeConfig { network: self.confidence, states: self.states, replay_states: self.replay_states }
    }
}

/// | |m_t| − |m_{t−1}| | ≤ η |m_{t−1}|: the set's mean value has hardly moved.
pub fn stagnates(mean: f64, last_mean: f64, eta: f64) -> bool {
    (mean.abs() - last_mean.abs()).abs() <= eta * last_mean.abs()
}

impl Order {
    /// A goal's score, of which the largest rank first, from its value now and at the last update.
    pub fn score(self, value: f64, last: f64) -> f64 {
        let improvement = value - last;
        match self {
            Self::Signed => improvement,
            Self::Absolute => -value,
            // No change is no change, also from 0.
            Self::Relative if improvement == 0.0 => 0.0,
            Self::Relative => improvement / last.abs(),
        }
    }

    /// The order of the first update, when every value counts as having been 0: nothing is relative to that.
    fn at_first(self) -> Self {
        if self == Self::Relative { Self::Signed } else { self }
    }

    /// All goals, best first; among equals the one with the lower index.
    pub fn rank(self, values: &[f64], last: &[f64]) -> Vec<usize> {
        let scores: Vec<f64> =
            values.iter().zip(last).map(|(&value, &last)| self.score(value, last)).collect();
        let mut goals: Vec<usize> = (0..values.len()).collect();
        goals.sort_by(|&a, &b| scores[b].total_cmp(&scores[a]));
        goals
    }
}

/// The SPaCE teacher.
pub struct Space {
    config: SpaceConfig,
    pool: Arc<Goals>,
    state: State,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
struct State {
    common: PoolState,
    /// The K goals of the set, best first.
    set: Vec<usize>,
    /// Goals proposed so far.
    turn: usize,
    last: Option<Update>,
}

/// What the next update compares with.
#[derive(Serialize, Deserialize)]
struct Update {
    /// V of every goal of the pool, shape `[N]`.
    values: Vec<f64>,
    /// m, its mean over the set that was trained on before this update.
    mean: f64,
}

impl Method for Space {
    type Config = SpaceConfig;
    const ID: &'static str = "space";
    const TITLE: &'static str = "SPaCE";
    const SOURCE: &'static str =
        "Eimer et al., Self-Paced Context Evaluation for Contextual Reinforcement Learning, ICML 2021";
    const USES_POOL: bool = true;

    fn check(config: &SpaceConfig) -> Result<(), CurriculumError> {
        let ok = config.eta.is_finite() && config.eta >= 0.0;
        CurriculumError::require(ok, "eta", "finite and at least 0", config.eta)?;
        CurriculumError::require(config.kappa >= 1, "kappa", "at least 1", config.kappa)?;
        config.probe().check()
    }

    fn build(config: SpaceConfig, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError> {
        let pool = Arc::clone(&setting.pool);
        let curriculum = Distribution::uniform_over(&[0], pool.len());
        let state = State { common: PoolState::new(curriculum), set: vec![0], turn: 0, last: None };
        Ok(Box::new(Self { config, pool, state }))
    }
}

impl State {
    /// Algorithm 1's update: grow the set if progress stagnates, then choose it anew.
    fn update(&mut self, config: &SpaceConfig, values: Vec<f64>) {
        let mean = self.set.iter().map(|&goal| values[goal]).sum::<f64>() / self.set.len() as f64;
        let (size, mut ranked) = match &self.last {
            None => (self.set.len(), config.order.at_first().rank(&values, &vec![0.0; values.len()])),
            Some(last) => {
                let growth = if stagnates(mean, last.mean, config.eta) { config.kappa } else { 0 };
                (self.set.len().saturating_add(growth), config.order.rank(&values, &last.values))
            }
        };
        ranked.truncate(size);
        self.common.curriculum = Distribution::uniform_over(&ranked, values.len());
        self.set = ranked;
        self.last = Some(Update { values, mean });
    }

    /// Whether all of it belongs to a pool of `goals`.
    fn check(&self, goals: usize) -> Result<(), CurriculumError> {
        self.common.check(goals)?;
        if let Some(last) = &self.last {
            snapshot::require_goals(last.values.len(), goals)?;
            require_finite(&last.values, "saved value")
                .map_err(|error| snapshot::refuse(error.to_string()))?;
        }
        let valid = !self.set.is_empty() && self.set.iter().all(|&goal| goal < goals);
        if valid { Ok(()) } else { Err(snapshot::refuse("its set is empty or leaves the pool")) }
    }
}

impl Curriculum for Space {
    fn propose(&mut self, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let state = &mut self.state;
        if let Answer::Confidence(values) =
            state.common.probe.ask(&self.config.probe(), &self.pool, lesson)?
        {
            state.update(&self.config, values);
        }
        let goal = state.set[state.turn % state.set.len()];
        state.turn += 1;
        Ok(Proposal::Pool(goal))
    }

    fn weights(&self) -> Option<&[f64]> {
        Some(self.state.common.curriculum.probabilities())
    }

    fn statistics(&self) -> Statistics {
        let state = &self.state;
        let mut statistics = state.common.statistics();
        statistics.push(("set_size", state.set.len() as f64));
        statistics.push(("set_confidence", state.last.as_ref().map_or(f64::NAN, |last| last.mean)));
        statistics
    }

    fn save(&self) -> Result<Vec<u8>, CurriculumError> {
        Ok(snapshot::save(Self::ID, VERSION, &self.state))
    }

    fn load(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        let state: State = snapshot::load(Self::ID, VERSION, bytes)?;
        state.check(self.pool.len())?;
        self.state = state;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn hand_worked_growth_test() {
        // From -10 by 1 either way is within a tenth; by 1.5 it is not.
        assert!(stagnates(-9.0, -10.0, 0.1) && stagnates(-11.0, -10.0, 0.1));
        assert!(!stagnates(-8.5, -10.0, 0.1) && !stagnates(-11.5, -10.0, 0.1));
        // 10 % of the last mean, not of the new one: 1.05 > 1, though 1.05 < 0.1 * 11.05.
        assert!(!stagnates(-11.05, -10.0, 0.1));
        assert!(stagnates(0.0, 0.0, 0.1));
        // Sizes are compared, so a mean that only changes its sign stands still.
        assert!(stagnates(10.0, -10.0, 0.1) && stagnates(-10.0, 10.0, 0.1));
    }

    #[test]
    fn hand_worked_orders() {
        let last = [-10.0, -4.0, -20.0, -1.0];
        let values = [-8.0, -3.0, -23.0, -1.0];
        // Improvements 2, 1, -3, 0; relative 0.2, 0.25, -0.15, 0.
        assert_eq!(Order::Signed.rank(&values, &last), [0, 1, 3, 2]);
        assert_eq!(Order::Absolute.rank(&values, &last), [2, 0, 1, 3]);
        assert_eq!(Order::Relative.rank(&values, &last), [1, 0, 3, 2]);
    }

    #[test]
    fn relative_order_is_defined_at_zero() {
        assert_eq!(Order::Relative.score(0.0, 0.0), 0.0);
        // A half, no change, and a decline from 0.
        assert_eq!(Order::Relative.rank(&[-1.0, 0.0, -1.0], &[0.0, 0.0, -2.0]), [2, 1, 0]);
    }

    #[test]
    fn equals_keep_the_pools_order() {
        assert_eq!(Order::Signed.rank(&[-2.0; 4], &[-3.0; 4]), [0, 1, 2, 3]);
    }

    proptest! {
        #[test]
        fn the_best_score_comes_first_wherever_it_stands(
            values in prop::collection::vec((-50.0..0.0f64, -50.0..-0.1f64), 1..20),
            shift in 0..20usize,
        ) {
            let mut turned = values.clone();
            turned.rotate_left(shift % values.len());
            for order in [Order::Signed, Order::Absolute, Order::Relative] {
                let ranked = |pairs: &[(f64, f64)]| -> Vec<f64> {
                    let (values, last): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
                    order.rank(&values, &last).into_iter().map(|i| order.score(values[i], last[i])).collect()
                };
                let scores = ranked(&values);
                prop_assert!(scores.is_sorted_by(|a, b| a >= b));
                prop_assert_eq!(scores, ranked(&turned));
            }
        }
    }
}
