//! Frontier truth: the success that the student really has at every goal of the pool.
//!
//! The episodes have instances of the environment and random streams of their own. Nobody learns from them,
//! and neither budget nor teacher hears of them.

use std::sync::Arc;

use agents::Critic;
use envs::rng::Rng;
use envs::{EnvError, GoalEnv, Goals};
use reports::schema::Frontier;

use super::error::RunError;
use super::evaluate::{LOCKSTEP, play};
use crate::config::frontier::FrontierOptions;

/// Measures every goal of a pool.
pub(super) struct FrontierTruth {
    envs: Vec<Box<dyn GoalEnv>>,
    goals: Arc<Goals>,
    options: FrontierOptions,
}

impl FrontierTruth {
    /// For the pool `goals`, with instances that `make` makes.
    ///
    /// # Errors
    /// [`EnvError`] if one cannot be made.
    pub(super) fn new(
        goals: Arc<Goals>,
        options: FrontierOptions,
        make: impl Fn() -> Result<Box<dyn GoalEnv>, EnvError>,
    ) -> Result<Self, EnvError> {
        let most = options.episodes.saturating_mul(goals.len() as u64).min(LOCKSTEP);
        let envs = (0..most).map(|_| make()).collect::<Result<_, _>>()?;
        Ok(Self { envs, goals, options })
    }

    /// The goals of the pool in single precision, `[N][G]`.
    pub(super) fn goals(&self) -> Vec<Vec<f32>> {
        self.goals.iter().map(|goal| goal.iter().map(|&x| x as f32).collect()).collect()
    }

    /// Whether the evaluation `eval_index`, which may be the `last` of the run, is one that measures.
    pub(super) fn is_due(&self, eval_index: u64, last: bool) -> bool {
        self.options.is_due(eval_index, last)
    }

    /// Plays the episodes of all goals, goal by goal, as many in lockstep as there are instances; their
    /// starts are drawn from `rng` in this order. Gives the measure without its place in the run, its goals
    /// and the teacher's weights.
    ///
    /// # Errors
    /// [`RunError`] if physics or student break down.
    pub(super) fn measure(&mut self, student: &mut dyn Critic, rng: &mut Rng) -> Result<Frontier, RunError> {
        let episodes = self.options.episodes;
        let mut successes = vec![0; self.goals.len()];
        let all = (self.goals.len() as u64).saturating_mul(episodes);
        let mut played = 0;
        while played < all {
            let group = (all - played).min(self.envs.len() as u64);
            let goals: Vec<usize> =
                (played..played + group).map(|index| (index / episodes) as usize).collect();
            let envs = &mut self.envs[..group as usize];
            for (env, &goal) in envs.iter_mut().zip(&goals) {
                env.reset(rng)?;
                env.set_goal(self.goals.row(goal))?;
            }
            for (goal, success) in goals.into_iter().zip(play(envs, student)?.now) {
                successes[goal] += u64::from(success);
            }
            played += group;
        }
        Ok(Frontier { episodes, successes, ..Frontier::default() })
    }
}
