//! GOID: train on goals of intermediate difficulty (Florensa, Held, Geng and Abbeel, "Automatic Goal
//! Generation for Reinforcement Learning Agents", ICML 2018, arXiv 1705.06366).
//!
//! A goal is of intermediate difficulty if the student succeeds at it sometimes, at a rate in [R_min, R_max]
//! ([`is_of_intermediate_difficulty`]). Most episodes' goals are of this kind now, some have been at some
//! time, so that they are not forgotten, and some are tried afresh.
//!
//! # Deviations and choices
//! The authors' code is `florensacc/rllab-curriculum` (commit f55b5022), `curriculum/state/evaluator.py` and
//! `curriculum/experiments/goals/maze/maze_gan_algo.py`.
//!
//! - The pool stands in for the authors' GAN, which learns to generate more goals like those of intermediate
//!   difficulty. What the GAN generalises, neighbours share here: the pool is cut into regions of a few goals
//!   each ([`Regions`]), and the episodes of all goals of a region count together. With
//!   `goals_per_region = 1` every goal has its own.
//! - The rate is that of the last `window` training episodes, or of all there are while they are fewer, with
//!   exploration noise. The authors' maze experiment labels goals by their paths in training, too: those with
//!   two or more.
//! - R_min = 0.1 and R_max = 0.9 as in the paper. The paper also finds 0.25 and 0.75 to work. The maze
//!   experiment of their code takes every goal that is sometimes reached and sometimes not, bounds excluded;
//!   here bounds are included.
//! - A goal stays an earlier one once it has been of intermediate difficulty. The authors keep such goals
//!   unless one lies within 0.3 of another; the pool is finite, so all stay.
//! - The shares are 0.7 now, 0.2 earlier, 0.1 afresh. The authors' are 2/3 from the GAN, whose noise tries
//!   new goals, and 1/3 earlier ones.
//! - Afresh are the goals whose region has not been tried `window` times; if there is none any more, all
//!   goals. The share of a kind that has no goals goes to the others in proportion, so that all episodes are
//!   tried afresh until a region succeeds now and then. The authors begin with goals that the untrained
//!   student achieves by chance.
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
use crate::judgement::{Judgement, learnability};
use crate::method::Method;
use crate::regions::Regions;
use crate::snapshot;
use crate::state::PlainState;

/// GOID's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct GoidConfig {
    /// R_min, the lowest success rate of intermediate difficulty.
    ///
    /// Unit: none. Range: 0 to 1. Source: the paper.
    pub lowest: f64,
    /// R_max, the highest one; not below `lowest`.
    ///
    /// Unit: none. Range: 0 to 1. Source: the paper.
    pub highest: f64,
    /// w, the last episodes of a region that its success rate is taken from.
    ///
    /// Unit: episodes. Range: 2 to 100,000. Source: a choice.
    pub window: usize,
    /// Goals of the pool that share their episodes, at most.
    ///
    /// Unit: goals. Range: at least 1. Source: a choice.
    pub goals_per_region: usize,
    /// Share of episodes whose goal has been of intermediate difficulty at some time.
    ///
    /// Unit: none. Range: 0 to below 1. Source: a choice; 1/3 in the authors' code.
    pub earlier: f64,
    /// Share of episodes whose goal is tried afresh; together with `earlier` at most 1.
    ///
    /// Unit: none. Range: above 0. Source: a choice.
    pub fresh: f64,
}

impl Default for GoidConfig {
    fn default() -> Self {
        Self { lowest: 0.1, highest: 0.9, window: 10, goals_per_region: 10, earlier: 0.2, fresh: 0.1 }
    }
}

/// Whether a success rate is one of intermediate difficulty: in [`lowest`, `highest`].
///
/// ```
/// use curricula::methods::goid::is_of_intermediate_difficulty;
///
/// let are = [0.0, 0.1, 0.5, 0.9, 1.0].map(|p| is_of_intermediate_difficulty(p, 0.1, 0.9));
/// assert_eq!(are, [false, true, true, true, false]);
/// ```
pub fn is_of_intermediate_difficulty(rate: f64, lowest: f64, highest: f64) -> bool {
    (lowest..=highest).contains(&rate)
}

/// The GOID teacher.
pub struct Goid {
    config: GoidConfig,
    pool: Arc<Goals>,
    regions: Regions,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct GoidState {
    /// How episodes ended, by region.
    history: History,
    /// Whether a region has been of intermediate difficulty at some time.
    earlier: Vec<bool>,
    /// The region of the goal that was proposed for the coming episode.
    playing: Option<usize>,
    curriculum: Distribution,
}

impl PlainState for GoidState {
    const VERSION: u32 = 1;
}

impl Goid {
    /// Whether a region is of intermediate difficulty now.
    fn is_good(&self, history: &History, region: usize) -> bool {
        let GoidConfig { lowest, highest, .. } = self.config;
        history.rate(region).is_some_and(|rate| is_of_intermediate_difficulty(rate, lowest, highest))
    }

    /// The goals of all regions that `are`.
    fn goals(&self, are: impl Fn(usize) -> bool) -> Vec<usize> {
        let regions = (0..self.regions.count()).filter(|&region| are(region));
        regions.flat_map(|region| self.regions.members(region)).copied().collect()
    }

    fn curriculum(&self, state: &GoidState) -> Distribution {
        let GoidConfig { window, earlier, fresh, .. } = self.config;
        let good = self.goals(|region| self.is_good(&state.history, region));
        let once = self.goals(|region| state.earlier[region]);
        let mut untried = self.goals(|region| state.history.tries(region) < window);
        if untried.is_empty() {
            untried = self.goals(|_| true);
        }
        let groups = [(1.0 - earlier - fresh, &*good), (earlier, &*once), (fresh, &*untried)];
        Distribution::of_groups(&groups.map(|(share, goals)| (share.max(0.0), goals)), self.pool.len())
    }
}

impl Method for Goid {
    type Config = GoidConfig;
    type State = GoidState;
    const ID: &'static str = "goid";
    const TITLE: &'static str = "GOID";
    const LOOK: Option<Look> = Some(Look::new((90, 140, 20), Dash::Dotted, Marker::Square));
    const SOURCE: &'static str =
        "Florensa et al., Automatic Goal Generation for Reinforcement Learning Agents, ICML 2018";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn schema() -> Option<Schema> {
        Some(schema_of::<GoidConfig>())
    }

    fn check(config: &GoidConfig) -> Result<(), CurriculumError> {
        let GoidConfig { lowest, highest, window, goals_per_region, earlier, fresh } = *config;
        CurriculumError::require((0.0..=1.0).contains(&lowest), "lowest", "in [0, 1]", lowest)?;
        let accepted = format!("in [{lowest}, 1]");
        CurriculumError::require((lowest..=1.0).contains(&highest), "highest", &accepted, highest)?;
        CurriculumError::require((2..=100_000).contains(&window), "window", "in 2..=100000", window)?;
        let ok = goals_per_region >= 1;
        CurriculumError::require(ok, "goals_per_region", "at least 1", goals_per_region)?;
        CurriculumError::require((0.0..1.0).contains(&earlier), "earlier", "in [0, 1)", earlier)?;
        CurriculumError::require(fresh > 0.0 && fresh <= 1.0, "fresh", "in (0, 1]", fresh)?;
        let accepted = format!("at most 1 together with `earlier`, which is {earlier}");
        CurriculumError::require(earlier + fresh <= 1.0, "fresh", &accepted, fresh)
    }

    fn build(config: GoidConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        let count = setting.pool.len().div_ceil(config.goals_per_region);
        Ok(Self { regions: Regions::new(&setting.pool, count), pool: Arc::clone(&setting.pool), config })
    }

    fn begin(&self, _setting: &Setting) -> Result<GoidState, CurriculumError> {
        Ok(GoidState {
            history: History::new(self.regions.count(), self.config.window),
            earlier: vec![false; self.regions.count()],
            playing: None,
            curriculum: Distribution::uniform(self.pool.len()),
        })
    }

    fn propose(&self, state: &mut GoidState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        state.curriculum = self.curriculum(state);
        let goal = state.curriculum.draw(lesson.rng);
        let region = self.regions.of(goal);
        state.playing = Some(region);
        // No number of the method's own says how much it wants a goal.
        Ok(Proposal::pool(goal).scored(state.history.rate(region).map(learnability)))
    }

    fn observe(&self, state: &mut GoidState, episode: &Episode) -> Result<(), CurriculumError> {
        let region = self.regions.told_of(&self.pool, &episode.goal, state.playing.take());
        state.history.push(region, episode.success);
        state.earlier[region] |= self.is_good(&state.history, region);
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a GoidState) -> TeacherSummary<'a> {
        let good = self.goals(|region| self.is_good(&state.history, region)).len();
        let mut summary = state.curriculum.summary();
        summary.statistics.push(("intermediate_goals", good as f64));
        summary.statistics.push(("earlier_goals", self.goals(|region| state.earlier[region]).len() as f64));
        summary
    }

    /// A goal has the success rate of its region; one of a region without an episode is not judged.
    fn judge(&self, state: &GoidState, _student: &dyn Critic) -> Judgement {
        let rates = (0..self.pool.len()).map(|goal| state.history.rate(self.regions.of(goal)));
        let success: Vec<Option<f64>> = rates.collect();
        let scores = success.iter().map(|rate| rate.map(learnability)).collect();
        Judgement::of_some(success, scores)
    }

    fn check_state(&self, state: &GoidState) -> Result<(), CurriculumError> {
        snapshot::require_goals(state.curriculum.probabilities().len(), self.pool.len())?;
        let count = self.regions.count();
        state.history.check(count, self.config.window)?;
        if state.earlier.len() != count || state.playing.is_some_and(|region| region >= count) {
            return Err(snapshot::refuse(format!("it is of other regions than the {count} of this pool")));
        }
        Ok(())
    }
}
