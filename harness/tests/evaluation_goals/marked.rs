//! An environment in which everything that comes of an evaluation is marked.

use std::cell::Cell;

use envs::rng::{Purpose, Rng, stream};
use envs::{EnvError, EnvOptions, GoalEnv, GoalSource, Observation, Reward, Spec};

/// Added to every number of an evaluation's states and goals. The training side has none beyond 1.
pub(crate) const MARK: f64 = 1_000.0;
/// The seed of the runs.
pub(crate) const SEED: u64 = 5;
/// More evaluations than a run here has.
const EVALUATIONS: u64 = 50;

thread_local! {
    /// Evaluation episodes begun in this thread.
    static EVALUATION_EPISODES: Cell<u64> = const { Cell::new(0) };
}

/// Evaluation episodes since the last call.
pub(crate) fn take_evaluation_episodes() -> u64 {
    EVALUATION_EPISODES.take()
}

/// The point task, shifted by [`MARK`] in whatever is drawn from an evaluation's stream.
pub(crate) struct Marked {
    point: Box<dyn GoalEnv>,
    spec: Spec,
    /// [`MARK`] in an evaluation's episode, else 0.
    shift: f64,
    observation: Observation,
    goal: Vec<f64>,
}

/// An [`envs::registry::Constructor`].
pub(crate) fn make(spec: Spec, options: &EnvOptions) -> Result<Box<dyn GoalEnv>, EnvError> {
    let point = envs::make("Point", options)?;
    let (observation, goal) = (point.observation().clone(), point.goal().to_vec());
    Ok(Box::new(Marked { point, spec, shift: 0.0, observation, goal }))
}

/// [`MARK`] if `rng` is an evaluation's stream, at any index; else 0.
fn shift(rng: &Rng) -> f64 {
    let is = |index| stream(SEED, Purpose::Evaluation(index)).get_seed() == rng.get_seed();
    if (0..EVALUATIONS).any(is) { MARK } else { 0.0 }
}

impl Marked {
    fn show(&mut self) {
        let Observation { state, achieved } = self.point.observation();
        let shifted = |numbers: &[f64]| numbers.iter().map(|x| x + self.shift).collect();
        self.observation = Observation { state: shifted(state), achieved: shifted(achieved) };
        self.goal = shifted(self.point.goal());
    }
}

impl Reward for Marked {
    // Differences are all that counts, and those of two shifted places are the same.
    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        self.point.reward(achieved, goal)
    }

    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        self.point.success(achieved, goal)
    }
}

impl GoalSource for Marked {
    fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]) {
        let shift = shift(rng);
        self.point.sample_goal(rng, goal);
        goal.iter_mut().for_each(|x| *x += shift);
    }
}

impl GoalEnv for Marked {
    fn spec(&self) -> &Spec {
        &self.spec
    }

    fn reset(&mut self, rng: &mut Rng) -> Result<(), EnvError> {
        self.shift = shift(rng);
        if self.shift != 0.0 {
            EVALUATION_EPISODES.set(EVALUATION_EPISODES.get() + 1);
        }
        self.point.reset(rng)?;
        self.show();
        Ok(())
    }

    fn set_goal(&mut self, goal: &[f64]) -> Result<(), EnvError> {
        self.point.set_goal(goal)?;
        self.show();
        Ok(())
    }

    fn step(&mut self, action: &[f64]) -> Result<(), EnvError> {
        self.point.step(action)?;
        self.show();
        Ok(())
    }

    fn observation(&self) -> &Observation {
        &self.observation
    }

    fn goal(&self) -> &[f64] {
        &self.goal
    }
}
