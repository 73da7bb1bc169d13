//! MEGA: ask for what has been achieved least often (Pitis, Chan, Zhao, Stadie and Ba, "Maximum Entropy Gain
//! Exploration for Long Horizon Multi-goal Reinforcement Learning", ICML 2020).
//!
//! 100 goals that the student has achieved are drawn from its replay buffer. Those whose value from the start
//! at hand is below a cutoff are left out, for the student may have been there by chance only. Of the others
//! the one is asked for where the density of achieved goals is lowest
//! ([`KernelDensity`](crate::KernelDensity)). The cutoff falls by 1 when goals are mostly reached and rises
//! by 1 when they mostly are not ([`next_cutoff`]).
//!
//! # Deviations and choices
//! The authors' code is `spitis/mrl` (commit 249d652, `mrl/modules/curiosity.py` and
//! `mrl/modules/density.py`, with the defaults of `experiments/mega/train_mega.py`).
//!
//! - Goals are proposed where episodes begin. The authors' code also changes goals within an episode (it
//!   overshoots a goal that was reached) and explores on from a goal reached (Go-Explore); neither is here.
//! - The cutoff moves as in the authors' code: it begins at −3; after ten episodes it falls if 7 of them were
//!   successes and rises if at most 3 were, and the count begins anew; it never rises above −3, nor falls
//!   below the lowest value seen among candidates or below the return of an episode that comes to its goal
//!   after 80 % of its steps ([`least_cutoff`]).
//! - An episode is a success if its goal was reached after any of its steps. The authors' code leaves out the
//!   last one.
//! - As in the authors' code the goal of highest value is asked for where no candidate passes the cutoff.
//! - The density is that of 10,000 goals drawn from the replay buffer with replacement, brought to deviation
//!   1 ([`Scaling`](crate::Scaling)), with Gaussian kernels of bandwidth 0.1. It is made anew for every
//!   episode; in the authors' code with every step of optimisation.
//! - The value is the student's own Q at the greedy action from the start at hand.
//! - Before there is an episode in the replay buffer, the environment's own goal is kept.
//! - Achieved goals are taken as they are. The environments accept any finite goal, and hindsight trains on
//!   the same ones. In the mazes achieved goals are places outside of walls. In the Fetch and Hand tasks they
//!   can lie outside of what the environment itself asks for: a gripper beyond the box of goals, a block on
//!   the floor or not at the height of the table, a rotation about other axes. Their rotations are unit
//!   quaternions but for the rounding of the replay buffer to single precision.

use std::collections::VecDeque;

use agents::{Critic, Episode, Network};
use envs::rng::Rng;
use envs::{Goals, Reward};
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::achieved::Achieved;
use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, Statistics, TeacherSummary};
use crate::error::CurriculumError;
use crate::method::Method;
use crate::probe::{measure, single};
use crate::replayed::{newest, reached};
use crate::snapshot;
use crate::state::PlainState;

/// Share of an episode's steps after which the hardest goal that is still asked for is reached.
const LATEST: f64 = 0.8;
/// The largest discount factor that [`least_cutoff`] reckons with.
const LARGEST_GAMMA: f64 = 0.99;

/// MEGA's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct MegaConfig {
    /// Achieved goals of which one is chosen.
    ///
    /// Unit: goals. Range: 1 to 10,000. Source: the authors' code.
    pub candidates: usize,
    /// Achieved goals that the density is made of.
    ///
    /// Unit: goals. Range: 1 to 100,000. Source: the authors' code.
    pub samples: usize,
    /// Standard deviation of a kernel, where the goals' own is 1.
    ///
    /// Unit: none. Range: 0.001 to 1000. Source: the paper.
    pub bandwidth: f64,
    /// The first cutoff, which is also the highest: the value that a goal must have.
    ///
    /// Unit: return. Range: -1000 to 0. Source: the authors' code.
    pub cutoff: f64,
    /// Share of successes at which the cutoff falls.
    ///
    /// Unit: none. Range: above 0 to 1. Source: the authors' code.
    pub easy: f64,
    /// Share of successes at which the cutoff rises; below `easy`.
    ///
    /// Unit: none. Range: 0 to below 1. Source: the authors' code.
    pub hard: f64,
    /// Episodes that successes are counted over.
    ///
    /// Unit: episodes. Range: 1 to 10,000. Source: the authors' code.
    pub episodes: usize,
}

impl Default for MegaConfig {
    fn default() -> Self {
        Self {
            candidates: 100,
            samples: 10_000,
            bandwidth: 0.1,
            cutoff: -3.0,
            easy: 0.7,
            hard: 0.3,
            episodes: 10,
        }
    }
}

impl MegaConfig {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`CurriculumError::Config`], naming the field.
    pub fn check(&self) -> Result<(), CurriculumError> {
        let Self { candidates, samples, bandwidth, cutoff, easy, hard, episodes } = *self;
        let ok = (1..=10_000).contains(&candidates);
        CurriculumError::require(ok, "candidates", "in 1..=10000", candidates)?;
        CurriculumError::require((1..=100_000).contains(&samples), "samples", "in 1..=100000", samples)?;
        let ok = (0.001..=1000.0).contains(&bandwidth);
        CurriculumError::require(ok, "bandwidth", "in [0.001, 1000]", bandwidth)?;
        CurriculumError::require((-1000.0..=0.0).contains(&cutoff), "cutoff", "in [-1000, 0]", cutoff)?;
        CurriculumError::require(easy > 0.0 && easy <= 1.0, "easy", "in (0, 1]", easy)?;
        let ok = (0.0..1.0).contains(&hard) && hard < easy;
        CurriculumError::require(ok, "hard", "in [0, 1) and below `easy`", hard)?;
        CurriculumError::require((1..=10_000).contains(&episodes), "episodes", "in 1..=10000", episodes)
    }
}

/// The lowest cutoff there is for episodes of `horizon` steps and values down to `lowest` = −1/(1−γ): the
/// return of one that is at its goal after 80 % of its steps, −(1 − γ^(0.8 H)) / (1 − γ). A γ above 0.99
/// counts as 0.99.
///
/// ```
/// use curricula::methods::mega::least_cutoff;
///
/// // γ = 0.5 and 4 steps without reward: −(1 + 0.5 + 0.25 + 0.125).
/// assert!((least_cutoff(-2.0, 5) + 1.875).abs() < 1e-12);
/// ```
pub fn least_cutoff(lowest: f64, horizon: usize) -> f64 {
    let gamma = (1.0 + 1.0 / lowest).min(LARGEST_GAMMA);
    -(1.0 - gamma.powf(LATEST * horizon as f64)) / (1.0 - gamma)
}

/// The cutoff after episodes of which the share `rate` succeeded; `least` and `first` are its bounds.
///
/// ```
/// use curricula::methods::mega::{MegaConfig, next_cutoff};
///
/// let next = |cutoff, rate| next_cutoff(&MegaConfig::default(), cutoff, rate, -6.0);
/// assert_eq!([next(-4.0, 0.7), next(-4.0, 0.5), next(-4.0, 0.3)], [-5.0, -4.0, -3.0]);
/// ```
pub fn next_cutoff(config: &MegaConfig, cutoff: f64, rate: f64, least: f64) -> f64 {
    if rate >= config.easy {
        (cutoff - 1.0).max(least)
    } else if rate <= config.hard {
        (cutoff + 1.0).min(config.cutoff)
    } else {
        cutoff
    }
}

/// Everything that changes while MEGA teaches.
#[derive(Serialize, Deserialize)]
pub struct MegaState {
    cutoff: f64,
    /// The lowest value seen among candidates, at most the first cutoff.
    lowest_seen: f64,
    /// How the last episodes ended.
    recent: VecDeque<bool>,
    /// Finished episodes that are not judged yet.
    unjudged: usize,
    /// Share of candidates that passed the cutoff and log-density of the goal at the last choice; NaN before.
    passed: f64,
    log_density: f64,
}

impl PlainState for MegaState {
    const VERSION: u32 = 1;
}

impl MegaState {
    /// Before the first episode.
    pub(super) fn new(config: &MegaConfig) -> Self {
        Self {
            cutoff: config.cutoff,
            lowest_seen: config.cutoff,
            recent: VecDeque::new(),
            unjudged: 0,
            passed: f64::NAN,
            log_density: f64::NAN,
        }
    }

    /// Lets the cutoff follow the last episodes' successes once there are enough, given the values of some
    /// candidates and the lowest cutoff there is.
    fn follow(&mut self, config: &MegaConfig, values: &[f64], least: f64) {
        if self.recent.len() == config.episodes {
            let lowest = values.iter().copied().fold(self.lowest_seen, f64::min);
            self.lowest_seen = lowest.max(least);
            let successes = self.recent.iter().filter(|success| **success).count();
            let rate = successes as f64 / config.episodes as f64;
            if rate >= config.easy || rate <= config.hard {
                self.recent.clear();
            }
            self.cutoff = next_cutoff(config, self.cutoff, rate, self.lowest_seen);
        }
        self.cutoff = self.cutoff.max(least);
    }

    /// The candidate to ask for, with its log-density among the goals achieved.
    pub(super) fn choose(
        &mut self,
        config: &MegaConfig,
        achieved: &mut Achieved,
        lesson: &mut Lesson<'_>,
    ) -> Result<Proposal, CurriculumError> {
        let student = &mut *lesson.student;
        let candidates = student.replay_achieved(config.candidates, lesson.rng);
        let values = measure(student, &candidates, &single(&lesson.start.state), Network::Online)?;
        let least = least_cutoff(student.lowest_value(), student.spec().horizon);
        self.follow(config, &values, least);
        let (index, passed) = choice(&candidates, &values, self.cutoff, |goal| achieved.log_density(goal));
        let goal = candidates.row(index);
        self.passed = passed as f64 / values.len() as f64;
        self.log_density = achieved.log_density(goal);
        Ok(Proposal::other(goal.to_vec()).scored(-self.log_density))
    }

    /// Hears that an episode is over.
    pub(super) fn observe(&mut self) {
        self.unjudged += 1;
    }

    /// Judges the episodes that are over since the last call.
    pub(super) fn learn(&mut self, config: &MegaConfig, student: &dyn Critic, reward: &dyn Reward) {
        for episode in newest(student, std::mem::take(&mut self.unjudged)) {
            if self.recent.len() == config.episodes {
                self.recent.pop_front();
            }
            self.recent.push_back(reached(&episode, reward));
        }
    }

    /// Its numbers.
    pub(super) fn statistics(&self) -> Statistics<'_> {
        vec![("cutoff", self.cutoff), ("passed_share", self.passed), ("log_density", self.log_density)]
    }

    /// Refuses a loaded state that counts more episodes than `config` does.
    pub(super) fn check(&self, config: &MegaConfig) -> Result<(), CurriculumError> {
        if self.recent.len() <= config.episodes {
            Ok(())
        } else {
            Err(snapshot::refuse(format!("counts the successes of {} episodes", self.recent.len())))
        }
    }
}

/// Of `candidates`, shape `[n, G]`, the least dense one whose value, shape `[n]`, is no lower than `cutoff`,
/// or the one of highest value if all are lower; the first among equals. How many were not lower.
fn choice(
    candidates: &Goals,
    values: &[f64],
    cutoff: f64,
    mut log_density: impl FnMut(&[f64]) -> f64,
) -> (usize, usize) {
    let passed: Vec<usize> = (0..values.len()).filter(|&i| values[i] >= cutoff).collect();
    let densities = passed.iter().map(|&i| (i, log_density(candidates.row(i))));
    let least = densities.min_by(|(_, a), (_, b)| a.total_cmp(b));
    // The last of equal maxima from the back is the first.
    let highest = || (0..values.len()).rev().max_by(|&a, &b| values[a].total_cmp(&values[b]));
    let index = least.map(|(i, _)| i).or_else(highest).expect("a candidate");
    (index, passed.len())
}

/// The MEGA teacher.
pub struct Mega(MegaConfig);

impl Method for Mega {
    type Config = MegaConfig;
    type State = MegaState;
    const ID: &'static str = "mega";
    const TITLE: &'static str = "MEGA";
    const LOOK: Option<Look> = Some(Look::new((136, 34, 85), Dash::Long, Marker::Diamond));
    const SOURCE: &'static str = "Pitis et al., Maximum Entropy Gain Exploration for Long Horizon Multi-goal \
                                  Reinforcement Learning, ICML 2020";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn schema() -> Option<Schema> {
        Some(schema_of::<MegaConfig>())
    }

    fn check(config: &MegaConfig) -> Result<(), CurriculumError> {
        config.check()
    }

    fn build(config: MegaConfig, _setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self(config))
    }

    fn begin(&self, _setting: &Setting) -> Result<MegaState, CurriculumError> {
        Ok(MegaState::new(&self.0))
    }

    fn propose(&self, state: &mut MegaState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        match Achieved::draw(self.0.samples, self.0.bandwidth, lesson) {
            Some(mut achieved) => state.choose(&self.0, &mut achieved, lesson),
            None => Ok(Proposal::native()),
        }
    }

    fn observe(&self, state: &mut MegaState, _episode: &Episode) -> Result<(), CurriculumError> {
        state.observe();
        Ok(())
    }

    fn learn(
        &self,
        state: &mut MegaState,
        student: &mut dyn Critic,
        reward: &dyn Reward,
        _rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        state.learn(&self.0, student, reward);
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a MegaState) -> TeacherSummary<'a> {
        TeacherSummary { weights: None, statistics: state.statistics() }
    }

    fn check_state(&self, state: &MegaState) -> Result<(), CurriculumError> {
        state.check(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_worked_cutoff() {
        let config = MegaConfig::default();
        let next = |cutoff, rate| next_cutoff(&config, cutoff, rate, -5.0);
        assert_eq!([next(-3.0, 0.7), next(-3.0, 1.0), next(-3.0, 0.69)], [-4.0, -4.0, -3.0]);
        assert_eq!([next(-4.0, 0.3), next(-4.0, 0.31)], [-3.0, -4.0]);
        assert_eq!([next(-4.5, 1.0), next(-3.5, 0.0)], [-5.0, -3.0], "its bounds");
        // γ = 0.98 and 40 of 50 steps: 0.98^40 = 0.4457, and (1 − 0.4457)/0.02 = 27.715.
        assert!((least_cutoff(-50.0, 50) + 27.715).abs() < 1e-3);
        // γ = 0.999 counts as 0.99: 0.99^40 = 0.66897.
        assert!((least_cutoff(-1000.0, 50) + 33.103).abs() < 1e-3);
    }

    #[test]
    fn the_cutoff_follows_ten_episodes_and_counts_anew() {
        let config = MegaConfig::default();
        let mut state = MegaState::new(&config);
        let after = |state: &mut MegaState, successes: [bool; 10], values: &[f64]| {
            state.recent.extend(successes);
            state.follow(&config, values, -20.0);
            (state.cutoff, state.recent.len())
        };
        assert_eq!(after(&mut state, [true; 10], &[-1.0, -2.0]), (-3.0, 0), "nothing lower was ever seen");
        assert_eq!(after(&mut state, [true; 10], &[-1.0, -9.0]), (-4.0, 0));
        assert_eq!(after(&mut state, [true; 10], &[-1.0]), (-5.0, 0), "what was seen is remembered");
        let half = std::array::from_fn(|i| i < 5);
        assert_eq!(after(&mut state, half, &[-1.0]), (-5.0, 10), "neither easy nor hard: they stay");
        state.recent.clear();
        assert_eq!(after(&mut state, [false; 10], &[-1.0]), (-4.0, 0));
    }

    #[test]
    fn hand_worked_choice() {
        let mut goals = Goals::new(1);
        [0.0, 1.0, 2.0, 3.0].iter().for_each(|x| goals.push(&[*x]));
        // Density falls with the goal's number.
        let choose = |values: &[f64]| choice(&goals, values, -3.0, |goal| -goal[0]);
        assert_eq!(choose(&[-1.0, -3.0, -2.0, -3.1]), (2, 3), "the least dense of those that pass");
        assert_eq!(choose(&[-5.0, -4.0, -4.0, -6.0]), (1, 0), "none passes: the first of highest value");
    }
}
