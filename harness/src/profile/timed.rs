//! Decorators that time what the training loop asks of environment and student, and pass everything on.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use agents::{Agent, AgentError, Batch, Critic, Episode, Mode, Network};
use envs::render::Scene;
use envs::rng::Rng;
use envs::{EnvError, GoalEnv, GoalSource, Observation, Playback, Reward, Rows, Spec};

/// A sum of durations. One thread adds to it; being atomic, it can be shared with a decorator that must be [`Send`].
#[derive(Debug, Default)]
pub(super) struct Sum(AtomicU64);

impl Sum {
    fn time<T>(&self, work: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let result = work();
        self.add(begun.elapsed());
        result
    }

    fn add(&self, time: Duration) {
        self.0.fetch_add(time.as_nanos() as u64, Ordering::Relaxed);
    }

    pub(super) fn seconds(&self) -> f64 {
        Duration::from_nanos(self.0.load(Ordering::Relaxed)).as_secs_f64()
    }
}

/// What the decorators have timed.
#[derive(Debug, Default)]
pub(super) struct Clock {
    /// Steps of the training environment.
    pub(super) stepping: Sum,
    /// Its resets.
    pub(super) resetting: Sum,
    /// Exploring actions.
    pub(super) acting: Sum,
    /// Taking in episodes.
    pub(super) storing: Sum,
    /// Drawing batches, within learning.
    pub(super) sampling: Sum,
}

/// An environment whose steps and resets are timed.
pub(super) struct TimedEnv {
    env: Box<dyn GoalEnv>,
    clock: Arc<Clock>,
}

impl TimedEnv {
    pub(super) fn new(env: Box<dyn GoalEnv>, clock: Arc<Clock>) -> Self {
        Self { env, clock }
    }
}

impl Reward for TimedEnv {
    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        self.env.reward(achieved, goal)
    }

    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        self.env.success(achieved, goal)
    }
}

impl GoalSource for TimedEnv {
    fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]) {
        self.env.sample_goal(rng, goal);
    }
}

impl GoalEnv for TimedEnv {
    fn spec(&self) -> &Spec {
        self.env.spec()
    }

    fn reset(&mut self, rng: &mut Rng) -> Result<(), EnvError> {
        self.clock.resetting.time(|| self.env.reset(rng))
    }

    fn set_goal(&mut self, goal: &[f64]) -> Result<(), EnvError> {
        self.env.set_goal(goal)
    }

    fn step(&mut self, action: &[f64]) -> Result<(), EnvError> {
        self.clock.stepping.time(|| self.env.step(action))
    }

    fn observation(&self) -> &Observation {
        self.env.observation()
    }

    fn goal(&self) -> &[f64] {
        self.env.goal()
    }

    fn scene(&self) -> Option<Scene<'_>> {
        self.env.scene()
    }

    fn playback(&mut self) -> Option<&mut dyn Playback> {
        self.env.playback()
    }
}

/// A student whose exploring actions and episodes taken in are timed. What teachers and evaluations ask is theirs to time.
pub(super) struct TimedAgent {
    agent: Box<dyn Agent>,
    clock: Arc<Clock>,
}

impl TimedAgent {
    pub(super) fn new(agent: Box<dyn Agent>, clock: Arc<Clock>) -> Self {
        Self { agent, clock }
    }
}

impl Critic for TimedAgent {
    fn spec(&self) -> &Spec {
        self.agent.spec()
    }

    fn gradient_steps(&self) -> u64 {
        self.agent.gradient_steps()
    }

    fn lowest_value(&self) -> f64 {
        self.agent.lowest_value()
    }

    fn confidence(&mut self, goals: &Rows, states: &Rows, network: Network) -> Result<Vec<f64>, AgentError> {
        self.agent.confidence(goals, states, network)
    }

    fn policy(&mut self, states: &Rows, goals: &Rows, network: Network) -> Result<Rows, AgentError> {
        self.agent.policy(states, goals, network)
    }

    fn replay_states(&mut self, m: usize, rng: &mut Rng) -> Rows {
        self.agent.replay_states(m, rng)
    }

    fn replay_batch(&self, env: &dyn Reward, rng: &mut Rng, batch: &mut Batch) -> Result<(), AgentError> {
        self.agent.replay_batch(env, rng, batch)
    }

    fn label_next_actions(&mut self, batch: &mut Batch, network: Network) -> Result<(), AgentError> {
        self.agent.label_next_actions(batch, network)
    }
}

impl Agent for TimedAgent {
    fn act(
        &mut self,
        observation: &Observation,
        goal: &[f64],
        mode: Mode<'_>,
        action: &mut [f64],
    ) -> Result<(), AgentError> {
        self.clock.acting.time(|| self.agent.act(observation, goal, mode, action))
    }

    fn begin_episode(&mut self) {
        self.agent.begin_episode();
    }

    fn observe(&mut self, episode: &Episode, env: &dyn Reward, rng: &mut Rng) -> Result<(), AgentError> {
        self.clock.storing.time(|| self.agent.observe(episode, env, rng))
    }

    fn episodes_per_cycle(&self) -> usize {
        self.agent.episodes_per_cycle()
    }

    fn learn(&mut self, env: &dyn Reward, rng: &mut Rng) -> Result<(), AgentError> {
        let before = self.agent.sampling_time();
        let outcome = self.agent.learn(env, rng);
        if let (Some(before), Some(after)) = (before, self.agent.sampling_time()) {
            self.clock.sampling.add(after - before);
        }
        outcome
    }

    fn sampling_time(&self) -> Option<Duration> {
        self.agent.sampling_time()
    }

    fn save(&mut self, replay: &Path) -> Result<Vec<u8>, AgentError> {
        self.agent.save(replay)
    }

    fn load(&mut self, state: &[u8], replay: &Path) -> Result<(), AgentError> {
        self.agent.load(state, replay)
    }

    fn load_policy(&mut self, state: &[u8]) -> Result<(), AgentError> {
        self.agent.load_policy(state)
    }
}
