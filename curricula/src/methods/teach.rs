//! TEACH: train on the goals whose value is moving (Chaudhary and Behera, "TEACH: Temporal Variance-Driven
//! Curriculum for Reinforcement Learning", arXiv 2512.22824, Algorithm 2).
//!
//! While the student learns to reach a goal, the critic's value of that goal changes; for goals it has
//! mastered and goals out of its reach the value stands still. So the teacher records the policy confidence
//! C(g) of every goal of the pool whenever the networks have changed (Eq. 7, [`Probe`](crate::Probe)), keeps
//! the last n records ([`Window`]), takes each goal's variance over them, δ_i (Eq. 8-9), and draws goals from
//! the curriculum K(g_i) = δ_i / Σδ (Eq. 10-11, [`Distribution::proportional`]).
//!
//! # Deviations and choices
//! - C(g) averages over s ~ D, the replay buffer's state distribution (said after Eq. 6). The paper does not
//!   say over how many states; here M = 8. With `states = "reference"` (default) they are drawn once and
//!   held, so that δ moves with the networks and their input normalisers alone, not with the sample. After
//!   100 evaluations, new states are measured beside them and take over when a window of theirs is full, so
//!   no window compares different states. The first states all come from the first episode, as the buffer
//!   holds nothing else yet. `replay` draws afresh at every evaluation, Eq. 7 to the letter by Monte Carlo,
//!   which adds Var_s/M of sampling noise to δ. `initial`, the start of the coming episode, is no reading of
//!   D; where starts are random they move δ, too.
//! - Eq. 7 has no clip, so values count as they are. An untrained critic's may lie outside [−1/(1−γ), 0].
//! - Eq. 8's k runs over the time of Algorithm 2, where every environment step brings an update of the
//!   student. Here the student learns once per cycle, so a window of n environment steps would nearly always
//!   hold n equal values. A value is therefore recorded once per change of the networks (`record = "cycle"`):
//!   n = 10 spans ten cycles, which at the student's defaults are 20 episodes (1,000 steps where H = 50) and
//!   400 gradient steps; in the paper it spans ten steps.
//! - Δ says only how often the curriculum is computed from the last n values. `record = "evaluation"` records
//!   only when Δ is due, which stretches the window with Δ. With a cycle of two episodes Δ = 1 and Δ = 2 come
//!   to the same, except under `initial`.
//! - Algorithm 2 speaks of a target goal at every step, section 5.2 of one at the beginning of each episode:
//!   here the latter, also for Δ > 1, where every episode draws anew from the last curriculum.
//! - Under `initial` a second episode of a cycle may have another start. If the curriculum is due, the newest
//!   value is then taken anew from there.
//! - While the window fills up, the variance (1/n, as in Eq. 8) is taken over the values it holds so far.
//!   With fewer than two, or when no value moves beyond rounding, the curriculum is uniform; the paper says
//!   nothing about either.
//! - A curriculum that falls due before there is anything to measure is computed as soon as there is.
//! - Eq. 11 draws goals in proportion to K, section 5.2 assigns "the goal with maximum temporal uncertainty":
//!   `selection`. With `argmax`, ties are drawn evenly.
//! - Eq. 9 integrates over the goal space; N goals stand for it (Eq. 10), drawn once at the start of
//!   training. The paper draws them uniformly; here they come from the environment's own goal distribution,
//!   which is not uniform everywhere.
//! - Section 5.4 smooths the value function by Eq. 12 and does not say whose action it judges.
//!   `target-critic` takes the trained policy's, `target` that of an averaged policy.
//! - `signal = "difference"` is a control: the size of the change between the last two values. Section 4.3
//!   argues against it.
//! - Goals of the pool are set at other starts than they were drawn for: for HandManipulate* see
//!   [`her_iid_pool`](super::her_iid_pool).

use std::sync::Arc;

use agents::Critic;
use envs::Goals;
use looks::colours::VERMILION;
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::judgement::Judgement;
use crate::method::Method;
use crate::pool_state::ScoredPool;
use crate::probe::{Answer, ProbeConfig};
use crate::state::PlainState;
use crate::variance::rounding;
use crate::window::Window;

/// TEACH's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct TeachConfig {
    /// n, how many values of each goal the window holds.
    ///
    /// Unit: values. Range: at least 2. Source: TEACH 5.3 and 5.5; 3 in its Figure 3.
    pub window: usize,
    /// Δ, the interplay frequency: training episodes between two computations of the curriculum.
    ///
    /// Unit: episodes. Range: at least 1. Source: TEACH 5.6.
    pub interplay: u64,
    /// When a value of every goal is recorded.
    ///
    /// Source: a choice; the paper leaves it open.
    pub record: Recording,
    /// What counts as learning progress.
    ///
    /// Source: TEACH, Eq. 8; `difference` is a control.
    pub signal: Signal,
    /// How C(g) is measured. Networks: `online` (paper), `target-critic` (Figure 3: the smooth value of the
    /// policy's action) or `target` (both averaged). States: `reference` (default) or `replay` (both after
    /// the paper's D), or `initial`. A `renewal` below n is refused.
    #[serde(flatten)]
    pub probe: ProbeConfig,
    /// How the curriculum becomes a goal.
    ///
    /// Source: TEACH, Eq. 11; `argmax`: section 5.2.
    pub selection: TeachSelection,
}

/// A field of a method's config that its paper varies in an ablation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AblationAxis {
    /// Short name, for files and claims.
    pub id: &'static str,
    /// Figure of the paper that varies it.
    pub figure: u32,
    /// The field's name in the method's config.
    pub field: &'static str,
    /// Title of its figures.
    pub title: &'static str,
    /// What stands before a value: `n = 3`.
    pub symbol: &'static str,
    /// The paper's own value as text, which the others are compared with.
    pub reference: &'static str,
}

/// The fields of [`TeachConfig`] that the paper varies in its Figures 3 to 5.
pub static AXES: [AblationAxis; 3] = [
    AblationAxis {
        id: "confidence",
        figure: 3,
        field: "confidence",
        title: "confidence of online networks, or smoothed by target networks",
        symbol: "confidence",
        reference: "online",
    },
    AblationAxis {
        id: "window",
        figure: 4,
        field: "window",
        title: "temporal window n",
        symbol: "n",
        reference: "10",
    },
    AblationAxis {
        id: "interplay",
        figure: 5,
        field: "interplay",
        title: "interplay frequency Δ",
        symbol: "Δ",
        reference: "1",
    },
];

/// When TEACH records a value of every goal: what Eq. 8 sums over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Recording {
    /// Whenever the networks have changed: with this student after every cycle.
    #[default]
    Cycle,
    /// When Δ is due, and the networks have changed since the last time.
    Evaluation,
}

/// What TEACH takes for learning progress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Signal {
    /// The variance of a goal's value over the window (Eq. 8).
    #[default]
    Variance,
    /// The size of its last change.
    Difference,
}

impl Signal {
    /// Every goal's progress, shape `[N]`.
    pub fn of(self, window: &Window) -> Vec<f64> {
        match self {
            Self::Variance => window.variance(),
            Self::Difference => window.difference(),
        }
    }

    /// The progress that rounding alone causes, in values down to `lowest`.
    fn negligible(self, lowest: f64) -> f64 {
        match self {
            Self::Variance => rounding(lowest).powi(2),
            Self::Difference => rounding(lowest),
        }
    }
}

/// How TEACH turns the curriculum K into a goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TeachSelection {
    /// A draw from K.
    #[default]
    Proportional,
    /// The goal with the largest K.
    Argmax,
}

impl Default for TeachConfig {
    fn default() -> Self {
        Self {
            window: 10,
            interplay: 1,
            record: Recording::Cycle,
            signal: Signal::Variance,
            probe: ProbeConfig::default(),
            selection: TeachSelection::Proportional,
        }
    }
}

impl TeachConfig {
    /// K: in proportion to each goal's `progress`, shape `[N]`, or all on the largest; of values down to
    /// `lowest`.
    fn curriculum(&self, progress: &[f64], lowest: f64) -> Result<Distribution, CurriculumError> {
        let proportional =
            Distribution::proportional(progress, self.signal.negligible(lowest), "learning progress")?;
        match self.selection {
            TeachSelection::Proportional => Ok(proportional),
            TeachSelection::Argmax => Distribution::argmax(proportional.probabilities(), "curriculum"),
        }
    }
}

/// The TEACH teacher.
pub struct Teach {
    config: TeachConfig,
    pool: Arc<Goals>,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct TeachState {
    /// Goals proposed so far.
    episodes: u64,
    /// Whether a curriculum has fallen due that could not be computed yet.
    due: bool,
    /// The curriculum, and the progress of every goal that it was computed from.
    scored: ScoredPool,
}

impl PlainState for TeachState {
    const VERSION: u32 = 3;
}

impl Method for Teach {
    type Config = TeachConfig;
    type State = TeachState;
    const ID: &'static str = "teach";
    const TITLE: &'static str = "TEACH";
    const LOOK: Option<Look> = Some(Look::new(VERMILION, Dash::Solid, Marker::Circle));
    const SOURCE: &'static str = "Chaudhary and Behera, TEACH, arXiv 2512.22824";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn schema() -> Option<Schema> {
        Some(schema_of::<TeachConfig>())
    }

    fn check(config: &TeachConfig) -> Result<(), CurriculumError> {
        CurriculumError::require(config.window >= 2, "window", "at least 2", config.window)?;
        CurriculumError::require(config.interplay >= 1, "interplay", "at least 1", config.interplay)?;
        config.probe.check(config.window)
    }

    fn build(config: TeachConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { config, pool: Arc::clone(&setting.pool) })
    }

    fn begin(&self, _setting: &Setting) -> Result<TeachState, CurriculumError> {
        let scored = ScoredPool::new(self.pool.len(), self.config.window);
        Ok(TeachState { episodes: 0, due: false, scored })
    }

    fn propose(&self, state: &mut TeachState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let Self { config, pool } = self;
        let TeachState { episodes, due, scored } = state;
        *due |= episodes.is_multiple_of(config.interplay);
        *episodes += 1;
        if *due || config.record == Recording::Cycle {
            let answer = scored.common.probe.ask(&config.probe, pool, lesson, *due)?;
            if *due && answer != Answer::NoStates {
                *due = false;
                let window = scored.common.probe.window();
                scored.scores = config.signal.of(window);
                // Values that no return can have are rounded more coarsely.
                let lowest = lesson.student.lowest_value().min(-window.magnitude());
                scored.common.curriculum = config.curriculum(&scored.scores, lowest)?;
            }
        }
        Ok(scored.propose(lesson.rng))
    }

    fn summary<'a>(&'a self, state: &'a TeachState) -> TeacherSummary<'a> {
        state.scored.common.summary()
    }

    /// TEACH itself makes no estimate of success; its confidence is read as ProCuRL reads it.
    fn judge(&self, state: &TeachState, student: &dyn Critic) -> Judgement {
        let scored = &state.scored;
        let success = scored.common.probe.success(student.lowest_value());
        Judgement::of_all(success, scored.scores())
    }

    fn check_state(&self, state: &TeachState) -> Result<(), CurriculumError> {
        state.scored.check(self.pool.len(), self.config.window)
    }
}
