//! PLR: replay goals whose last episode surprised the critic (Jiang, Grefenstette and Rocktäschel,
//! "Prioritized Level Replay", ICML 2021, arXiv 2010.03934).
//!
//! The score of a goal is the mean size of the temporal-difference errors in its last episode. With some
//! probability an episode's goal is one that has a score, drawn from (1 − ρ) P_score + ρ P_staleness: P_score
//! goes by the score's rank ([`rank_weights`]), P_staleness by the episodes since the goal was last drawn
//! ([`replay_weights`]). Else it is one that has none yet, all alike.
//!
//! # Deviations and choices
//! The authors' code is `facebookresearch/level-replay` (commit ccecf45), `level_replay/level_sampler.py`.
//!
//! - A level is a goal of the pool, which every start may meet.
//! - The authors' best score is the mean absolute difference between λ-returns and the values of their PPO
//!   (`value_l1`). Here it is that of the student's clipped Bellman target and its Q at the action taken:
//!   errors of one step, which is λ = 0. The authors' `one_step_td_error` subtracts the other way round, is
//!   undiscounted and leaves out the last step. `score = "positive"` counts an error only where the
//!   target lies above the value, as the positive value loss of later work does.
//! - Scores are taken once the student has learned from the episode; the authors take the values that it had
//!   while it acted.
//! - An episode that ended in a warm-up gets its score when learning begins. Until a goal has a score it
//!   counts as unseen, as in the authors' code, and may be drawn as such again.
//! - The probability of a replay is the share of the pool that has a score (`proportionate`, the authors'
//!   default), or `replay` (`fixed`). In the authors' code no level is replayed before all have been seen
//!   (`level_replay_rho = 1`), which would be 1000 episodes here; there is no such wait.
//! - β = 0.1 and ρ = 0.1 are those of the authors' README. Staleness counts in proportion, as by their
//!   default.
//! - Ties in rank go to the goal with the lower index, in the authors' code to that with the higher one.
//! - Where no goal with a score is stale, the score alone decides; the authors' probabilities do not sum to 1
//!   there.
//! - Goals of the pool are set at other starts than they were drawn for: for HandManipulate* see
//!   [`her_iid_pool`](super::her_iid_pool).

use std::sync::Arc;

use agents::{Critic, Episode};
use envs::rng::Rng;
use envs::{Goals, Reward};
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::judgement::Judgement;
use crate::method::Method;
use crate::played::told_of;
use crate::snapshot;
use crate::state::PlainState;

/// PLR's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct PlrConfig {
    /// What an episode's temporal-difference errors say of its goal.
    ///
    /// Source: the paper.
    pub score: PlrScore,
    /// β, temperature of the ranks: the smaller, the more the first ones count.
    ///
    /// Unit: none. Range: above 0. Source: the paper.
    pub beta: f64,
    /// ρ, weight of staleness.
    ///
    /// Unit: none. Range: 0 to 1. Source: the paper.
    pub staleness: f64,
    /// How often goals are replayed.
    ///
    /// Source: the authors' code.
    pub schedule: PlrSchedule,
    /// Probability of a replay with `schedule = "fixed"`.
    ///
    /// Unit: none. Range: 0 to 1. Source: the authors' code.
    pub replay: f64,
}

impl Default for PlrConfig {
    fn default() -> Self {
        Self {
            score: PlrScore::Absolute,
            beta: 0.1,
            staleness: 0.1,
            schedule: PlrSchedule::Proportionate,
            replay: 0.5,
        }
    }
}

/// What an episode's temporal-difference errors δ say of its goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlrScore {
    /// The mean of |δ|.
    #[default]
    Absolute,
    /// The mean of max(δ, 0).
    Positive,
}

impl PlrScore {
    /// The score of an episode with these errors; 0 for none.
    ///
    /// ```
    /// use curricula::methods::plr::PlrScore;
    ///
    /// let errors = [0.5, -1.0, 0.0, -0.5];
    /// assert_eq!(PlrScore::Absolute.of(&errors), 0.5);
    /// assert_eq!(PlrScore::Positive.of(&errors), 0.125);
    /// ```
    pub fn of(self, errors: &[f64]) -> f64 {
        let size = |error: &f64| match self {
            Self::Absolute => error.abs(),
            Self::Positive => error.max(0.0),
        };
        errors.iter().map(size).sum::<f64>() / errors.len().max(1) as f64
    }
}

/// How often goals are replayed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlrSchedule {
    /// As often as the share of the pool that has a score.
    #[default]
    Proportionate,
    /// With a fixed probability, as soon as a goal has a score.
    Fixed,
}

/// rank^(−1/β), normalised: the probability of every goal by the rank of its score, 1 for the largest. Of
/// equal scores the first ranks first.
///
/// ```
/// use curricula::methods::plr::rank_weights;
///
/// // Ranks 2, 1 and 3 with β = 1: 1/2, 1 and 1/3, whose sum is 11/6.
/// let expected = [3.0 / 11.0, 6.0 / 11.0, 2.0 / 11.0];
/// let weights = rank_weights(&[0.5, 0.75, 0.25], 1.0);
/// assert!(weights.iter().zip(expected).all(|(w, e)| (w - e).abs() < 1e-15));
/// ```
pub fn rank_weights(scores: &[f64], beta: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..scores.len()).collect();
    order.sort_by(|&a, &b| scores[b].total_cmp(&scores[a]));
    let mut weights = vec![0.0; scores.len()];
    for (place, &goal) in order.iter().enumerate() {
        weights[goal] = ((place + 1) as f64).powf(-1.0 / beta);
    }
    normalise(&mut weights);
    weights
}

/// (1 − ρ) P_score + ρ P_staleness of every goal, with P_staleness in proportion to `stale`, the episodes
/// since the goal was last drawn; P_score alone where all of them are 0.
///
/// ```
/// use curricula::methods::plr::replay_weights;
///
/// // Ranks 1 and 2 with β = 1: 2/3 and 1/3. Staleness 1 and 3: 1/4 and 3/4.
/// let weights = replay_weights(&[0.9, 0.1], &[1, 3], 1.0, 0.5);
/// assert!((weights[0] - 11.0 / 24.0).abs() < 1e-15 && (weights[1] - 13.0 / 24.0).abs() < 1e-15);
/// ```
pub fn replay_weights(scores: &[f64], stale: &[u64], beta: f64, rho: f64) -> Vec<f64> {
    let by_score = rank_weights(scores, beta);
    let mut by_staleness: Vec<f64> = stale.iter().map(|&episodes| episodes as f64).collect();
    if by_staleness.iter().all(|&weight| weight == 0.0) {
        return by_score;
    }
    normalise(&mut by_staleness);
    by_score.iter().zip(&by_staleness).map(|(score, stale)| (1.0 - rho) * score + rho * stale).collect()
}

fn normalise(weights: &mut [f64]) {
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
}

/// The PLR teacher.
pub struct Plr {
    config: PlrConfig,
    pool: Arc<Goals>,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct PlrState {
    /// The score of every goal, shape `[N]`; `None` as long as none of its episodes has one.
    scores: Vec<Option<f64>>,
    /// Episodes so far, and how many there were when each goal was last played, shape `[N]`.
    episodes: u64,
    drawn_at: Vec<u64>,
    /// The goal that was proposed for the coming episode.
    playing: Option<usize>,
    /// The goals of the last episodes, which have no score yet, in order.
    awaiting: Vec<usize>,
    curriculum: Distribution,
}

impl PlainState for PlrState {
    const VERSION: u32 = 1;
}

impl PlrState {
    /// The goals with a score and those without.
    fn seen_and_unseen(&self) -> (Vec<usize>, Vec<usize>) {
        (0..self.scores.len()).partition(|&goal| self.scores[goal].is_some())
    }

    /// The probability of every goal, shape `[N]`.
    fn weights(&self, config: &PlrConfig) -> Vec<f64> {
        let (seen, unseen) = self.seen_and_unseen();
        let replay = match config.schedule {
            _ if unseen.is_empty() => 1.0,
            _ if seen.is_empty() => 0.0,
            PlrSchedule::Proportionate => seen.len() as f64 / self.scores.len() as f64,
            PlrSchedule::Fixed => config.replay,
        };
        let mut weights = vec![0.0; self.scores.len()];
        unseen.iter().for_each(|&goal| weights[goal] = (1.0 - replay) / unseen.len() as f64);
        let scores: Vec<f64> = seen.iter().filter_map(|&goal| self.scores[goal]).collect();
        let stale: Vec<u64> = seen.iter().map(|&goal| self.episodes - self.drawn_at[goal]).collect();
        for (goal, weight) in seen.iter().zip(replay_weights(&scores, &stale, config.beta, config.staleness))
        {
            weights[*goal] = replay * weight;
        }
        weights
    }
}

impl Method for Plr {
    type Config = PlrConfig;
    type State = PlrState;
    const ID: &'static str = "plr";
    const TITLE: &'static str = "PLR";
    const LOOK: Option<Look> = Some(Look::new((170, 40, 200), Dash::Sparse, Marker::Circle));
    const SOURCE: &'static str = "Jiang, Grefenstette and Rocktäschel, Prioritized Level Replay, ICML 2021";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn schema() -> Option<Schema> {
        Some(schema_of::<PlrConfig>())
    }

    fn check(config: &PlrConfig) -> Result<(), CurriculumError> {
        let PlrConfig { beta, staleness, replay, .. } = *config;
        let ok = beta > 0.0 && beta.is_finite();
        CurriculumError::require(ok, "beta", "positive and finite", beta)?;
        CurriculumError::require((0.0..=1.0).contains(&staleness), "staleness", "in [0, 1]", staleness)?;
        CurriculumError::require((0.0..=1.0).contains(&replay), "replay", "in [0, 1]", replay)
    }

    fn build(config: PlrConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { config, pool: Arc::clone(&setting.pool) })
    }

    fn begin(&self, _setting: &Setting) -> Result<PlrState, CurriculumError> {
        Ok(PlrState {
            scores: vec![None; self.pool.len()],
            episodes: 0,
            drawn_at: vec![0; self.pool.len()],
            playing: None,
            awaiting: Vec::new(),
            curriculum: Distribution::uniform(self.pool.len()),
        })
    }

    fn propose(&self, state: &mut PlrState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        state.curriculum = Distribution::proportional(&state.weights(&self.config), 0.0, "replay weight")?;
        let goal = state.curriculum.draw(lesson.rng);
        state.episodes += 1;
        state.playing = Some(goal);
        Ok(Proposal::pool(goal).scored(state.scores[goal]))
    }

    fn observe(&self, state: &mut PlrState, episode: &Episode) -> Result<(), CurriculumError> {
        let goal = told_of(&self.pool, &episode.goal, state.playing.take());
        state.drawn_at[goal] = state.episodes;
        state.awaiting.push(goal);
        Ok(())
    }

    fn learn(
        &self,
        state: &mut PlrState,
        student: &mut dyn Critic,
        reward: &dyn Reward,
        _rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        let awaiting = std::mem::take(&mut state.awaiting);
        for (goal, age) in awaiting.iter().zip((0..awaiting.len()).rev()) {
            // An episode that the student has forgotten meanwhile can have no score.
            if let Some(trajectory) = student.replay_trajectory(age) {
                let errors = student.td_errors(&trajectory, reward)?;
                state.scores[*goal] = Some(self.config.score.of(&errors));
            }
        }
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a PlrState) -> TeacherSummary<'a> {
        let mut summary = state.curriculum.summary();
        let scores: Vec<f64> = state.scores.iter().flatten().copied().collect();
        summary.statistics.push(("seen_goals", scores.len() as f64));
        summary.statistics.push(("td_error_mean", scores.iter().sum::<f64>() / scores.len() as f64));
        summary
    }

    /// A goal that has no score yet is not judged.
    fn judge(&self, state: &PlrState, _student: &dyn Critic) -> Judgement {
        Judgement::of_some(Vec::new(), state.scores.clone())
    }

    fn check_state(&self, state: &PlrState) -> Result<(), CurriculumError> {
        snapshot::require_goals(state.scores.len(), self.pool.len())?;
        snapshot::require_goals(state.drawn_at.len(), self.pool.len())?;
        let goals = || state.awaiting.iter().chain(&state.playing);
        if goals().any(|&goal| goal >= self.pool.len())
            || state.drawn_at.iter().any(|&at| at > state.episodes)
        {
            return Err(snapshot::refuse("episodes that the pool or the run has not had"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_temperature_leaves_little_to_all_but_the_first() {
        // 1, 2^-10 and 3^-10.
        let weights = rank_weights(&[0.1, 0.3, 0.2], 0.1);
        let total = 1.0 + 2f64.powi(-10) + 3f64.powi(-10);
        for (weight, expected) in weights.iter().zip([3f64.powi(-10), 1.0, 2f64.powi(-10)]) {
            assert!((weight - expected / total).abs() < 1e-12, "{weight}");
        }
    }

    #[test]
    fn of_equal_scores_the_first_ranks_first() {
        assert_eq!(rank_weights(&[0.5, 0.5], 1.0), [2.0 / 3.0, 1.0 / 3.0]);
        assert_eq!(rank_weights(&[], 1.0), Vec::<f64>::new());
    }

    #[test]
    fn staleness_alone_and_score_alone() {
        assert_eq!(replay_weights(&[0.1, 0.9], &[3, 1], 1.0, 1.0), [0.75, 0.25]);
        assert_eq!(replay_weights(&[0.1, 0.9], &[3, 1], 1.0, 0.0), rank_weights(&[0.1, 0.9], 1.0));
        assert_eq!(replay_weights(&[0.1], &[0], 1.0, 0.5), [1.0], "nothing is stale");
    }

    #[test]
    fn an_episode_without_steps_scores_nothing() {
        assert_eq!(PlrScore::Absolute.of(&[]), 0.0);
    }
}
