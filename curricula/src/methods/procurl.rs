//! ProCuRL-val: train on goals that are neither too easy nor too hard (Tzannetos, Gomes Ribeiro, Kamalaruban
//! and Singla, "Proximal Curriculum for Reinforcement Learning Agents", TMLR 2023).
//!
//! A goal teaches most where the student sometimes succeeds: the zone of proximal development. The critic
//! stands in for the probability of success, p_i = clip((C(g_i) − Vmin) / (Vmax − Vmin), 0, 1)
//! ([`success_probability`]), a goal scores p_i (1 − p_i) ([`learnability`]), and goals are drawn with
//! weights exp(β p_i (1 − p_i)) ([`Distribution::softmax`]).
//!
//! # Deviations and choices
//! The authors' code is `machine-teaching-group/tmlr2023_proximal-curriculum-rl` (commit 17904f1).
//!
//! - The paper's score is PoS(s) (PoS*(s) − PoS(s)) with the optimal probability of success PoS*; as in the
//!   authors' code, PoS* = 1.
//! - The critic is the student's own Q at the greedy action, in place of the V of the authors' PPO.
//! - Vmin and Vmax are the bounds of a return, −1/(1−γ) and 0 (`fixed`). Of the five environments in the
//!   authors' code, two with a single reward for success take V as it is, two divide by a fixed best return,
//!   and one takes smallest and largest value over all tasks (`adaptive`). All clip to [0, 1].
//! - With a reward of −1 per step V also tells how long success takes, so p is no probability: a goal that is
//!   always reached, but only after half of an episode of 50 steps, has p = 0.6.
//! - If under `adaptive` all values are equal to within rounding ([`FLAT`]), no goal is known to be easier
//!   than another, and all get p = 0: a uniform draw. The authors' code divides by 0 there.
//! - Values are those of the coming episode's start (`states = "initial"`), asked anew for every start and
//!   after every change of the networks. In the authors' code a task has a start of its own, which need not
//!   be the next, and values are renewed once per rollout of PPO, 1024 to 5120 steps: there, too, as often as
//!   the networks change.
//! - The draw is a softmax over all goals with β = 20, as in the authors' code.
//! - TEACH words the score as a geometric mean and takes the largest. That reads as √(p(1 − p)), whose
//!   largest goal is that of p(1 − p): `argmax`.
//! - Goals of the pool are set at other starts than they were drawn for: for HandManipulate* see
//!   [`her_iid_pool`](super::her_iid_pool).

use std::sync::Arc;

use agents::Critic;
use envs::Goals;
use looks::colours::GREEN;
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
pub use crate::judgement::success_probability;
use crate::judgement::{Judgement, learnability};
use crate::method::Method;
use crate::pool_state::ScoredPool;
use crate::probe::{Answer, ProbeConfig, StateSource};
use crate::state::PlainState;
use crate::variance::rounding;

/// Under `adaptive`, a pool whose values span no more than this many standard deviations of their rounding
/// ([`rounding`]) is flat: about three neighbouring numbers of single precision.
pub const FLAT: f64 = 8.0;

/// Evaluations that are compared: only the newest counts.
const COMPARED: usize = 1;

/// ProCuRL's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ProCurlConfig {
    /// β, inverse temperature of the softmax; with 0 all goals are alike.
    ///
    /// Unit: none. Range: at least 0. Source: the authors' code.
    pub beta: f64,
    /// Vmin and Vmax, the values that stand for success with probability 0 and 1.
    ///
    /// Source: a choice.
    pub bounds: Bounds,
    /// How C(g) is measured. Networks: `online` (choice), `target` or `target-critic`. States: `initial`
    /// (authors' code), `reference` or `replay`.
    #[serde(flatten)]
    pub probe: ProbeConfig,
    /// How scores become a goal.
    ///
    /// Source: the authors' code.
    pub selection: ProCurlSelection,
}

/// The values that stand for success with probability 0 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Bounds {
    /// The lowest and highest value there can be: −1/(1−γ) and 0.
    #[default]
    Fixed,
    /// The lowest and highest value over the pool.
    Adaptive,
}

/// How ProCuRL turns scores into a goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ProCurlSelection {
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
            probe: ProbeConfig { states: StateSource::Initial, ..ProbeConfig::default() },
            selection: ProCurlSelection::Softmax,
        }
    }
}

impl ProCurlConfig {
    /// p of every goal from the confidence in it, both of shape `[N]`; `lowest` is −1/(1−γ).
    fn probabilities(&self, confidence: &[f64], lowest: f64) -> Vec<f64> {
        let (min, max) = match self.bounds {
            Bounds::Fixed => (lowest, 0.0),
            // Values that no return can have are rounded more coarsely.
            Bounds::Adaptive => {
                let largest = confidence.iter().fold(-lowest, |largest, value| value.abs().max(largest));
                extremes(confidence, FLAT * rounding(-largest))
            }
        };
        confidence.iter().map(|&value| success_probability(value, min, max)).collect()
    }

    /// The curriculum that follows from every goal's score.
    fn curriculum(&self, scores: &[f64]) -> Result<Distribution, CurriculumError> {
        match self.selection {
            ProCurlSelection::Softmax => Distribution::softmax(scores, self.beta, "proximity"),
            ProCurlSelection::Argmax => Distribution::argmax(scores, "proximity"),
        }
    }
}

/// The smallest and the largest of `values`; the smallest twice if they are at most `flat` apart.
fn extremes(values: &[f64], flat: f64) -> (f64, f64) {
    let min = values.iter().copied().fold(f64::INFINITY, f64::min);
    let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if max - min > flat { (min, max) } else { (min, min) }
}

/// The ProCuRL teacher.
pub struct ProCurl {
    config: ProCurlConfig,
    pool: Arc<Goals>,
}

/// Everything that changes while teaching: the curriculum, and p (1 − p) of every goal that it was made from.
#[derive(Serialize, Deserialize)]
pub struct ProCurlState(ScoredPool);

impl PlainState for ProCurlState {
    const VERSION: u32 = 2;
}

impl Method for ProCurl {
    type Config = ProCurlConfig;
    type State = ProCurlState;
    const ID: &'static str = "procurl";
    const TITLE: &'static str = "ProCuRL";
    const LOOK: Option<Look> = Some(Look::new(GREEN, Dash::Short, Marker::Triangle));
    const SOURCE: &'static str =
        "Tzannetos et al., Proximal Curriculum for Reinforcement Learning Agents, TMLR 2023";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn schema() -> Option<Schema> {
        Some(schema_of::<ProCurlConfig>())
    }

    fn check(config: &ProCurlConfig) -> Result<(), CurriculumError> {
        let ok = config.beta.is_finite() && config.beta >= 0.0;
        CurriculumError::require(ok, "beta", "finite and at least 0", config.beta)?;
        config.probe.check(COMPARED)
    }

    fn build(config: ProCurlConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { config, pool: Arc::clone(&setting.pool) })
    }

    fn begin(&self, _setting: &Setting) -> Result<ProCurlState, CurriculumError> {
        Ok(ProCurlState(ScoredPool::new(self.pool.len(), COMPARED)))
    }

    fn propose(
        &self,
        ProCurlState(scored): &mut ProCurlState,
        lesson: &mut Lesson<'_>,
    ) -> Result<Proposal, CurriculumError> {
        let Self { config, pool } = self;
        if scored.common.probe.ask(&config.probe, pool, lesson, true)? == Answer::Recorded {
            let confidence = scored.common.probe.window().last().expect("recorded");
            let probabilities = config.probabilities(confidence, lesson.student.lowest_value());
            scored.scores = probabilities.into_iter().map(learnability).collect();
            scored.common.curriculum = config.curriculum(&scored.scores)?;
        }
        Ok(scored.propose(lesson.rng))
    }

    fn summary<'a>(&'a self, ProCurlState(scored): &'a ProCurlState) -> TeacherSummary<'a> {
        scored.common.summary()
    }

    fn judge(&self, ProCurlState(scored): &ProCurlState, student: &dyn Critic) -> Judgement {
        let confidence = scored.common.probe.window().last();
        let success = |confidence| self.config.probabilities(confidence, student.lowest_value());
        Judgement::of_all(confidence.map(success), scored.scores())
    }

    fn check_state(&self, ProCurlState(scored): &ProCurlState) -> Result<(), CurriculumError> {
        scored.check(self.pool.len(), COMPARED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_worked_probability() {
        // A quarter of the way from -50 to 0.
        assert_eq!(success_probability(-37.5, -50.0, 0.0), 0.25);
        // Outside the bounds, and without any.
        assert_eq!(success_probability(-60.0, -50.0, 0.0), 0.0);
        assert_eq!(success_probability(1.0, -50.0, 0.0), 1.0);
        assert_eq!(success_probability(-3.0, -3.0, -3.0), 0.0);
    }
}
