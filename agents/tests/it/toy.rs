//! A student at work on the toy task, in the loop of a benchmark run.

use agents::{Agent, AgentError, Auto, CohortLane, Episode, Mode, StudentConfig};
use envs::rng::{Purpose, Rng, stream};
use envs::{EnvOptions, GoalEnv, Rows};

/// A student small enough to learn the toy task within seconds.
pub(crate) fn small() -> StudentConfig {
    StudentConfig { batch: Auto::Value(128), width: 64, layers: Auto::Value(2), ..StudentConfig::default() }
}

/// A training run: the student, its task and its random streams.
pub(crate) struct Run {
    pub(crate) agent: Box<dyn Agent>,
    pub(crate) env: Box<dyn GoalEnv>,
    seed: u64,
    starts: Rng,
    exploration: Rng,
    replay: Rng,
}

impl Run {
    pub(crate) fn new(config: &StudentConfig, seed: u64) -> Self {
        agents::prepare_thread();
        let env = envs::make("Point", &EnvOptions::default()).unwrap();
        Self {
            agent: agents::make(config, env.spec(), seed).unwrap(),
            env,
            seed,
            starts: stream(seed, Purpose::Environment),
            exploration: stream(seed, Purpose::Exploration),
            replay: stream(seed, Purpose::Replay),
        }
    }

    /// A run that has gone on for some cycles.
    pub(crate) fn trained(config: &StudentConfig, seed: u64, cycles: usize) -> Self {
        let mut run = Self::new(config, seed);
        run.cycles(cycles).unwrap();
        run
    }

    /// Cycles of episodes with exploration, then learning.
    pub(crate) fn cycles(&mut self, cycles: usize) -> Result<(), AgentError> {
        for _ in 0..cycles {
            self.episodes()?;
            self.agent.learn(self.env.as_ref(), &mut self.replay)?;
        }
        Ok(())
    }

    /// The episodes of a cycle.
    pub(crate) fn episodes(&mut self) -> Result<(), AgentError> {
        for _ in 0..self.agent.episodes_per_cycle() {
            self.env.reset(&mut self.starts).unwrap();
            self.agent.begin_episode();
            let mode = Mode::Explore(&mut self.exploration);
            let episode = rollout(self.agent.as_mut(), self.env.as_mut(), mode)?;
            self.agent.observe(&episode, self.env.as_ref(), &mut self.replay)?;
        }
        Ok(())
    }

    /// What a cohort needs to let it learn.
    pub(crate) fn lane(&mut self) -> CohortLane<'_> {
        CohortLane { student: self.agent.as_mut(), reward: self.env.as_ref(), rng: &mut self.replay }
    }

    /// Goes on from where the streams of `other` are.
    pub(crate) fn take_streams(&mut self, other: &Self) {
        self.starts = other.starts.clone();
        self.exploration = other.exploration.clone();
        self.replay = other.replay.clone();
    }

    /// Takes in an episode that is no numbers.
    pub(crate) fn poison(&mut self) {
        self.env.reset(&mut self.starts).unwrap();
        let mut episode = rollout(self.agent.as_mut(), self.env.as_mut(), Mode::Greedy).unwrap();
        let mut states = Rows::new(episode.states.width());
        episode.states.iter().for_each(|state| states.push(&vec![f64::NAN; state.len()]));
        episode.states = states;
        self.agent.observe(&episode, self.env.as_ref(), &mut self.replay).unwrap();
    }

    /// The share of `episodes` greedy episodes that end in success, the same starts and goals at every call.
    pub(crate) fn success_rate(&mut self, episodes: usize) -> f64 {
        let mut starts = stream(self.seed, Purpose::Evaluation(0));
        let successes = (0..episodes).filter(|_| {
            self.env.reset(&mut starts).unwrap();
            rollout(self.agent.as_mut(), self.env.as_mut(), Mode::Greedy).unwrap().success
        });
        successes.count() as f64 / episodes as f64
    }
}

/// Plays the episode that `env` has begun.
fn rollout(agent: &mut dyn Agent, env: &mut dyn GoalEnv, mut mode: Mode<'_>) -> Result<Episode, AgentError> {
    let spec = env.spec().clone();
    let mut states = Rows::with_capacity(spec.state, spec.horizon + 1);
    let mut achieved = Rows::with_capacity(spec.goal, spec.horizon + 1);
    let mut actions = Rows::with_capacity(spec.action, spec.horizon);
    let goal = env.goal().to_vec();
    let (mut action, mut total_reward) = (vec![0.0; spec.action], 0.0);
    for _ in 0..spec.horizon {
        states.push(&env.observation().state);
        achieved.push(&env.observation().achieved);
        let mode = match &mut mode {
            Mode::Greedy => Mode::Greedy,
            Mode::Explore(rng) => Mode::Explore(rng),
        };
        agent.act(env.observation(), &goal, mode, &mut action)?;
        env.step(&action).unwrap();
        actions.push(&action);
        total_reward += env.reward(&env.observation().achieved, &goal);
    }
    states.push(&env.observation().state);
    achieved.push(&env.observation().achieved);
    let success = env.success(&env.observation().achieved, &goal);
    Ok(Episode { states, achieved, actions, goal, total_reward, success })
}
