//! Probe rollouts: episodes that the teacher asks for, played between cycles.
//!
//! They have an instance of the environment and random streams of their own, and the student learns nothing
//! from them: training starts and noise stay paired with those of other curricula.

use agents::{Agent, Mode};
use curricula::{RolloutPolicy, RolloutRequest, Rollouts};
use envs::GoalEnv;
use envs::rng::{Purpose, Rng};
use serde::{Deserialize, Serialize};

use super::error::RunError;
use crate::config::streams::StreamSeeds;

/// What the teacher has asked for, how far it is played, and what all of it took.
pub(super) struct Probing {
    env: Box<dyn GoalEnv>,
    /// Seed of the run, and what its streams make of it.
    seeds: (u64, StreamSeeds),
    state: ProbingState,
}

/// What a checkpoint keeps of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct ProbingState {
    pending: Option<Pending>,
    /// Steps of all episodes so far.
    pub(super) steps: u64,
    /// Those of them that were not charged to the budget.
    pub(super) uncharged: u64,
}

impl ProbingState {
    /// Steps that were charged to the budget.
    pub(super) fn charged(&self) -> u64 {
        self.steps - self.uncharged
    }
}

/// A request of which some episodes are still to be played, goal by goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Pending {
    request: RolloutRequest,
    played: usize,
    /// Per goal.
    successes: Vec<usize>,
}

/// What [`Probing::play`] did.
pub(super) struct Played {
    /// Steps to charge to the budget.
    pub(super) charged: u64,
    /// All that was asked for, once it is complete.
    pub(super) complete: Option<Rollouts>,
}

impl Probing {
    /// Nothing asked for yet, in the run with seed `run`.
    pub(super) fn new(env: Box<dyn GoalEnv>, run: u64, seeds: StreamSeeds) -> Self {
        Self { env, seeds: (run, seeds), state: ProbingState::default() }
    }

    pub(super) fn state(&self) -> &ProbingState {
        &self.state
    }

    pub(super) fn resume(&mut self, state: ProbingState) {
        self.state = state;
    }

    pub(super) fn is_pending(&self) -> bool {
        self.state.pending.is_some()
    }

    /// Takes up a request.
    pub(super) fn ask(&mut self, request: RolloutRequest) {
        let successes = vec![0; request.goals.len()];
        self.state.pending = Some(Pending { request, played: 0, successes });
    }

    /// Plays the next `most` episodes of the request, or as many as are left.
    ///
    /// # Errors
    /// [`RunError`] if physics or student break down, or a goal is none of the task's.
    ///
    /// # Panics
    /// If nothing is pending.
    pub(super) fn play(&mut self, agent: &mut dyn Agent, most: usize) -> Result<Played, RunError> {
        let horizon = self.env.spec().horizon as u64;
        let mut pending = self.state.pending.take().expect("a request");
        let all = pending.request.all_episodes();
        let mut charged = 0;
        for index in pending.played..all.min(pending.played + most) {
            let (run, seeds) = &self.seeds;
            let mut rng = seeds.stream(*run, Purpose::Rollout(self.state.steps / horizon));
            let goal = index / pending.request.episodes;
            let wanted = pending.request.goals.row(goal);
            let success = episode(&mut *self.env, agent, wanted, pending.request.policy, &mut rng)?;
            pending.successes[goal] += usize::from(success);
            pending.played += 1;
            self.state.steps += horizon;
            *if pending.request.charge { &mut charged } else { &mut self.state.uncharged } += horizon;
        }
        if pending.played < all {
            self.state.pending = Some(pending);
            return Ok(Played { charged, complete: None });
        }
        let Pending { request: RolloutRequest { goals, episodes, .. }, successes, .. } = pending;
        Ok(Played { charged, complete: Some(Rollouts { goals, episodes, successes }) })
    }
}

/// Plays one episode towards `goal`, and tells whether it was successful at its last step.
fn episode(
    env: &mut dyn GoalEnv,
    agent: &mut dyn Agent,
    goal: &[f64],
    policy: RolloutPolicy,
    rng: &mut Rng,
) -> Result<bool, RunError> {
    env.reset(rng)?;
    env.set_goal(goal)?;
    agent.begin_episode();
    let mut action = vec![0.0; env.spec().action];
    for _ in 0..env.spec().horizon {
        let mode = match policy {
            RolloutPolicy::Greedy => Mode::Greedy,
            RolloutPolicy::Noisy => Mode::Explore(rng),
        };
        agent.act(env.observation(), env.goal(), mode, &mut action)?;
        env.step(&action)?;
    }
    Ok(env.success(&env.observation().achieved, env.goal()))
}
