//! ProCuRL-val: train on goals that are neither too easy nor too hard (Tzannetos, Gomes Ribeiro, Kamalaruban and
//! Singla, "Proximal Curriculum for Reinforcement Learning Agents", TMLR 2023).
//!
//! A goal teaches most where the student sometimes succeeds: the zone of proximal development. The critic stands
//! in for the probability of success, p_i = clip((C(g_i) − Vmin) / (Vmax − Vmin), 0, 1) ([`success_probability`]),
//! a goal scores p_i (1 − p_i) ([`proximity`]), and goals are drawn with weights exp(β p_i (1 − p_i))
//! ([`Distribution::softmax`]).
//!
//! # Deviations and choices
//! The authors' code is `machine-teaching-group/tmlr2023_proximal-curriculum-rl` (commit 17904f1).
//!
//! - The paper's score is PoS(s) (PoS*(s) − PoS(s)) with the optimal probability of success PoS*; as in the
//!   authors' code, PoS* = 1.
//! - The critic is the student's own Q at the greedy action, in place of the V of the authors' PPO.
//! - Vmin and Vmax are the bounds of a return, −1/(1−γ) and 0 (`fixed`). Of the five environments in the authors'
//!   code, two with a single reward for success take V as it is, two divide by a fixed best return, and one takes
//!   smallest and largest value over all tasks (`adaptive`). All clip to [0, 1].
//! - With a reward of −1 per step V also tells how long success takes, so p is no probability: a goal that is
//!   always reached, but only after half of an episode of 50 steps, has p = 0.6.
//! - If under `adaptive` all values are equal to within rounding ([`FLAT`]), no goal is known to be easier than
//!   another, and all get p = 0: a uniform draw. The authors' code divides by 0 there.
//! - Values are those of the coming episode's start (`states = "initial"`), asked anew for every start and after
//!   every change of the networks. In the authors' code a task has a start of its own, which need not be the next,
//!   and values are renewed once per rollout of PPO, 1024 to 5120 steps: there, too, as often as the networks
//!   change.
//! - The draw is a softmax over all goals with β = 20, as in the authors' code.
//! - TEACH words the score as a geometric mean and takes the largest. That reads as √(p(1 − p)), whose largest goal
//!   is that of p(1 − p): `argmax`.
//! - Goals of the pool are set at other starts than they were drawn for: for HandManipulate* see
//!   [`her_iid_pool`](super::her_iid_pool).

use std::sync::Arc;

use agents::Network;
use envs::Goals;
use looks::colours::GREEN;
use looks::{Dash, Look, Marker};
use serde::{Deserialize, Serialize};

use crate::curriculum::{Choice, Curriculum, Lesson, Proposal, Setting, Statistics};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::pool_state::PoolState;
use crate::probe::{Answer, ProbeConfig, StateSource};
use crate::registry::Method;
use crate::snapshot;
use crate::variance::rounding;

/// Under `adaptive`, a pool whose values span no more than this many standard deviations of their rounding
/// ([`rounding`]) is flat: about three neighbouring numbers of single precision.
pub const FLAT: f64 = 8.0;

/// Version of the state in saved bytes.
const VERSION: u32 = 2;
/// Only the newest values count.
const COMPARED: usize = 1;

/// ProCuRL's options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProCurlConfig {
    /// β, inverse temperature of the softmax; finite, at least 0 (uniform). Authors' code: 20.
    pub beta: f64,
    /// Vmin and Vmax: `fixed` (choice) or `adaptive`.
    pub bounds: Bounds,
    /// Networks that answer: `online` (choice), `target` or `target-critic`.
    pub confidence: Network,
    /// States that C(g) averages over: `initial` (authors' code), `reference` or `replay`.
    pub states: StateSource,
    /// Number of states with `reference` and `replay`; 1 to 1024. Choice: 8.
    pub replay_states: usize,
    /// Evaluations after which `reference` begins with other states; at least 1. Choice: 100.
    pub renewal: u64,
    /// `softmax` (authors' code) or `argmax`.
    pub selection: Selection,
}

/// The values that stand for success with probability 0 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Bounds {
    /// The lowest and highest value there can be: −1/(1−γ) and 0.
    #[default]
    Fixed,
    /// The lowest and highest value over the pool.
    Adaptive,
}

/// How ProCuRL turns scores into a goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Selection {
    /// A draw with weights exp(β score).
    #[default]
    Softmax,
    /// The goal with the largest score; ties are drawn evenly.
    Argmax,
}

impl Default for ProCurlConfig {
    fn default() -> Self {
        Self {
            beta: 20.0,
            bounds: Bounds::Fixed,
            confidence: Network::Online,
            states: StateSource::Initial,
            replay_states: 8,
            renewal: 100,
            selection: Selection::Softmax,
        }
    }
}

impl ProCurlConfig {
    fn probe(&self) -> ProbeConfig {
        let Self { confidence: network, states, replay_states, renewal, .. } = *self;
        ProbeConfig { network, states, replay_states, renewal }
    }
}

/// p = clip((value − min) / (max − min), 0, 1), in [0, 1]; 0 where `max` is not above `min`.
pub fn success_probability(value: f64, min: f64, max: f64) -> f64 {
    if max > min { ((value - min) / (max - min)).clamp(0.0, 1.0) } else { 0.0 }
}

/// p (1 − p), in [0, 1/4]: largest for goals that are reached every other time.
pub fn proximity(p: f64) -> f64 {
    p * (1.0 - p)
}

/// The ProCuRL teacher.
pub struct ProCurl {
    config: ProCurlConfig,
    pool: Arc<Goals>,
    state: State,
    /// The last goal's score.
    choice: Option<Choice>,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
struct State {
    common: PoolState,
    /// p (1 − p) of every goal, shape `[N]`, that the curriculum was made from; empty before the first.
    scores: Vec<f64>,
}

impl Method for ProCurl {
    type Config = ProCurlConfig;
    const ID: &'static str = "procurl";
    const TITLE: &'static str = "ProCuRL";
    const LOOK: Option<Look> = Some(Look::new(GREEN, Dash::Short, Marker::Triangle));
    const SOURCE: &'static str =
        "Tzannetos et al., Proximal Curriculum for Reinforcement Learning Agents, TMLR 2023";
    const USES_POOL: bool = true;

    fn check(config: &ProCurlConfig) -> Result<(), CurriculumError> {
        let ok = config.beta.is_finite() && config.beta >= 0.0;
        CurriculumError::require(ok, "beta", "finite and at least 0", config.beta)?;
        config.probe().check(COMPARED)
    }

    fn build(config: ProCurlConfig, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError> {
        let pool = Arc::clone(&setting.pool);
        let common = PoolState::new(Distribution::uniform(pool.len()), COMPARED);
        Ok(Box::new(Self { config, pool, state: State { common, scores: Vec::new() }, choice: None }))
    }
}

impl ProCurlConfig {
    /// p (1 − p) of every goal from the confidence in it, both of shape `[N]`; `lowest` is −1/(1−γ).
    fn scores(&self, confidence: &[f64], lowest: f64) -> Vec<f64> {
        let (min, max) = match self.bounds {
            Bounds::Fixed => (lowest, 0.0),
            // Values that no return can have are rounded more coarsely.
            Bounds::Adaptive => {
                let largest = confidence.iter().fold(-lowest, |largest, value| value.abs().max(largest));
                extremes(confidence, FLAT * rounding(-largest))
            }
        };
        confidence.iter().map(|&value| proximity(success_probability(value, min, max))).collect()
    }

    /// The curriculum that follows from every goal's score.
    fn curriculum(&self, scores: &[f64]) -> Result<Distribution, CurriculumError> {
        match self.selection {
            Selection::Softmax => Distribution::softmax(scores, self.beta, "proximity"),
            Selection::Argmax => Distribution::argmax(scores, "proximity"),
        }
    }
}

/// The smallest and the largest of `values`; the smallest twice if they are at most `flat` apart.
fn extremes(values: &[f64], flat: f64) -> (f64, f64) {
    let min = values.iter().copied().fold(f64::INFINITY, f64::min);
    let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if max - min > flat { (min, max) } else { (min, min) }
}

impl Curriculum for ProCurl {
    fn propose(&mut self, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let Self { config, pool, state, choice } = self;
        if state.common.probe.ask(&config.probe(), pool, lesson, true)? == Answer::Recorded {
            let confidence = state.common.probe.window().last().expect("recorded");
            state.scores = config.scores(confidence, lesson.student.lowest_value());
            state.common.curriculum = config.curriculum(&state.scores)?;
        }
        let goal = state.common.curriculum.draw(lesson.rng);
        *choice = state.scores.get(goal).map(|&score| Choice { score, rank: None });
        Ok(Proposal::Pool(goal))
    }

    fn choice(&self) -> Option<Choice> {
        self.choice
    }

    fn weights(&self) -> Option<&[f64]> {
        Some(self.state.common.curriculum.probabilities())
    }

    fn statistics(&self) -> Statistics {
        self.state.common.statistics()
    }

    fn save(&self) -> Result<Vec<u8>, CurriculumError> {
        Ok(snapshot::save(Self::ID, VERSION, &self.state))
    }

    fn load(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        let state: State = snapshot::load(Self::ID, VERSION, bytes)?;
        state.common.check(self.pool.len(), COMPARED)?;
        if !state.scores.is_empty() {
            snapshot::require_goals(state.scores.len(), self.pool.len())?;
        }
        self.state = state;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_worked_probability_and_score() {
        // A quarter of the way from -50 to 0.
        assert_eq!(success_probability(-37.5, -50.0, 0.0), 0.25);
        assert_eq!(proximity(0.25), 0.1875);
        // Outside the bounds, and without any.
        assert_eq!(success_probability(-60.0, -50.0, 0.0), 0.0);
        assert_eq!(success_probability(1.0, -50.0, 0.0), 1.0);
        assert_eq!(success_probability(-3.0, -3.0, -3.0), 0.0);
    }

    #[test]
    fn the_score_is_largest_at_one_half_symmetric_and_zero_at_both_ends() {
        for p in (0..=100).map(|percent| f64::from(percent) / 100.0) {
            assert!((0.0..=0.25).contains(&proximity(p)));
            assert!((proximity(p) - proximity(1.0 - p)).abs() < 1e-15);
        }
        assert_eq!([proximity(0.0), proximity(0.5), proximity(1.0)], [0.0, 0.25, 0.0]);
    }
}
