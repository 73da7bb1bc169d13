//! What sets one environment apart from another, and the environment made of it.

use serde_json::{Map, Value};

use crate::draws::{Draws, RecordedDraws};
use crate::env::{GoalEnv, GoalSource, Observation, Reward, Spec};
use crate::error::EnvError;
use crate::playback::{Playback, PlaybackError, RecordedWorld, Start};
use crate::rng::Rng;
use crate::scene::Scene;

/// The world of an environment: its state, its dynamics, its goals. [`Env`] adds what is the same for all:
/// checks of what comes in, clipped actions, room for observation and goal.
///
/// ```
/// use envs::rng::{Purpose, stream};
/// use envs::{
///     Defaults, Draws, Env, EnvError, GoalEnv, Observation, Reward, Spec, WithinDistance, World,
/// };
///
/// /// A bead on a wire from -1 to 1.
/// #[derive(Default)]
/// struct Bead(f64);
///
/// impl World for Bead {
///     fn start(&mut self, draws: &mut Draws<'_>) -> Result<(), EnvError> {
///         [self.0] = draws.uniform([-0.1], [0.1]);
///         Ok(())
///     }
///
///     fn draw_goal(&self, draws: &mut Draws<'_>, goal: &mut [f64]) {
///         goal.copy_from_slice(&draws.uniform([-1.0], [1.0]));
///     }
///
///     fn advance(&mut self, action: &[f64]) -> Result<(), EnvError> {
///         self.0 = (self.0 + 0.1 * action[0]).clamp(-1.0, 1.0);
///         Ok(())
///     }
///
///     fn observe(&self, observation: &mut Observation) {
///         (observation.state[0], observation.achieved[0]) = (self.0, self.0);
///     }
///
///     fn task(&self) -> &dyn Reward {
///         &WithinDistance(0.05)
///     }
/// }
///
/// let spec = Spec {
///     id: "Bead", family: "toy", state: 1, goal: 1, action: 1, horizon: 20, defaults: Defaults::TOY,
/// };
/// let mut env = Env::new(spec, Bead::default());
/// env.reset(&mut stream(0, Purpose::Environment))?;
/// env.step(&[7.0])?; // the same as 1.0
/// # Ok::<(), EnvError>(())
/// ```
pub trait World: Send + Sync {
    /// Draws a start and goes there. Nothing of what happened before may have an influence.
    ///
    /// # Errors
    /// [`EnvError::Unstable`] if the world breaks down on the way.
    fn start(&mut self, draws: &mut Draws<'_>) -> Result<(), EnvError>;

    /// Draws a goal for the current start into `goal`, shape `[G]`. It depends on the start of the episode,
    /// not on how far the episode has come.
    fn draw_goal(&self, draws: &mut Draws<'_>, goal: &mut [f64]);

    /// One step with `action`, shape `[A]`, every component in [-1, 1].
    ///
    /// # Errors
    /// [`EnvError::Unstable`] if the world breaks down.
    fn advance(&mut self, action: &[f64]) -> Result<(), EnvError>;

    /// Writes what there is to see now over all of `observation`, whose lists have the spec's lengths.
    fn observe(&self, observation: &mut Observation);

    /// What counts as success, and its reward.
    fn task(&self) -> &dyn Reward;

    /// How the world looks now, with `goal` (shape `[G]`) marked in it; nothing for a world that cannot be
    /// drawn.
    fn scene(&self, _goal: &[f64]) -> Option<Scene<'_>> {
        None
    }

    /// The means to play recorded traces back, for a world with a recorded original.
    fn recorded(&mut self) -> Option<&mut dyn RecordedWorld> {
        None
    }
}

/// The environment made of a [`World`]. It checks what comes in, clips actions, and keeps observation and
/// goal.
pub struct Env<W> {
    spec: Spec,
    world: W,
    observation: Observation,
    goal: Vec<f64>,
    /// The last action, clipped.
    action: Vec<f64>,
}

impl<W: World> Env<W> {
    /// Shows the world as it is, with what is achieved as the goal.
    pub fn new(spec: Spec, world: W) -> Self {
        let mut observation = Observation { state: vec![0.0; spec.state], achieved: vec![0.0; spec.goal] };
        world.observe(&mut observation);
        let (goal, action) = (observation.achieved.clone(), vec![0.0; spec.action]);
        Self { spec, world, observation, goal, action }
    }

    fn reset_with(&mut self, draws: &mut Draws<'_>) -> Result<(), EnvError> {
        self.world.start(draws)?;
        self.world.observe(&mut self.observation);
        self.world.draw_goal(draws, &mut self.goal);
        Ok(())
    }
}

impl<W: World> Reward for Env<W> {
    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        self.world.task().success(achieved, goal)
    }

    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        self.world.task().reward(achieved, goal)
    }
}

impl<W: World> GoalSource for Env<W> {
    fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]) {
        self.world.draw_goal(&mut Draws::from(rng), goal);
    }
}

impl<W: World> GoalEnv for Env<W> {
    fn spec(&self) -> &Spec {
        &self.spec
    }

    fn reset(&mut self, rng: &mut Rng) -> Result<(), EnvError> {
        self.reset_with(&mut Draws::from(rng))
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
        self.world.scene(&self.goal)
    }

    fn playback(&mut self) -> Option<&mut dyn Playback> {
        if self.world.recorded().is_some() { Some(self) } else { None }
    }
}

impl<W: World> Env<W> {
    /// The world's side of playing traces back.
    fn recorded(&mut self) -> &mut dyn RecordedWorld {
        self.world.recorded().expect("traces are played back on worlds with a recorded original alone")
    }
}

impl<W: World> Playback for Env<W> {
    fn constants(&mut self) -> Map<String, Value> {
        let mut constants = self.recorded().constants();
        constants.insert("T".to_owned(), self.spec.horizon.into());
        constants
    }

    fn begin(&mut self, start: &Start) -> Result<(), PlaybackError> {
        self.recorded().restore(start)?;
        self.world.observe(&mut self.observation);
        Ok(())
    }

    fn reset_recorded(&mut self, draws: &mut RecordedDraws) -> Result<(), PlaybackError> {
        let outcome = self.reset_with(&mut Draws::from(&mut *draws));
        // The outcome of a reset whose draws did not fit means nothing.
        draws.finish()?;
        Ok(outcome?)
    }

    fn capture(&mut self) -> Start {
        self.recorded().capture()
    }
}

/// Refuses NaN and infinity.
fn check_finite(env: &'static str, what: &'static str, values: &[f64]) -> Result<(), EnvError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(EnvError::NotFinite { env, what, index, value: values[index] }),
    }
}
