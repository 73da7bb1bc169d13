//! LP: train where success changes most (Colas, Fournier, Sigaud, Chetouani and Oudeyer, "CURIOUS:
//! Intrinsically Motivated Modular Multi-Goal Reinforcement Learning", ICML 2019, arXiv 1810.06284; Matiisen,
//! Oliver, Cohen and Schulman, "Teacher-Student Curriculum Learning", 2017, arXiv 1707.00183).
//!
//! The goal space is cut into N regions ([`Regions`]). The learning progress LP of a region is the absolute
//! difference between its success over the last w episodes and over the w before ([`History::progress`]), so
//! that forgetting counts as well. A region has probability ε/N + (1 − ε) LP/Σ LP ([`region_weights`]); its
//! goals are alike.
//!
//! # Deviations and choices
//! The codes of the authors are `flowersteam/curious` (commit 05f0ce0), `baselines/her/queues.py` and
//! `baselines/her/experiment/train.py`, and `tambetm/TSCL` (commit ec41eea),
//! `addition/addition_rnn_teacher.py`.
//!
//! - CURIOUS chooses among modules, tasks with goal spaces of their own, and TSCL among tasks. Here there is
//!   one task, and its goal space is cut into regions: 16 cells of a k-d tree over the pool, of as many goals
//!   each. The number is a choice, and so is the tree; it does not change during a run.
//! - Success is that of training episodes, exploration noise included. In CURIOUS every tenth episode is
//!   played without noise, to measure competence alone.
//! - w = 50 episodes per region. CURIOUS has 300, from 19 workers that together play far more episodes than a
//!   run here; TSCL has 10. Before there are 2w episodes, those there are, are halved, from two on; CURIOUS
//!   does so from three on.
//! - ε = 0.4 as in CURIOUS. TSCL takes the region with the largest progress instead, or draws by a softmax.
//! - CURIOUS also replays experience of modules in proportion to their LP. Here the student's replay stays as
//!   it is for all methods.
//! - Where no region makes progress, all are alike, as in CURIOUS.
//! - Goals of the pool are set at other starts than they were drawn for: for HandManipulate* see
//!   [`her_iid_pool`](super::her_iid_pool).

use std::sync::Arc;

use agents::{Critic, Episode};
use envs::Goals;
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::history::History;
use crate::judgement::Judgement;
use crate::method::Method;
use crate::regions::Regions;
use crate::snapshot;
use crate::state::PlainState;

/// LP's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct LpConfig {
    /// N, regions of the goal space; no more than the pool has goals.
    ///
    /// Unit: regions. Range: 1 to 100,000. Source: a choice.
    pub regions: usize,
    /// w, episodes of a region whose success is compared with that of as many before.
    ///
    /// Unit: episodes. Range: 1 to 100,000. Source: a choice.
    pub window: usize,
    /// ε, the share of episodes that goes to all regions alike.
    ///
    /// Unit: none. Range: 0 to 1. Source: the code of CURIOUS.
    pub epsilon: f64,
}

impl Default for LpConfig {
    fn default() -> Self {
        Self { regions: 16, window: 50, epsilon: 0.4 }
    }
}

/// ε/N + (1 − ε) LP/Σ LP of every region from its progress, shape `[N]`; 1/N where no region makes any.
///
/// ```
/// use curricula::methods::lp::region_weights;
///
/// // 0.4/2 + 0.6 · 0.25 and 0.4/2 + 0.6 · 0.75.
/// let weights = region_weights(&[0.1, 0.3], 0.4);
/// assert!((weights[0] - 0.35).abs() < 1e-15 && (weights[1] - 0.65).abs() < 1e-15);
/// assert_eq!(region_weights(&[0.0, 0.0], 0.4), [0.5, 0.5]);
/// ```
pub fn region_weights(progress: &[f64], epsilon: f64) -> Vec<f64> {
    let (n, total) = (progress.len() as f64, progress.iter().sum::<f64>());
    if total == 0.0 {
        return vec![1.0 / n; progress.len()];
    }
    progress.iter().map(|lp| epsilon / n + (1.0 - epsilon) * lp / total).collect()
}

/// The LP teacher.
pub struct Lp {
    config: LpConfig,
    pool: Arc<Goals>,
    regions: Regions,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct LpState {
    /// How episodes ended, by region.
    history: History,
    /// The region of the goal that was proposed for the coming episode.
    playing: Option<usize>,
    curriculum: Distribution,
}

impl PlainState for LpState {
    const VERSION: u32 = 1;
}

impl Lp {
    /// Of every region.
    fn progress(&self, state: &LpState) -> Vec<f64> {
        (0..self.regions.count()).map(|region| state.history.progress(region)).collect()
    }
}

impl Method for Lp {
    type Config = LpConfig;
    type State = LpState;
    const ID: &'static str = "lp";
    const TITLE: &'static str = "LP";
    const LOOK: Option<Look> = Some(Look::new((225, 45, 60), Dash::DashDot, Marker::Wedge));
    const SOURCE: &'static str =
        "Colas et al., CURIOUS: Intrinsically Motivated Modular Multi-Goal Reinforcement Learning, ICML 2019";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn schema() -> Option<Schema> {
        Some(schema_of::<LpConfig>())
    }

    fn check(config: &LpConfig) -> Result<(), CurriculumError> {
        let LpConfig { regions, window, epsilon } = *config;
        CurriculumError::require((1..=100_000).contains(&regions), "regions", "in 1..=100000", regions)?;
        CurriculumError::require((1..=100_000).contains(&window), "window", "in 1..=100000", window)?;
        CurriculumError::require((0.0..=1.0).contains(&epsilon), "epsilon", "in [0, 1]", epsilon)
    }

    fn build(config: LpConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        let regions = Regions::new(&setting.pool, config.regions);
        Ok(Self { config, pool: Arc::clone(&setting.pool), regions })
    }

    fn begin(&self, _setting: &Setting) -> Result<LpState, CurriculumError> {
        Ok(LpState {
            history: History::new(self.regions.count(), 2 * self.config.window),
            playing: None,
            curriculum: Distribution::uniform(self.pool.len()),
        })
    }

    fn propose(&self, state: &mut LpState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let progress = self.progress(state);
        let weights = region_weights(&progress, self.config.epsilon);
        let groups: Vec<(f64, &[usize])> = weights
            .iter()
            .enumerate()
            .map(|(region, &weight)| (weight, self.regions.members(region)))
            .collect();
        state.curriculum = Distribution::of_groups(&groups, self.pool.len());
        let goal = state.curriculum.draw(lesson.rng);
        let region = self.regions.of(goal);
        state.playing = Some(region);
        Ok(Proposal::pool(goal).scored(progress[region]))
    }

    fn observe(&self, state: &mut LpState, episode: &Episode) -> Result<(), CurriculumError> {
        let region = self.regions.told_of(&self.pool, &episode.goal, state.playing.take());
        state.history.push(region, episode.success);
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a LpState) -> TeacherSummary<'a> {
        let progress = self.progress(state);
        let mut summary = state.curriculum.summary();
        summary.statistics.push(("progress_mean", progress.iter().sum::<f64>() / progress.len() as f64));
        summary.statistics.push(("progress_max", progress.into_iter().fold(0.0, f64::max)));
        summary
    }

    /// A goal has the progress of its region.
    fn judge(&self, state: &LpState, _student: &dyn Critic) -> Judgement {
        let progress = self.progress(state);
        let scores = (0..self.pool.len()).map(|goal| progress[self.regions.of(goal)]).collect();
        Judgement::of_all(None, Some(scores))
    }

    fn check_state(&self, state: &LpState) -> Result<(), CurriculumError> {
        snapshot::require_goals(state.curriculum.probabilities().len(), self.pool.len())?;
        state.history.check(self.regions.count(), 2 * self.config.window)?;
        if state.playing.is_some_and(|region| region >= self.regions.count()) {
            return Err(snapshot::refuse("an episode of a region that there is not"));
        }
        Ok(())
    }
}
