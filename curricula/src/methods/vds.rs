//! VDS: train on the goals whose value an ensemble disagrees on (Zhang, Abbeel and Pinto, "Automatic
//! Curriculum Learning through Value Disagreement", NeurIPS 2020, Algorithm 1).
//!
//! At the frontier of what the student can do, value functions trained on the same experience from different
//! initial weights still differ; for mastered goals and for goals out of reach they agree. So E critics learn
//! the value of the student's policy, each from batches of its own ([`agents::Ensemble`]). For the coming
//! episode, candidate goals are drawn afresh from the environment, every member computes Q_e(s0, g, π(s0, g))
//! for each, and one candidate is drawn in proportion to the members' disagreement ([`Disagreement`],
//! [`Distribution::proportional`]).
//!
//! # Deviations and choices
//! The authors' code is `zzyunzhi/vds` (commit a29fc5a, `baselines/`).
//!
//! - How much the ensemble learns: the authors' README runs `baselines.ve_run`, which after every single
//!   episode takes 100 steps of 1000 transitions for each member, then 40 steps of 256 for the student. The
//!   student's preset `official` does the same. Else the ensemble takes 40 steps per cycle on batches of the
//!   student's size, as `vds_config` does, which `baselines.goalenv_run` reads (there two episodes per cycle,
//!   and batches of 256 for both).
//! - The ensemble's experience is the student's buffer, read without hindsight: every transition with the
//!   goal that was asked for. The authors' code keeps a second buffer of the same size with the same
//!   episodes.
//! - Members have the student's architecture, γ and input clipping, as in the authors' code; batch size and
//!   Polyak coefficient follow the student unless given.
//! - The ensemble trains after the student in each cycle, not before, so next actions come from the newer
//!   policy.
//! - Candidates are drawn by [`envs::GoalSource::sample_goal`], as the environment draws goals for the start
//!   at hand. The authors' code draws them from another instance, which is reset once at the beginning. That
//!   matters where goals depend on the start (HandManipulate*): here candidates are conditional on it, as
//!   native goals are.
//! - Before it has learned, the ensemble's initial weights disagree by chance; like the authors' code this
//!   does not wait for it to learn.
//! - Next and candidate actions come from the online policy, and candidates are judged by the online members,
//!   clipped to [−1/(1−γ), 0], from the start of the coming episode: all as in the authors' code.
//! - Where the members' values differ by rounding alone, the draw under `std`, `var` and `tanh` is uniform,
//!   in place of one in proportion to rounding ([`Disagreement::negligible`]). The authors' code is uniform
//!   where the sum over candidates is below 1e-8. `exp` gives agreement the weight 1, so there it needs no
//!   rule.
//! - exp overflows for a standard deviation above 709. That takes values below −1418, so γ > 0.9992, and is
//!   an error.
//! - Inputs are normalised by the states and goals of the transitions as they came, without hindsight. The
//!   authors' code draws as many transitions of each cycle's episodes with replacement; here every one counts
//!   once.

use agents::{
    AgentError, Auto, Batch, Critic, Ensemble, EnsembleConfig, Episode, Network, Preset, StudentConfig,
};
use envs::rng::{Purpose, Rng, stream};
use envs::{Goals, Reward, Rows};
use looks::colours::BLUE;
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::fresh::sample_goals;
use crate::method::Method;
use crate::snapshot;
use crate::state::TeacherState;
use crate::variance::{population_variance, rounding};

/// VDS's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct VdsConfig {
    /// E, critics in the ensemble.
    ///
    /// Unit: critics. Range: 2 to 64. Source: the paper.
    pub members: usize,
    /// Fresh candidate goals per episode.
    ///
    /// Unit: goals. Range: 1 to 100,000. Source: the paper.
    pub candidates: usize,
    /// How disagreement between the critics is measured.
    ///
    /// Source: the paper.
    pub disagreement: Disagreement,
    /// Gradient steps of every critic per cycle of the student.
    ///
    /// Unit: gradient steps. Range: 1 to 1,000,000. Auto: 40; with `student.preset = "official"` 100, after
    /// every single episode. Source: the authors' `vds_config`; the path that their README runs.
    pub updates_per_cycle: Auto<usize>,
    /// Transitions per gradient step and critic.
    ///
    /// Unit: transitions. Range: 1 to 65,536. Auto: the student's; with `student.preset = "official"` 1000.
    /// Source: the authors' code.
    pub batch: Auto<usize>,
    /// Adam's step size.
    ///
    /// Unit: none. Range: above 0. Source: the authors' code.
    pub learning_rate: f64,
    /// Weight of the old target networks, which follow once per cycle.
    ///
    /// Unit: none. Range: 0 to 1. Auto: the student's. Source: the authors' code.
    pub polyak: Auto<f64>,
}

impl Default for VdsConfig {
    fn default() -> Self {
        Self {
            members: 3,
            candidates: 1000,
            disagreement: Disagreement::Std,
            updates_per_cycle: Auto::Auto,
            batch: Auto::Auto,
            learning_rate: 1e-3,
            polyak: Auto::Auto,
        }
    }
}

/// How far the members' values of a goal lie apart; `std` and `var` are those of the population of members.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Disagreement {
    /// Standard deviation.
    #[default]
    Std,
    /// Variance.
    Var,
    /// tanh of the variance: all large disagreements count alike.
    Tanh,
    /// exp of the standard deviation: even agreement keeps some weight.
    Exp,
}

impl Disagreement {
    /// The disagreement of one goal's `values`, one per member.
    pub fn of(self, values: impl IntoIterator<Item = f64>) -> f64 {
        let variance = population_variance(values);
        match self {
            Self::Std => variance.sqrt(),
            Self::Var => variance,
            Self::Tanh => variance.tanh(),
            Self::Exp => variance.sqrt().exp(),
        }
    }

    /// The disagreement that rounding alone causes, in values down to `lowest` = −1/(1−γ).
    pub fn negligible(self, lowest: f64) -> f64 {
        match self {
            Self::Std => rounding(lowest),
            // tanh x = x for an x so small.
            Self::Var | Self::Tanh => rounding(lowest).powi(2),
            // exp(0) = 1 is a weight like any other.
            Self::Exp => 0.0,
        }
    }

    /// The disagreement of every goal, shape `[n]`, from the members' values, shape `[E, n]`.
    pub fn over(self, values: &Rows) -> Vec<f64> {
        (0..values.width()).map(|goal| self.of(values.iter().map(|member| member[goal]))).collect()
    }

    /// The curriculum that follows from every goal's `disagreement`, shape `[n]`: in proportion to it, and
    /// uniform where it is nothing but the rounding of values down to `lowest` = −1/(1−γ).
    ///
    /// # Errors
    /// [`CurriculumError::NotFinite`] if a disagreement is not finite.
    pub fn curriculum(self, disagreement: &[f64], lowest: f64) -> Result<Distribution, CurriculumError> {
        Distribution::proportional(disagreement, self.negligible(lowest), "disagreement")
    }
}

/// The VDS teacher.
pub struct Vds {
    config: VdsConfig,
    /// The ensemble that the config asks for beside the student.
    ensemble: EnsembleConfig,
    /// Gradient steps of every member per cycle of the student.
    updates: usize,
}

/// Everything that changes while teaching, and buffers that are filled anew whenever they are used.
pub struct VdsState {
    ensemble: Ensemble,
    latest: Latest,
    /// The transitions of a gradient step, a batch for every member.
    batch: Batch,
    /// The start of the episode, once per candidate, shape `[candidates, S]`.
    starts: Rows,
}

/// What is saved of [`VdsState`].
#[derive(Serialize, Deserialize)]
struct SavedVds {
    ensemble: Vec<u8>,
    latest: Latest,
}

impl TeacherState for VdsState {
    const VERSION: u32 = 2;

    fn write(&self) -> Result<Vec<u8>, CurriculumError> {
        let Self { ensemble, latest, batch: _, starts: _ } = self;
        Ok(snapshot::plain_bytes(&SavedVds { ensemble: ensemble.save()?, latest: *latest }))
    }

    fn read(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        let SavedVds { ensemble, latest } = snapshot::from_plain_bytes(bytes)?;
        self.ensemble.load(&ensemble).map_err(|error| match error {
            AgentError::State { .. } => snapshot::refuse_because("its ensemble does not fit", error),
            other => other.into(),
        })?;
        self.latest = latest;
        Ok(())
    }
}

/// What happened last, for the records; NaN before it has happened.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Latest {
    /// Of the last choice among candidates.
    entropy: f64,
    effective_goals: f64,
    mean_disagreement: f64,
    max_disagreement: f64,
    /// Mean over members and gradient steps of the last cycle.
    loss: f64,
}

impl Default for Latest {
    fn default() -> Self {
        let [entropy, effective_goals, mean_disagreement, max_disagreement, loss] = [f64::NAN; 5];
        Self { entropy, effective_goals, mean_disagreement, max_disagreement, loss }
    }
}

impl VdsConfig {
    /// Gradient steps of every member per cycle of `student`.
    fn updates(&self, student: &StudentConfig) -> usize {
        self.updates_per_cycle.value_or(|| match student.preset {
            Preset::Harmonised => 40,
            Preset::Official => 100,
        })
    }

    /// The ensemble that this asks for beside `student`.
    fn ensemble(&self, student: &StudentConfig) -> EnsembleConfig {
        EnsembleConfig {
            members: self.members,
            batch: self.batch.value_or(|| match student.preset {
                Preset::Harmonised => student.batch(),
                Preset::Official => 1000,
            }),
            lr: self.learning_rate,
            polyak: self.polyak.value_or(|| student.polyak),
        }
    }
}

impl VdsState {
    /// The disagreement on every one of `candidates`, shape `[n, G]`, from the start at hand. Shape: `[n]`.
    fn disagreement(
        &mut self,
        kind: Disagreement,
        candidates: &Goals,
        lesson: &mut Lesson<'_>,
    ) -> Result<Vec<f64>, CurriculumError> {
        self.starts.clear();
        candidates.iter().for_each(|_| self.starts.push(&lesson.start.state));
        let actions = lesson.student.policy(&self.starts, candidates, Network::Online)?;
        let values = self.ensemble.values(&self.starts, candidates, &actions)?;
        Ok(kind.over(&values))
    }
}

impl Method for Vds {
    type Config = VdsConfig;
    type State = VdsState;
    const ID: &'static str = "vds";
    const TITLE: &'static str = "VDS";
    const LOOK: Option<Look> = Some(Look::new(BLUE, Dash::Long, Marker::Square));
    const SOURCE: &'static str =
        "Zhang, Abbeel and Pinto, Automatic Curriculum Learning through Value Disagreement, NeurIPS 2020";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn schema() -> Option<Schema> {
        Some(schema_of::<VdsConfig>())
    }

    fn check(config: &VdsConfig) -> Result<(), CurriculumError> {
        let VdsConfig { members, candidates, learning_rate, .. } = *config;
        CurriculumError::require((2..=64).contains(&members), "members", "in 2..=64", members)?;
        let ok = (1..=100_000).contains(&candidates);
        CurriculumError::require(ok, "candidates", "in 1..=100000", candidates)?;
        if let Auto::Value(updates) = config.updates_per_cycle {
            let ok = (1..=1_000_000).contains(&updates);
            CurriculumError::require(ok, "updates_per_cycle", "\"auto\" or in 1..=1000000", updates)?;
        }
        let ok = learning_rate > 0.0 && learning_rate.is_finite();
        CurriculumError::require(ok, "learning_rate", "positive and finite", learning_rate)?;
        if let Auto::Value(batch) = config.batch {
            let ok = (1..=65_536).contains(&batch);
            CurriculumError::require(ok, "batch", "\"auto\" or in 1..=65536", batch)?;
        }
        if let Auto::Value(polyak) = config.polyak {
            let ok = (0.0..=1.0).contains(&polyak);
            CurriculumError::require(ok, "polyak", "\"auto\" or in [0, 1]", polyak)?;
        }
        Ok(())
    }

    fn build(config: VdsConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        let student = &setting.student;
        Ok(Self { ensemble: config.ensemble(student), updates: config.updates(student), config })
    }

    fn begin(&self, setting: &Setting) -> Result<VdsState, CurriculumError> {
        // The teacher's key, but a stream of its own: initial weights share no number with later draws.
        let mut rng = stream(setting.seed, Purpose::Teacher);
        rng.set_stream(1);
        let spec = &setting.spec;
        let ensemble = Ensemble::new(self.ensemble, &setting.student, spec, &mut rng)?;
        Ok(VdsState {
            batch: Batch::new(spec, ensemble.batch_len()),
            starts: Rows::with_capacity(spec.state, self.config.candidates),
            latest: Latest::default(),
            ensemble,
        })
    }

    fn propose(&self, state: &mut VdsState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let VdsConfig { disagreement: kind, candidates: n, .. } = self.config;
        let candidates = sample_goals(lesson.goals, lesson.student.spec().goal, n, lesson.rng);
        let disagreement = state.disagreement(kind, &candidates, lesson)?;
        let curriculum = kind.curriculum(&disagreement, lesson.student.lowest_value())?;
        let drawn = curriculum.draw(lesson.rng);
        let score = disagreement[drawn];
        state.latest = Latest {
            entropy: curriculum.entropy(),
            effective_goals: curriculum.effective_goals(),
            mean_disagreement: disagreement.iter().sum::<f64>() / disagreement.len() as f64,
            max_disagreement: disagreement.into_iter().fold(0.0, f64::max),
            ..state.latest
        };
        Ok(Proposal::other(candidates.row(drawn).to_vec()).scored(score))
    }

    fn observe(&self, state: &mut VdsState, episode: &Episode) -> Result<(), CurriculumError> {
        Ok(state.ensemble.observe(episode)?)
    }

    fn learn(
        &self,
        state: &mut VdsState,
        student: &mut dyn Critic,
        reward: &dyn Reward,
        rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        let VdsState { ensemble, batch, latest, .. } = state;
        let mut loss = 0.0;
        for _ in 0..self.updates {
            student.replay_batch(reward, rng, batch)?;
            student.label_next_actions(batch, Network::Online)?;
            loss += ensemble.update(batch)?;
        }
        ensemble.follow()?;
        latest.loss = loss / self.updates as f64;
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a VdsState) -> TeacherSummary<'a> {
        let Latest { entropy, effective_goals, mean_disagreement, max_disagreement, loss } = state.latest;
        let statistics = vec![
            (names::ENTROPY, entropy),
            (names::EFFECTIVE_GOALS, effective_goals),
            ("disagreement_mean", mean_disagreement),
            ("disagreement_max", max_disagreement),
            ("ensemble_updates", state.ensemble.gradient_steps() as f64),
            ("ensemble_loss", loss),
        ];
        TeacherSummary { weights: None, statistics }
    }
}
