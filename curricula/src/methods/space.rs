//! SPaCE: train on a small set of goals and let it grow when progress stagnates (Eimer, Biedenkapp, Hutter
//! and Lindauer, "Self-Paced Context Evaluation for Contextual Reinforcement Learning", ICML 2021,
//! Algorithm 1).
//!
//! The set's K goals are trained on in turn. At each update t the confidence V_i = C(g_i) in every goal of
//! the pool is measured, with m_t its mean over the set. If m has hardly moved, | |m_t| − |m_{t−1}| | ≤ η
//! |m_{t−1}| ([`stagnates`]), K grows by κ. Then the set is chosen anew: the K goals that rank first
//! ([`Order`]), by default those whose value improved most since the last update.
//!
//! # Deviations and choices
//! The authors' code is `automl/SPaCE` (commit 396555d, `src/baselines_spl.py`); the port is that of
//! ProCuRL's authors.
//!
//! - The set grows when progress *stagnates*, as in the authors' code; TEACH's summary reads the other way
//!   round.
//! - Goals rank by improvement, V_i(t) − V_i(t−1), as in ProCuRL's port of SPaCE. That is `improvement` in
//!   the authors' code; its default and its run scripts use `absolute`, lowest V first.
//! - An update falls due every 2048 environment steps (`update_steps`), which is `fixed` in the authors'
//!   code, and is made at the next start of an episode by networks that have learned since the last update.
//!   Their default waits 100 K steps, and the port one rollout of PPO, 1024 to 5120 steps. With 2048, a
//!   budget of 1M steps has room for 488 updates, and κ = 1 for a set of at most 488 goals; 400,000 steps
//!   have room for 195.
//! - The first set is the first goal of the pool (drawn at random, so any would do).
//! - The first update has nothing to compare with: K stays, and goals rank as if their values had been 0
//!   before, highest V first, as in the authors' code. Their growth test then compares with 0, and fails
//!   unless the mean is 0 itself.
//! - The authors' code compares with η |m_t|, having overwritten m_{t−1} just before. Here it is η |m_{t−1}|,
//!   as in the port (which asks for <, where this and the authors' code ask for ≤).
//! - With `reference`, m_{t−1} and m_t are measured from the same states. m_{t−1} is the mean over the set
//!   that was trained on before the last update.
//! - K grows by exactly κ. In the authors' code the size is a fraction of the pool, rounded up, and now and
//!   then leaps by two.
//! - After place i of the set comes place (i + 1) mod K, with the K of that moment, also across updates, as
//!   in the authors' code. There, measuring m and starting to train again take turns of their own. A counter
//!   of all episodes modulo a K that grows would never fall on some places.
//! - `relative` divides by |V_i(t−1)|. The authors' code divides by V_i(t−1), which turns the order round for
//!   negative values, and at the first update by 0, which leaves the sign of V_i alone. Here the first update
//!   ranks like `signed`. Later, a goal that declines from exactly 0 ranks last, one that rises from it
//!   first.
//! - V_i is the confidence from states of the replay buffer, held for 100 updates by default
//!   ([`Probe`](crate::Probe)). In the authors' code it is the value of the instance's own start. With
//!   `initial` it is that of the coming episode, and V_i(t) and V_i(t−1) belong to two starts wherever starts
//!   are random.
//! - The critic is the student's own Q at the greedy action, in place of the V of the authors' TRPO and PPO.
//! - Goals of the pool are set at other starts than they were drawn for: for HandManipulate* see
//!   [`her_iid_pool`](super::her_iid_pool).

use std::sync::Arc;

use agents::{Critic, Episode};
use envs::Goals;
use looks::colours::PURPLE;
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Rank, Setting, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::judgement::Judgement;
use crate::method::Method;
use crate::pool_state::PoolState;
use crate::probe::{Answer, ProbeConfig};
use crate::snapshot;
use crate::state::PlainState;
use crate::window::Window;

/// Evaluations that an update compares: V(t) and V(t−1).
const COMPARED: usize = 2;

/// SPaCE's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct SpaceConfig {
    /// η, the relative change of the set's mean value that still counts as stagnation.
    ///
    /// Unit: none. Range: at least 0. Source: the authors' code.
    pub eta: f64,
    /// κ, goals added to the set when progress stagnates.
    ///
    /// Unit: goals. Range: at least 1. Source: the authors' code.
    pub kappa: usize,
    /// What ranks goals for the set.
    ///
    /// Source: a choice; `absolute` is the default of the authors' code.
    pub order: Order,
    /// Environment steps between two updates of the set.
    ///
    /// Unit: steps. Range: at least 1. Source: the authors' code.
    pub update_steps: u64,
    /// How C(g) is measured. Networks: `online` (choice), `target` or `target-critic`. States: `reference`
    /// (choice), `replay` or `initial`. Its evaluations are the updates, and a `renewal` below 2 is refused.
    #[serde(flatten)]
    pub probe: ProbeConfig,
}

/// What ranks goals, best first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
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
        Self { eta: 0.1, kappa: 1, order: Order::Signed, update_steps: 2048, probe: ProbeConfig::default() }
    }
}

/// | |m_t| − |m_{t−1}| | ≤ η |m_{t−1}|: the set's mean value has hardly moved.
///
/// ```
/// use curricula::methods::space::stagnates;
///
/// assert!(stagnates(-10.5, -10.0, 0.1));
/// assert!(!stagnates(-12.0, -10.0, 0.1));
/// ```
pub fn stagnates(mean: f64, last_mean: f64, eta: f64) -> bool {
    (mean.abs() - last_mean.abs()).abs() <= eta * last_mean.abs()
}

impl Order {
    /// A goal's score from its value now and at the last update. The largest scores rank first.
    ///
    /// ```
    /// use curricula::methods::space::Order;
    ///
    /// assert_eq!(Order::Signed.score(-4.0, -8.0), 4.0);
    /// assert_eq!(Order::Absolute.score(-4.0, -8.0), 4.0);
    /// assert_eq!(Order::Relative.score(-4.0, -8.0), 0.5);
    /// ```
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

    /// The order of the first update: every earlier value then counts as 0, which nothing can be relative to.
    fn at_first(self) -> Self {
        if self == Self::Relative { Self::Signed } else { self }
    }

    /// The score of every goal, `[N]`, at the update that made the newest evaluation; `None` without one.
    fn scores(self, window: &Window) -> Option<Vec<f64>> {
        let values = window.last()?;
        let nothing = vec![0.0; values.len()];
        let (order, last) = window.before_last().map_or((self.at_first(), &nothing[..]), |last| (self, last));
        Some(values.iter().zip(last).map(|(&value, &last)| order.score(value, last)).collect())
    }

    /// All goals with their scores, best first; among equals the one with the lower index.
    ///
    /// ```
    /// use curricula::methods::space::Order;
    ///
    /// let ranked = Order::Signed.rank(&[-4.0, -1.0], &[-5.0, -3.0]);
    /// assert_eq!(ranked, [(1, 2.0), (0, 1.0)]);
    /// ```
    pub fn rank(self, values: &[f64], last: &[f64]) -> Vec<(usize, f64)> {
        let scores = values.iter().zip(last).map(|(&value, &last)| self.score(value, last));
        let mut goals: Vec<(usize, f64)> = scores.enumerate().collect();
        goals.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        goals
    }
}

/// The place of the set whose turn it is after place `last`, in a set of `size` goals: (i + 1) mod K.
pub fn next_turn(last: Option<usize>, size: usize) -> usize {
    last.map_or(0, |place| (place + 1) % size)
}

/// The SPaCE teacher.
pub struct Space {
    config: SpaceConfig,
    pool: Arc<Goals>,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct SpaceState {
    common: PoolState,
    /// The K goals of the set with the scores that they were ranked by, best first.
    set: Vec<(usize, f64)>,
    /// The set that was trained on before the last update, which m_{t−1} is the mean over.
    compared: Vec<usize>,
    /// The place of the set that had the last turn.
    turn: Option<usize>,
    /// Environment steps since an update fell due.
    steps: u64,
    /// m at the last update, for the records; NaN before the first.
    mean: f64,
}

impl PlainState for SpaceState {
    const VERSION: u32 = 3;
}

/// The mean of the values of `goals`, of which there is at least one.
fn mean_over(goals: impl ExactSizeIterator<Item = usize>, values: &[f64]) -> f64 {
    let n = goals.len() as f64;
    goals.map(|goal| values[goal]).sum::<f64>() / n
}

impl SpaceState {
    /// Algorithm 1's update from the newest values and those before: grow the set if progress stagnates, then
    /// choose it anew.
    fn update(&mut self, config: &SpaceConfig) {
        let window = self.common.probe.window();
        let values = window.last().expect("an update follows an evaluation");
        let mean = mean_over(self.set.iter().map(|&(goal, _)| goal), values);
        let (size, mut ranked) = match window.before_last() {
            None => (self.set.len(), config.order.at_first().rank(values, &vec![0.0; values.len()])),
            Some(last) => {
                let last_mean = mean_over(self.compared.iter().copied(), last);
                let growth = if stagnates(mean, last_mean, config.eta) { config.kappa } else { 0 };
                (self.set.len().saturating_add(growth), config.order.rank(values, last))
            }
        };
        ranked.truncate(size);
        let members: Vec<usize> = ranked.iter().map(|&(goal, _)| goal).collect();
        self.common.curriculum = Distribution::uniform_over(&members, values.len());
        self.compared = std::mem::replace(&mut self.set, ranked).into_iter().map(|(goal, _)| goal).collect();
        self.mean = mean;
    }

    /// Whether all of it belongs to a pool of `goals`.
    fn check(&self, goals: usize) -> Result<(), CurriculumError> {
        self.common.probe.check(goals, COMPARED)?;
        let members = self.set.iter().map(|(goal, _)| goal).chain(&self.compared);
        let updated = self.common.probe.window().last().is_some();
        let valid = !self.set.is_empty()
            && updated != self.compared.is_empty()
            && members.clone().all(|&goal| goal < goals)
            && self.set.iter().all(|(_, score)| !score.is_nan());
        if valid {
            Ok(())
        } else {
            Err(snapshot::refuse("its set is empty, leaves the pool or is not ranked"))
        }
    }
}

impl Method for Space {
    type Config = SpaceConfig;
    type State = SpaceState;
    const ID: &'static str = "space";
    const TITLE: &'static str = "SPaCE";
    const LOOK: Option<Look> = Some(Look::new(PURPLE, Dash::DashDot, Marker::Diamond));
    const SOURCE: &'static str =
        "Eimer et al., Self-Paced Context Evaluation for Contextual Reinforcement Learning, ICML 2021";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn schema() -> Option<Schema> {
        Some(schema_of::<SpaceConfig>())
    }

    fn check(config: &SpaceConfig) -> Result<(), CurriculumError> {
        let SpaceConfig { eta, kappa, update_steps, .. } = *config;
        CurriculumError::require(eta.is_finite() && eta >= 0.0, "eta", "finite and at least 0", eta)?;
        CurriculumError::require(kappa >= 1, "kappa", "at least 1", kappa)?;
        CurriculumError::require(update_steps >= 1, "update_steps", "at least 1", update_steps)?;
        config.probe.check(COMPARED)
    }

    fn build(config: SpaceConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { config, pool: Arc::clone(&setting.pool) })
    }

    fn begin(&self, _setting: &Setting) -> Result<SpaceState, CurriculumError> {
        let common = PoolState::new(Distribution::uniform_over(&[0], self.pool.len()), COMPARED);
        let set = vec![(0, 0.0)];
        Ok(SpaceState { common, set, compared: Vec::new(), turn: None, steps: 0, mean: f64::NAN })
    }

    fn propose(&self, state: &mut SpaceState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let Self { config, pool } = self;
        // An update that finds nothing new (no states yet, networks that stand still) stays due.
        if state.steps >= config.update_steps
            && state.common.probe.ask(&config.probe, pool, lesson, false)? == Answer::Recorded
        {
            state.steps %= config.update_steps;
            state.update(config);
        }
        let place = next_turn(state.turn, state.set.len());
        state.turn = Some(place);
        let (goal, score) = state.set[place];
        Ok(Proposal::pool(goal).scored(score).ranked(Rank { place, of: state.set.len() }))
    }

    fn observe(&self, state: &mut SpaceState, episode: &Episode) -> Result<(), CurriculumError> {
        state.steps = state.steps.saturating_add(episode.actions.len() as u64);
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a SpaceState) -> TeacherSummary<'a> {
        let mut summary = state.common.summary();
        summary.statistics.push(("set_size", state.set.len() as f64));
        summary.statistics.push(("set_confidence", state.mean));
        summary
    }

    /// SPaCE itself makes no estimate of success; its confidence is read as ProCuRL reads it. Scores are
    /// those that the last update ranked all goals by.
    fn judge(&self, SpaceState { common, .. }: &SpaceState, student: &dyn Critic) -> Judgement {
        let success = common.probe.success(student.lowest_value());
        Judgement::of_all(success, self.config.order.scores(common.probe.window()))
    }

    fn check_state(&self, state: &SpaceState) -> Result<(), CurriculumError> {
        state.check(self.pool.len())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The goals alone, best first.
    fn ranked(order: Order, values: &[f64], last: &[f64]) -> Vec<usize> {
        order.rank(values, last).into_iter().map(|(goal, _)| goal).collect()
    }

    #[test]
    fn hand_worked_turns() {
        assert_eq!([next_turn(None, 3), next_turn(Some(0), 3), next_turn(Some(2), 3)], [0, 1, 0]);
        // A set that has grown goes on where it was; one that has shrunk takes the next place there is.
        assert_eq!([next_turn(Some(2), 4), next_turn(Some(4), 3)], [3, 2]);
    }

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
        assert_eq!(ranked(Order::Signed, &values, &last), [0, 1, 3, 2]);
        assert_eq!(ranked(Order::Absolute, &values, &last), [2, 0, 1, 3]);
        assert_eq!(ranked(Order::Relative, &values, &last), [1, 0, 3, 2]);
    }

    #[test]
    fn relative_order_is_defined_at_zero() {
        assert_eq!(Order::Relative.score(0.0, 0.0), 0.0);
        // A half, no change, and a decline from 0.
        assert_eq!(ranked(Order::Relative, &[-1.0, 0.0, -1.0], &[0.0, 0.0, -2.0]), [2, 1, 0]);
    }

    #[test]
    fn equals_keep_the_pools_order() {
        assert_eq!(ranked(Order::Signed, &[-2.0; 4], &[-3.0; 4]), [0, 1, 2, 3]);
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
                let scores_of = |pairs: &[(f64, f64)]| -> Vec<f64> {
                    let (values, last): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
                    ranked(order, &values, &last).into_iter().map(|i| order.score(values[i], last[i])).collect()
                };
                let scores = scores_of(&values);
                prop_assert!(scores.is_sorted_by(|a, b| a >= b));
                prop_assert_eq!(scores, scores_of(&turned));
            }
        }
    }
}
