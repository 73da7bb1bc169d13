//! A task made of nothing but dimensions, for tests and benchmarks that look at shapes, bytes and speed.

use agents::Episode;
use envs::rng::Rng;
use envs::{Defaults, EnvError, GoalEnv, GoalSource, Observation, Reward, Rows, Spec};
use rand::Rng as _;

/// The dimensions of FetchPush.
pub(crate) const FETCH: Spec = Spec {
    id: "FetchDimensions",
    family: "fetch",
    state: 25,
    goal: 3,
    action: 4,
    horizon: 50,
    defaults: Defaults::TOY,
};

/// An environment that stands still; its reward is that of a distance task with threshold 0.05.
#[derive(Debug)]
pub(crate) struct Still {
    spec: Spec,
    observation: Observation,
    goal: Vec<f64>,
}

impl Still {
    pub(crate) fn new(spec: Spec) -> Self {
        let observation = Observation { state: vec![0.0; spec.state], achieved: vec![0.0; spec.goal] };
        Self { goal: vec![0.0; spec.goal], observation, spec }
    }
}

impl Reward for Still {
    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        let squared: f64 = achieved.iter().zip(goal).map(|(a, g)| (a - g) * (a - g)).sum();
        if squared.sqrt() > 0.05 { -1.0 } else { 0.0 }
    }
    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        self.reward(achieved, goal) == 0.0
    }
}

impl GoalSource for Still {
    fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]) {
        goal.fill_with(|| rng.random());
    }
}

impl GoalEnv for Still {
    fn spec(&self) -> &Spec {
        &self.spec
    }
    fn reset(&mut self, rng: &mut Rng) -> Result<(), EnvError> {
        self.goal.fill_with(|| rng.random());
        Ok(())
    }
    fn set_goal(&mut self, goal: &[f64]) -> Result<(), EnvError> {
        self.goal.copy_from_slice(goal);
        Ok(())
    }
    fn step(&mut self, _action: &[f64]) -> Result<(), EnvError> {
        Ok(())
    }
    fn observation(&self) -> &Observation {
        &self.observation
    }
    fn goal(&self) -> &[f64] {
        &self.goal
    }
}

/// `n` rows of `width` numbers, uniform in [-1, 1).
pub(crate) fn random_rows(n: usize, width: usize, rng: &mut Rng) -> Rows {
    let mut rows = Rows::with_capacity(width, n);
    let mut row = vec![0.0; width];
    for _ in 0..n {
        row.fill_with(|| rng.random_range(-1.0..1.0));
        rows.push(&row);
    }
    rows
}

/// An episode of noise.
pub(crate) fn random_episode(spec: &Spec, rng: &mut Rng) -> Episode {
    Episode {
        states: random_rows(spec.horizon + 1, spec.state, rng),
        achieved: random_rows(spec.horizon + 1, spec.goal, rng),
        actions: random_rows(spec.horizon, spec.action, rng),
        goal: random_rows(1, spec.goal, rng).row(0).to_vec(),
        total_reward: 0.0,
        success: false,
    }
}
