//! What sets one environment apart from another, and the environment made of it.

use serde_json::{Map, Value};

use crate::draws::{Draws, RecordedDraws};
use crate::env::{GoalEnv, GoalSource, Observation, Reward, Spec};
use crate::error::EnvError;
use crate::render::{Scene, Shape};
use crate::replay::{Replay, ReplayError, Start};
use crate::rng::Rng;

/// The world of an environment: its state, its dynamics, its goals.
pub(crate) trait World: Send {
    /// Draws a start and goes there. Nothing of what happened before may have an influence.
    fn start<D: Draws, E>(&mut self, draws: &mut D) -> Result<(), E>
    where
        E: From<EnvError> + From<D::Error>;

    /// Draws a goal for the current start into `goal`, shape `[G]`.
    fn draw_goal<D: Draws>(&self, draws: &mut D, goal: &mut [f64]) -> Result<(), D::Error>;

    /// One step with `action`, shape `[A]`, in [−1, 1].
    fn advance(&mut self, action: &[f64]) -> Result<(), EnvError>;

    /// Writes what there is to see now.
    fn observe(&self, observation: &mut Observation);

    /// The sparse reward (see [`GoalEnv::reward`]).
    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64;

    /// Success (see [`GoalEnv::success`]).
    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool;

    /// How the world looks now, with `goal` (shape `[G]`) marked in it.
    fn shape(&self, goal: &[f64]) -> Shape<'_>;

    /// Constants under the names that recordings use (see [`Replay::constants`]).
    fn constants(&self) -> Map<String, Value>;

    /// The state now.
    fn capture(&self) -> Start;

    /// Goes to a captured or recorded state, which becomes the current start.
    fn restore(&mut self, state: &Start) -> Result<(), ReplayError>;
}

/// An environment: a world, with checks on what comes in and room for what is to see.
pub(crate) struct Env<W> {
    spec: Spec,
    world: W,
    observation: Observation,
    goal: Vec<f64>,
    /// The last action, clipped.
    action: Vec<f64>,
}

impl<W: World> Env<W> {
    /// Shows the world as it is, with what is achieved as the goal.
    pub(crate) fn new(spec: Spec, world: W) -> Self {
        let mut observation = Observation { state: vec![0.0; spec.state], achieved: vec![0.0; spec.goal] };
        world.observe(&mut observation);
        let (goal, action) = (observation.achieved.clone(), vec![0.0; spec.action]);
        Self { spec, world, observation, goal, action }
    }

    fn reset_with<D: Draws, E>(&mut self, draws: &mut D) -> Result<(), E>
    where
        E: From<EnvError> + From<D::Error>,
    {
        self.world.start::<D, E>(draws)?;
        self.world.observe(&mut self.observation);
        Ok(self.world.draw_goal(draws, &mut self.goal)?)
    }
}

impl<W: World> Reward for Env<W> {
    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        self.world.reward(achieved, goal)
    }

    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        self.world.success(achieved, goal)
    }
}

impl<W: World> GoalSource for Env<W> {
    fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]) {
        let Ok(()) = self.world.draw_goal(rng, goal);
    }
}

impl<W: World> GoalEnv for Env<W> {
    fn spec(&self) -> &Spec {
        &self.spec
    }

    fn reset(&mut self, rng: &mut Rng) -> Result<(), EnvError> {
        self.reset_with(rng)
    }

    fn set_goal(&mut self, goal: &[f64]) -> Result<(), EnvError> {
        let env = self.spec.id;
        if goal.len() != self.spec.goal {
            return Err(EnvError::GoalLength { env, expected: self.spec.goal, got: goal.len() });
        }
        check_finite(env, "goal", goal)?;
        self.goal.copy_from_slice(goal);
        Ok(())
    }

    fn step(&mut self, action: &[f64]) -> Result<(), EnvError> {
        let env = self.spec.id;
        if action.len() != self.spec.action {
            return Err(EnvError::ActionLength { env, expected: self.spec.action, got: action.len() });
        }
        check_finite(env, "action", action)?;
        for (clipped, asked) in self.action.iter_mut().zip(action) {
            *clipped = asked.clamp(-1.0, 1.0);
        }
        self.world.advance(&self.action)?;
        self.world.observe(&mut self.observation);
        Ok(())
    }

    fn observation(&self) -> &Observation {
        &self.observation
    }

    fn goal(&self) -> &[f64] {
        &self.goal
    }

    fn scene(&self) -> Option<Scene<'_>> {
        Some(Scene(self.world.shape(&self.goal)))
    }

    fn replay(&mut self) -> Option<&mut dyn Replay> {
        Some(self)
    }
}

impl<W: World> Replay for Env<W> {
    fn constants(&self) -> Map<String, Value> {
        let mut constants = self.world.constants();
        constants.insert("T".to_owned(), self.spec.horizon.into());
        constants
    }

    fn begin(&mut self, start: &Start) -> Result<(), ReplayError> {
        self.world.restore(start)?;
        self.world.observe(&mut self.observation);
        Ok(())
    }

    fn reset_recorded(&mut self, draws: &mut RecordedDraws<'_>) -> Result<(), ReplayError> {
        self.reset_with(draws)
    }

    fn capture(&self) -> Start {
        self.world.capture()
    }
}

/// Refuses NaN and infinity.
fn check_finite(env: &'static str, what: &'static str, values: &[f64]) -> Result<(), EnvError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(EnvError::NotFinite { env, what, index, value: values[index] }),
    }
}
