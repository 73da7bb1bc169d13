//! HGG: ask for what was achieved on the way to where the environment's goals lie (Ren, Dong, Zhou, Liu and
//! Peng, "Exploration via Hindsight Goal Generation", NeurIPS 2019, Algorithm 1).
//!
//! 50 goals of the environment are matched with 50 of the last 1000 episodes so that the costs of all pairs
//! are least in sum ([`assignment`]). A pair of the goal g and an episode that began in s0 and achieved ag_0,
//! ag_1, … costs
//!
//! min_t \[ ‖ag_t − g‖ − V(s0, ag_t) (1 − γ) D / L \] + c ‖ag_0 − m‖,
//!
//! with m what is achieved at the start at hand, and D the diameter of the goal space ([`price`]). The ag_t
//! of the minimum is the hindsight goal. The next 50 episodes ask for one each, and then all is matched anew.
//!
//! # Deviations and choices
//! The authors' code is `Stilwell-Git/Hindsight-Goal-Generation` (commit acd80b4, `learner/hgg.py`; its
//! defaults are in `common.py`).
//!
//! - In the authors' code 50 instances of the environment are reset, and their starts and goals are matched.
//!   A teacher knows the start of the coming episode alone: the 50 goals are drawn for that start, and m is
//!   that of this start for all of them. Where starts are random, the later ones of the 50 episodes begin
//!   elsewhere.
//! - Episodes are those of the student's replay buffer, the newest first. As in the authors' code, those in
//!   which what is achieved at the end lies within 0.01 of what was achieved at the start are passed over; as
//!   there, too, fewer than 1000 take turns until there are 1000, so that one can be matched several times.
//! - As in the authors' code, goals are the environment's own for the next 50 episodes where there is no such
//!   episode at all.
//! - As in the authors' code V is the student's own Q at the greedy action, clipped to \[−1/(1−γ), 0\].
//! - D is the largest distance of a drawn goal from what is achieved at the start, over 1000 draws whenever
//!   goals are matched; in the authors' code over 1000 resets at the beginning.
//! - For Fetch the authors' code adds noise of the size of the distance threshold to hindsight goals, for the
//!   Hand none. Here there is none: a hindsight goal is one that was achieved.
//! - Pairs are found by the algorithm of Kuhn and Munkres; in the authors' code by a flow of least cost. Both
//!   find a least sum.
//! - The authors' student draws episodes from its buffer by their energy. Here it is the same for all
//!   methods.
//! - Distances are Euclidean in the goal's own units, as in the authors' code: for HandManipulate* metres and
//!   quaternions together.
//! - Which goals are achieved ones, and may lie where the environment would not ask for them, see
//!   [`mega`](super::mega).

use std::collections::VecDeque;

use agents::{Network, Trajectory};
use envs::{Goals, Rows};
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::assignment::assignment;
use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::error::CurriculumError;
use crate::fresh::sample_goals;
use crate::method::Method;
use crate::probe::{measure, single};
use crate::replayed::distance;
use crate::snapshot;
use crate::state::PlainState;

/// Goals that the diameter of the goal space is estimated from.
const DIAMETER_DRAWS: usize = 1000;

/// HGG's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct HggConfig {
    /// Goals of the environment that are matched at a time, and episodes until the next time.
    ///
    /// Unit: goals. Range: 1 to 1000. Source: the authors' code.
    pub goals: usize,
    /// The newest episodes that they are matched with; at least as many as goals.
    ///
    /// Unit: episodes. Range: 1 to 10,000. Source: the authors' code.
    pub trajectories: usize,
    /// c, weight of the distance between the starts.
    ///
    /// Unit: none. Range: 0 to 1,000,000. Source: the paper.
    pub c: f64,
    /// L, how fast values fall with distance.
    ///
    /// Unit: none. Range: 0.001 to 1,000,000. Source: the paper.
    pub lipschitz: f64,
    /// Distance between the first and the last achieved goal below which an episode is passed over.
    ///
    /// Unit: that of goals. Range: at least 0. Source: the authors' code.
    pub least_motion: f64,
}

impl Default for HggConfig {
    fn default() -> Self {
        Self { goals: 50, trajectories: 1000, c: 3.0, lipschitz: 5.0, least_motion: 0.01 }
    }
}

/// An episode's achieved goals with what each of them costs besides its distance, and what the start costs.
#[derive(Clone, Debug)]
struct Offer {
    /// Shape `[H + 1, G]`.
    achieved: Rows,
    /// −V(s0, ag_t) (1 − γ) D / L, shape `[H + 1]`.
    effort: Vec<f64>,
    /// c ‖ag_0 − m‖.
    detour: f64,
}

/// The step t whose achieved goal is the best stand-in for `goal`, shape `[G]`, and its cost
/// ‖ag_t − g‖ + effort_t: the first among equals. `achieved` has shape `[H + 1, G]`, `effort` `[H + 1]`.
///
/// ```
/// use curricula::methods::hgg::price;
///
/// let mut achieved = envs::Rows::new(1);
/// [0.0, 1.0, 2.0].iter().for_each(|x| achieved.push(&[*x]));
/// // 3 + 0, 2 + 0.5 and 1 + 2.
/// assert_eq!(price(&achieved, &[0.0, 0.5, 2.0], &[3.0]), (1, 2.5));
/// ```
///
/// # Panics
/// If nothing was achieved.
pub fn price(achieved: &Rows, effort: &[f64], goal: &[f64]) -> (usize, f64) {
    let costs = achieved.iter().zip(effort).map(|(achieved, effort)| distance(achieved, goal) + effort);
    costs.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b)).expect("a trajectory has a start")
}

/// Distance of the farthest of `goals`, shape `[n, G]`, from `start`, shape `[G]`; 0 of none.
///
/// ```
/// use curricula::methods::hgg::farthest;
///
/// let mut goals = envs::Goals::new(2);
/// [[1.0, 1.0], [4.0, 5.0], [1.0, -2.0]].iter().for_each(|goal| goals.push(goal));
/// // 0, √(3² + 4²) and 3.
/// assert_eq!(farthest(&[1.0, 1.0], &goals), 5.0);
/// ```
pub fn farthest(start: &[f64], goals: &Goals) -> f64 {
    goals.iter().map(|goal| distance(start, goal)).fold(0.0, f64::max)
}

/// The HGG teacher.
pub struct Hgg {
    config: HggConfig,
    /// G.
    width: usize,
}

/// A hindsight goal and what its pair costs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Matched {
    goal: Vec<f64>,
    cost: f64,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct HggState {
    /// The goals of the coming episodes; none stands for the environment's own.
    coming: VecDeque<Option<Matched>>,
    /// D.
    diameter: f64,
    /// Episodes that were matched with the last time, and the mean cost of a pair; NaN before.
    trajectories: f64,
    mean_cost: f64,
}

impl PlainState for HggState {
    const VERSION: u32 = 1;
}

impl Hgg {
    /// Goals for the next episodes.
    fn renew(&self, state: &mut HggState, lesson: &mut Lesson<'_>) -> Result<(), CurriculumError> {
        let drawn = DIAMETER_DRAWS.max(self.config.goals);
        let drawn = sample_goals(lesson.goals, self.width, drawn, lesson.rng);
        state.diameter = farthest(&lesson.start.achieved, &drawn).max(state.diameter);
        let wanted: Vec<&[f64]> = drawn.iter().take(self.config.goals).collect();
        let offers = self.offers(state.diameter, lesson)?;
        state.trajectories = offers.len() as f64;
        if offers.is_empty() {
            state.coming = vec![None; self.config.goals].into();
            return Ok(());
        }
        let mut costs = Rows::with_capacity(self.config.trajectories, wanted.len());
        for goal in &wanted {
            let prices = offers.iter().map(|o| price(&o.achieved, &o.effort, goal).1 + o.detour);
            let prices: Vec<f64> = prices.collect();
            // Fewer episodes than asked for take turns.
            let turns: Vec<f64> = prices.iter().copied().cycle().take(self.config.trajectories).collect();
            costs.push(&turns);
        }
        let pairs = assignment(&costs);
        let matched = pairs.iter().enumerate().map(|(row, &column)| {
            let Offer { achieved, effort, .. } = &offers[column % offers.len()];
            let (step, _) = price(achieved, effort, wanted[row]);
            Matched { goal: achieved.row(step).to_vec(), cost: costs.row(row)[column] }
        });
        let matched: Vec<Matched> = matched.collect();
        state.mean_cost = matched.iter().map(|pair| pair.cost).sum::<f64>() / matched.len() as f64;
        state.coming = matched.into_iter().map(Some).collect();
        Ok(())
    }

    /// The newest episodes in which something moved.
    fn offers(&self, diameter: f64, lesson: &mut Lesson<'_>) -> Result<Vec<Offer>, CurriculumError> {
        let HggConfig { trajectories, c, lipschitz, least_motion, .. } = self.config;
        let Lesson { student, start, .. } = lesson;
        let lowest = student.lowest_value();
        let mut offers = Vec::new();
        for age in 0..student.replay_episodes() {
            if offers.len() == trajectories {
                break;
            }
            let Some(Trajectory { states, achieved, .. }) = student.replay_trajectory(age) else { break };
            let first = achieved.row(0);
            if distance(first, achieved.row(achieved.len() - 1)) < least_motion {
                continue;
            }
            let detour = c * distance(first, &start.achieved);
            let values = measure(&mut **student, &achieved, &single(states.row(0)), Network::Online)?;
            // 1 − γ is −1/lowest.
            let effort = |value: f64| value.clamp(lowest, 0.0) / lowest * diameter / lipschitz;
            offers.push(Offer { effort: values.into_iter().map(effort).collect(), achieved, detour });
        }
        Ok(offers)
    }
}

impl Method for Hgg {
    type Config = HggConfig;
    type State = HggState;
    const ID: &'static str = "hgg";
    const TITLE: &'static str = "HGG";
    const LOOK: Option<Look> = Some(Look::new((0, 100, 110), Dash::DashDot, Marker::Cross));
    const SOURCE: &'static str = "Ren et al., Exploration via Hindsight Goal Generation, NeurIPS 2019";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn schema() -> Option<Schema> {
        Some(schema_of::<HggConfig>())
    }

    fn check(config: &HggConfig) -> Result<(), CurriculumError> {
        let HggConfig { goals, trajectories, c, lipschitz, least_motion } = *config;
        CurriculumError::require((1..=1000).contains(&goals), "goals", "in 1..=1000", goals)?;
        let ok = (goals..=10_000).contains(&trajectories);
        let accepted = "at least `goals` and at most 10000";
        CurriculumError::require(ok, "trajectories", accepted, trajectories)?;
        CurriculumError::require((0.0..=1e6).contains(&c), "c", "in [0, 1000000]", c)?;
        let ok = (0.001..=1e6).contains(&lipschitz);
        CurriculumError::require(ok, "lipschitz", "in [0.001, 1000000]", lipschitz)?;
        let ok = least_motion >= 0.0 && least_motion.is_finite();
        CurriculumError::require(ok, "least_motion", "finite and at least 0", least_motion)
    }

    fn build(config: HggConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { config, width: setting.spec.goal })
    }

    fn begin(&self, _setting: &Setting) -> Result<HggState, CurriculumError> {
        let coming = VecDeque::new();
        Ok(HggState { coming, diameter: 0.0, trajectories: f64::NAN, mean_cost: f64::NAN })
    }

    fn propose(&self, state: &mut HggState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        if state.coming.is_empty() {
            self.renew(state, lesson)?;
        }
        Ok(match state.coming.pop_front().flatten() {
            Some(Matched { goal, cost }) => Proposal::other(goal).scored(-cost),
            None => Proposal::native(),
        })
    }

    fn summary<'a>(&'a self, state: &'a HggState) -> TeacherSummary<'a> {
        let statistics = vec![
            ("trajectories", state.trajectories),
            ("mean_cost", state.mean_cost),
            ("diameter", state.diameter),
        ];
        TeacherSummary { weights: None, statistics }
    }

    fn check_state(&self, state: &HggState) -> Result<(), CurriculumError> {
        let fits = |matched: &Matched| matched.goal.len() == self.width;
        if state.coming.len() < self.config.goals && state.coming.iter().flatten().all(fits) {
            Ok(())
        } else {
            Err(snapshot::refuse("its coming goals are too many, or of another task"))
        }
    }
}
