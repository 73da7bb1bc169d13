//! ALP-GMM: train where results change most, for better or worse (Portelas, Colas, Hofmann and Oudeyer,
//! "Teacher algorithms for curriculum learning of Deep RL in continuously parameterized environments", CoRL
//! 2019, Algorithm 1).
//!
//! The absolute learning progress (ALP) of an episode is the absolute difference of its return and that of
//! the earlier episode whose goal was nearest ([`nearest`]). After every 250 episodes Gaussian mixtures of 2
//! to 10 components are fitted to the goals and ALPs of the last 250 ([`Mixture`]), and the one with the
//! lowest AIC is kept. For an episode one of its Gaussians is drawn in proportion to its mean ALP, and a goal
//! from that; one goal in five, and the first 250, are the environment's own.
//!
//! # Deviations and choices
//! The authors' code is `flowersteam/teachDeepRL` (commit 012eb9a, `teachDRL/teachers/algos/alp_gmm.py`).
//!
//! - The authors' goal space is a box, and a goal drawn outside of it is drawn again (the paper) or clipped
//!   to it (their code). Here goal spaces have walls, tables and rotations, and nothing tells whether a goal
//!   lies within, but the environment draws from it. So 1000 goals (`candidates`) are drawn from the
//!   environment, and one of them is taken in proportion to its density under the Gaussian. Where the
//!   environment draws evenly, as in the mazes, this is a draw from the Gaussian that is repeated until it
//!   falls into the goal space; elsewhere the environment's own density remains as a factor. Goals are always
//!   goals, and those for the start at hand.
//! - Random goals are the environment's own, in place of a draw from the box.
//! - The return is the mean reward of a step, in [−1, 0]: minus the share of steps away from the goal. The
//!   authors' code brings returns to [0, 1] by bounds of each environment.
//! - Goals are brought to deviation 1 before mixtures are fitted ([`Scaling`]), so that metres do not count
//!   less beside an ALP in [0, 1] than the units of the authors' tasks.
//! - As in the authors' code the first goals, up to the sixth, have ALP 0; all goals so far are searched, by
//!   their distance in the environment's units. Of goals equally near the latest counts. Their k-d tree says
//!   nothing on that. Here a scan does, since 20,000 goals take 0.1 ms.
//! - Where every Gaussian's mean ALP is 0 all are as likely, as in the authors' code.
//! - Mixtures are scikit-learn's in the authors' code. Here they are fitted in the same way, with full
//!   covariances and 1e-6 added to every variance, from clusters by k-means that begins from one draw of
//!   centres. A number of components for which the fit fails is left out; if all fail, the last mixture
//!   stays.
//! - ALPs follow after each cycle of the student, when the task's reward is at hand, from the episodes in its
//!   replay buffer. So the second episode of a cycle does not know of the first.

use agents::{Critic, Episode};
use envs::rng::Rng;
use envs::{Goals, Reward, Rows};
use looks::{Dash, Look, Marker};
use rand::Rng as _;
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::fresh::sample_goals;
use crate::method::Method;
use crate::mixture::Mixture;
use crate::replayed::{distance, mean_reward, newest};
use crate::scaling::Scaling;
use crate::snapshot;
use crate::state::PlainState;

/// Up to so many earlier episodes a nearest one tells nothing.
const TOO_FEW: usize = 5;
/// The smallest mixture.
const FEWEST: usize = 2;

/// ALP-GMM's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct AlpGmmConfig {
    /// Episodes between two fits, which are those that a mixture is fitted to; as many at the beginning have
    /// the environment's own goals.
    ///
    /// Unit: episodes. Range: 20 to 10,000. Source: the paper.
    pub fit_every: usize,
    /// The largest number of Gaussians that is tried; the smallest is 2.
    ///
    /// Unit: Gaussians. Range: 2 to 20. Source: the authors' code.
    pub components: usize,
    /// Share of episodes that keep the environment's own goal.
    ///
    /// Unit: none. Range: 0 to 1. Source: the paper.
    pub random: f64,
    /// Goals drawn from the environment, of which one is chosen by its density under the drawn Gaussian.
    ///
    /// Unit: goals. Range: 1 to 100,000. Source: a choice.
    pub candidates: usize,
}

impl Default for AlpGmmConfig {
    fn default() -> Self {
        Self { fit_every: 250, components: 10, random: 0.2, candidates: 1000 }
    }
}

/// The one of `goals`, shape `[n, G]`, that is nearest to `goal`, shape `[G]`; the last of several.
///
/// ```
/// use curricula::methods::alp_gmm::nearest;
///
/// let mut goals = envs::Goals::new(1);
/// [0.0, 5.0, 2.0, 5.0].iter().for_each(|x| goals.push(&[*x]));
/// assert_eq!(nearest(&goals, &[4.0]), Some(3));
/// ```
pub fn nearest(goals: &Goals, goal: &[f64]) -> Option<usize> {
    let mut best = None;
    let mut least = f64::INFINITY;
    for (index, other) in goals.iter().enumerate() {
        let apart = distance(other, goal);
        if apart <= least {
            (best, least) = (Some(index), apart);
        }
    }
    best
}

/// The ALP-GMM teacher.
pub struct AlpGmm {
    config: AlpGmmConfig,
    /// G.
    width: usize,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct AlpGmmState {
    /// Goals of all judged episodes, shape `[n, G]`, and their returns, shape `[n]`.
    goals: Goals,
    returns: Vec<f64>,
    /// ALPs of the last episodes, at most as many as a mixture is fitted to.
    progress: Vec<f64>,
    /// Finished episodes that are not judged yet.
    unjudged: usize,
    fitted: Option<Fitted>,
}

/// The mixture in use.
#[derive(Serialize, Deserialize)]
struct Fitted {
    /// The scale of the goals in it.
    scaling: Scaling,
    /// Over goal and ALP.
    mixture: Mixture,
    /// How likely each of its Gaussians is.
    choice: Distribution,
}

impl PlainState for AlpGmmState {
    const VERSION: u32 = 1;
}

impl AlpGmmState {
    /// Takes in an episode's goal and return, and its ALP.
    fn judge(&mut self, goal: &[f64], result: f64, most: usize) {
        let earlier = if self.goals.len() > TOO_FEW { nearest(&self.goals, goal) } else { None };
        self.progress.push(earlier.map_or(0.0, |earlier| (result - self.returns[earlier]).abs()));
        if self.progress.len() > most {
            self.progress.remove(0);
        }
        self.goals.push(goal);
        self.returns.push(result);
    }

    /// Fits mixtures to the last episodes and keeps the best one.
    fn fit(&mut self, most: usize, rng: &mut Rng) -> Result<(), CurriculumError> {
        let first = self.goals.len() - self.progress.len();
        let mut goals = Goals::with_capacity(self.goals.width(), self.progress.len());
        self.goals.iter().skip(first).for_each(|goal| goals.push(goal));
        let scaling = Scaling::of(&goals);
        let mut points = Rows::with_capacity(goals.width() + 1, goals.len());
        for (goal, alp) in goals.iter().zip(&self.progress) {
            let mut point = scaling.row(goal);
            point.push(*alp);
            points.push(&point);
        }
        let fits = (FEWEST..=most).filter_map(|k| Mixture::fit(&points, k, rng));
        let judged = fits.map(|(mixture, likelihood)| (mixture.aic(likelihood), mixture));
        if let Some((_, mixture)) = judged.min_by(|(a, _), (b, _)| a.total_cmp(b)) {
            // A mean of absolute values can fall below 0 by rounding alone.
            let alps: Vec<f64> = mixture.components.iter().map(|c| c.mean[goals.width()].max(0.0)).collect();
            let choice = Distribution::proportional(&alps, 0.0, "absolute learning progress")?;
            self.fitted = Some(Fitted { scaling, mixture, choice });
        }
        Ok(())
    }
}

impl Fitted {
    /// A goal near one of the Gaussians, of `n` that the environment draws, with the Gaussian's mean ALP.
    fn propose(&self, n: usize, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let gaussian = &self.mixture.components[self.choice.draw(lesson.rng)];
        let candidates = sample_goals(lesson.goals, self.scaling.width(), n, lesson.rng);
        let density = |goal| gaussian.log_at(&self.scaling.row(goal));
        let densities: Vec<f64> = candidates.iter().map(density).collect();
        // In proportion to densities, of which the logarithms are at hand.
        let drawn = Distribution::softmax(&densities, 1.0, "log-density")?.draw(lesson.rng);
        let alp = gaussian.mean[self.scaling.width()];
        Ok(Proposal::other(candidates.row(drawn).to_vec()).scored(alp))
    }
}

impl Method for AlpGmm {
    type Config = AlpGmmConfig;
    type State = AlpGmmState;
    const ID: &'static str = "alp-gmm";
    const TITLE: &'static str = "ALP-GMM";
    const LOOK: Option<Look> = Some(Look::new((51, 34, 136), Dash::Solid, Marker::Wedge));
    const SOURCE: &'static str = "Portelas et al., Teacher Algorithms for Curriculum Learning of Deep RL in \
                                  Continuously Parameterized Environments, CoRL 2019";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn schema() -> Option<Schema> {
        Some(schema_of::<AlpGmmConfig>())
    }

    fn check(config: &AlpGmmConfig) -> Result<(), CurriculumError> {
        let AlpGmmConfig { fit_every, components, random, candidates } = *config;
        CurriculumError::require(
            (20..=10_000).contains(&fit_every),
            "fit_every",
            "in 20..=10000",
            fit_every,
        )?;
        CurriculumError::require((2..=20).contains(&components), "components", "in 2..=20", components)?;
        CurriculumError::require((0.0..=1.0).contains(&random), "random", "in [0, 1]", random)?;
        let ok = (1..=100_000).contains(&candidates);
        CurriculumError::require(ok, "candidates", "in 1..=100000", candidates)
    }

    fn build(config: AlpGmmConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { config, width: setting.spec.goal })
    }

    fn begin(&self, _setting: &Setting) -> Result<AlpGmmState, CurriculumError> {
        let goals = Goals::new(self.width);
        Ok(AlpGmmState { goals, returns: Vec::new(), progress: Vec::new(), unjudged: 0, fitted: None })
    }

    fn propose(&self, state: &mut AlpGmmState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        match &state.fitted {
            Some(fitted) if lesson.rng.random::<f64>() >= self.config.random => {
                fitted.propose(self.config.candidates, lesson)
            }
            _ => Ok(Proposal::native()),
        }
    }

    fn observe(&self, state: &mut AlpGmmState, _episode: &Episode) -> Result<(), CurriculumError> {
        state.unjudged += 1;
        Ok(())
    }

    fn learn(
        &self,
        state: &mut AlpGmmState,
        student: &mut dyn Critic,
        reward: &dyn Reward,
        rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        let AlpGmmConfig { fit_every, components, .. } = self.config;
        for episode in newest(student, std::mem::take(&mut state.unjudged)) {
            state.judge(&episode.goal, mean_reward(&episode, reward), fit_every);
            if state.goals.len().is_multiple_of(fit_every) {
                state.fit(components, rng)?;
            }
        }
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a AlpGmmState) -> TeacherSummary<'a> {
        let components = state.fitted.as_ref().map_or(0, |fitted| fitted.mixture.components.len());
        let mean = state.progress.iter().sum::<f64>() / state.progress.len() as f64;
        let statistics = vec![("mixture_components", components as f64), ("alp_mean", mean)];
        TeacherSummary { weights: None, statistics }
    }

    fn check_state(&self, state: &AlpGmmState) -> Result<(), CurriculumError> {
        let AlpGmmState { goals, returns, progress, fitted, .. } = state;
        let known = goals.width() == self.width
            && goals.len() == returns.len()
            && progress.len() == goals.len().min(self.config.fit_every);
        let fits = |fitted: &Fitted| {
            let Fitted { scaling, mixture, choice } = fitted;
            scaling.width() == self.width
                && mixture.fits(self.width + 1)
                && choice.probabilities().len() == mixture.components.len()
        };
        if known && fitted.as_ref().is_none_or(fits) {
            Ok(())
        } else {
            Err(snapshot::refuse("its goals, returns and mixture do not belong together"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> AlpGmmState {
        let goals = Goals::new(1);
        AlpGmmState { goals, returns: Vec::new(), progress: Vec::new(), unjudged: 0, fitted: None }
    }

    #[test]
    fn hand_worked_progress() {
        let mut state = state();
        for (goal, result) in [(0.0, -1.0), (1.0, -1.0), (2.0, -0.8), (3.0, -1.0), (4.0, -1.0), (2.1, -0.5)] {
            state.judge(&[goal], result, 8);
        }
        assert_eq!(state.progress, [0.0; 6], "five earlier goals are too few");
        // Nearest: 2.1 with -0.5; 2.1 again, now the later one with -0.9; 3.
        for (goal, result) in [(2.2, -0.75), (2.2, -0.25), (3.3, -0.25)] {
            state.judge(&[goal], result, 8);
        }
        assert_eq!(state.progress, [0.0, 0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 0.75], "the oldest is forgotten");
        assert_eq!(state.goals.len(), 9, "but its goal and return are not");
    }

    #[test]
    fn nobody_is_nearest_among_none() {
        assert_eq!(nearest(&Goals::new(1), &[0.0]), None);
    }
}
