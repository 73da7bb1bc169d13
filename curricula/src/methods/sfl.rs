//! SFL: train on goals of high learnability, as rollouts measure it (Rutherford, Beukman, Willi, Lacerda,
//! Hawes and Foerster, "No Regrets: Investigating and Improving Regret Approximations for Curriculum
//! Discovery", NeurIPS 2024, arXiv 2408.15099).
//!
//! Now and then the student tries many fresh goals, a few episodes each. A goal that succeeds with
//! probability p has learnability p (1 − p) ([`learnability`]). The K most learnable goals ([`best`]) form a
//! set; until the next measurement every other episode's goal comes from it, and the others are fresh.
//!
//! # Deviations and choices
//! The authors' code is `amacrutherford/sampling-for-learnability` (commit 8b14e2e),
//! `sfl/train/jaxnav_sfl.py` and `sfl/train/config/jaxnav-sfl.yaml`.
//!
//! - Rollouts are steps in the environment, and the budget pays for them (`charge`). The authors count only
//!   training steps; `charge = false` does as they do, and reports still tell of the rollouts.
//! - The authors try 5000 levels, for as many episodes as fit into 1000 steps each, after every 50 updates of
//!   256 · 512 steps: 0.76 steps of rollouts for every one of training. The defaults here, 50 goals of 4
//!   episodes each after every 250 training episodes, are 0.8.
//! - The authors keep 100 of 5000 levels. Of 50 goals here the best 10 are kept, so that the set is not a
//!   handful; with 4 episodes each, learnability is 0, 3/16 or 1/4.
//! - Rollouts use the student's exploration noise, as the authors' sample from their stochastic policy.
//! - A level of the authors holds its start, too. Here every rollout of a goal begins at a start of its own,
//!   and so does every training episode towards it.
//! - Candidates are drawn by [`envs::GoalSource::sample_goal`] for the start of the last episode. Where goals
//!   depend on the start (HandManipulate*), a goal of the set keeps what it took from there: see
//!   [`her_iid_pool`](super::her_iid_pool).
//! - The authors measure before training begins. Here the first measurement follows the first cycle; until
//!   then goals are the environment's own. So are all fresh ones.
//! - Half of the authors' parallel environments draw from the set; here every episode does so with
//!   probability 1/2 (`share`).
//! - As in the authors' code the K best are kept even if their learnability is 0. Ties go to the goal that
//!   was drawn first.

use envs::rng::{Rng, uniform};
use envs::{GoalSource, Goals};
use looks::{Dash, Look, Marker};
use rand::Rng as _;
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::error::CurriculumError;
use crate::fresh::sample_goals;
use crate::judgement::learnability;
use crate::method::Method;
use crate::rollouts::{RolloutPolicy, RolloutRequest, Rollouts};
use crate::snapshot;
use crate::state::PlainState;

/// SFL's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct SflConfig {
    /// T, training episodes between two measurements of learnability.
    ///
    /// Unit: episodes. Range: at least 1. Source: a choice.
    pub interval: u64,
    /// Fresh goals that are tried in each.
    ///
    /// Unit: goals. Range: 1 to 100,000. Source: a choice.
    pub candidates: usize,
    /// E, episodes in which each of them is tried. With one, no goal has any learnability.
    ///
    /// Unit: episodes. Range: 2 to 1000. Source: a choice.
    pub rollouts: usize,
    /// K, how many of them are kept to train on: at most `candidates`.
    ///
    /// Unit: goals. Range: at least 1. Source: a choice.
    pub kept: usize,
    /// Probability that an episode's goal is one of those kept; else it is fresh.
    ///
    /// Unit: none. Range: 0 to 1. Source: the authors' code.
    pub share: f64,
    /// Whether the steps of rollouts are charged to `budget.steps`.
    ///
    /// Source: a choice.
    pub charge: bool,
}

impl Default for SflConfig {
    fn default() -> Self {
        Self { interval: 250, candidates: 50, rollouts: 4, kept: 10, share: 0.5, charge: true }
    }
}

/// The indices of the `k` largest of `scores`, the largest first; of equal ones the first.
///
/// ```
/// use curricula::methods::sfl::best;
///
/// assert_eq!(best(&[0.0, 0.25, 0.1875, 0.25], 3), [1, 3, 2]);
/// ```
pub fn best(scores: &[f64], k: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scores.len()).collect();
    order.sort_by(|&a, &b| scores[b].total_cmp(&scores[a]));
    order.truncate(k);
    order
}

/// The SFL teacher.
pub struct Sfl {
    config: SflConfig,
    /// G.
    goal: usize,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct SflState {
    /// Training episodes since the last request; `None` before the first.
    since: Option<u64>,
    /// The goals that are kept, shape `[K, G]`, and the learnability of each; none before the first
    /// measurement.
    set: Goals,
    learnability: Vec<f64>,
    measurements: u64,
    /// Mean success rate of the candidates in the last measurement.
    candidate_success: Option<f64>,
}

impl PlainState for SflState {
    const VERSION: u32 = 1;
}

impl Method for Sfl {
    type Config = SflConfig;
    type State = SflState;
    const ID: &'static str = "sfl";
    const TITLE: &'static str = "SFL";
    const LOOK: Option<Look> = Some(Look::new((20, 60, 230), Dash::Solid, Marker::Triangle));
    const SOURCE: &'static str = "Rutherford et al., No Regrets: Investigating and Improving Regret \
                                  Approximations for Curriculum Discovery, NeurIPS 2024";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn schema() -> Option<Schema> {
        Some(schema_of::<SflConfig>())
    }

    fn check(config: &SflConfig) -> Result<(), CurriculumError> {
        let SflConfig { interval, candidates, rollouts, kept, share, charge: _ } = *config;
        CurriculumError::require(interval >= 1, "interval", "at least 1", interval)?;
        let ok = (1..=100_000).contains(&candidates);
        CurriculumError::require(ok, "candidates", "in 1..=100000", candidates)?;
        CurriculumError::require((2..=1000).contains(&rollouts), "rollouts", "in 2..=1000", rollouts)?;
        let accepted = format!("in 1..={candidates}, the candidates");
        CurriculumError::require((1..=candidates).contains(&kept), "kept", &accepted, kept)?;
        CurriculumError::require((0.0..=1.0).contains(&share), "share", "in [0, 1]", share)
    }

    fn build(config: SflConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { config, goal: setting.spec.goal })
    }

    fn begin(&self, _setting: &Setting) -> Result<SflState, CurriculumError> {
        Ok(SflState {
            since: None,
            set: Goals::new(self.goal),
            learnability: Vec::new(),
            measurements: 0,
            candidate_success: None,
        })
    }

    fn propose(&self, state: &mut SflState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        state.since = state.since.map(|episodes| episodes + 1);
        let from_set = uniform(lesson.rng, 0.0, 1.0) < self.config.share;
        if !from_set || state.set.is_empty() {
            return Ok(Proposal::native());
        }
        let drawn = lesson.rng.random_range(0..state.set.len());
        Ok(Proposal::other(state.set.row(drawn).to_vec()).scored(state.learnability[drawn]))
    }

    fn request_rollouts(
        &self,
        state: &mut SflState,
        goals: &mut dyn GoalSource,
        rng: &mut Rng,
    ) -> Result<Option<RolloutRequest>, CurriculumError> {
        let SflConfig { interval, candidates, rollouts, charge, .. } = self.config;
        if state.since.is_some_and(|episodes| episodes < interval) {
            return Ok(None);
        }
        state.since = Some(0);
        let goals = sample_goals(goals, self.goal, candidates, rng);
        Ok(Some(RolloutRequest { goals, episodes: rollouts, policy: RolloutPolicy::Noisy, charge }))
    }

    fn hear_rollouts(&self, state: &mut SflState, rollouts: &Rollouts) -> Result<(), CurriculumError> {
        let rates = rollouts.success_rates();
        let scores: Vec<f64> = rates.iter().copied().map(learnability).collect();
        state.set.clear();
        state.learnability.clear();
        for index in best(&scores, self.config.kept) {
            state.set.push(rollouts.goals.row(index));
            state.learnability.push(scores[index]);
        }
        state.measurements += 1;
        state.candidate_success = Some(rates.iter().sum::<f64>() / rates.len() as f64);
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a SflState) -> TeacherSummary<'a> {
        let mean = state.learnability.iter().sum::<f64>() / state.learnability.len() as f64;
        let statistics = vec![
            ("measurements", state.measurements as f64),
            ("set_learnability", mean),
            ("candidate_success", state.candidate_success.unwrap_or(f64::NAN)),
        ];
        TeacherSummary { weights: None, statistics }
    }

    fn check_state(&self, state: &SflState) -> Result<(), CurriculumError> {
        let (width, kept, scored) = (state.set.width(), state.set.len(), state.learnability.len());
        if width != self.goal || kept > self.config.kept || kept != scored {
            return Err(snapshot::refuse(format!(
                "a set of {kept} goals of {width} numbers, {scored} scored"
            )));
        }
        Ok(())
    }
}
