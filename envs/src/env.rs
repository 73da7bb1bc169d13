//! What every goal-conditioned environment offers.

use crate::error::EnvError;
use crate::playback::Playback;
use crate::rng::Rng;
use crate::rows::Goals;
use crate::scene::Scene;

/// The constants of an environment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spec {
    /// Registry id, such as `FetchReach`.
    pub id: &'static str,
    /// A label for lists, such as `fetch`. No program behaves differently for it.
    pub family: &'static str,
    /// S, dimension of the state (the reference's `observation`, without goals).
    pub state: usize,
    /// G, dimension of goal and achieved goal.
    pub goal: usize,
    /// A, dimension of the action; every component lies in [-1, 1].
    pub action: usize,
    /// H, steps per episode; episodes never end earlier.
    pub horizon: usize,
    /// How it is trained unless a config says otherwise.
    pub defaults: Defaults,
}

/// How an environment is trained unless a config says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Defaults {
    /// Training steps of a run.
    pub steps: u64,
    /// Training steps between evaluations.
    pub evaluate_every: u64,
    /// Hidden layers of the student's networks (see the student's preset `harmonised`).
    pub layers: usize,
}

impl Defaults {
    /// Enough for a task that is learned within seconds.
    pub const TOY: Self = Self { steps: 4_000, evaluate_every: 400, layers: 2 };
}

/// What the student sees after a reset or step, apart from the goal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observation {
    /// State, shape `[S]`.
    pub state: Vec<f64>,
    /// Achieved goal, shape `[G]`.
    pub achieved: Vec<f64>,
}

/// What a task rewards: all that hindsight relabelling needs to know of an environment. It may be asked from
/// a thread that the environment does not live on.
pub trait Reward: Sync {
    /// Whether `achieved` counts as success for `goal` (shape `[G]` both).
    ///
    /// # Panics
    /// If a length is not G, here and in [`Reward::reward`]: only a mistake in the program can do that.
    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool;

    /// The sparse reward of having achieved `achieved` when `goal` was asked for (shape `[G]` both): 0 for
    /// success, else -1. Hindsight relabelling uses it too.
    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        if self.success(achieved, goal) { 0.0 } else { -1.0 }
    }
}

/// Where fresh goals come from: all that a teacher sees of an environment.
pub trait GoalSource {
    /// Draws one goal into `goal`, shape `[G]`, as the environment would for the current start.
    /// The running episode keeps its own goal.
    ///
    /// # Panics
    /// If `goal` does not hold G numbers.
    fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]);
}

/// A goal-conditioned environment with sparse reward and fixed horizon.
///
/// An episode is `reset`, optionally `set_goal` (a teacher's choice), then `horizon` times `step`.
/// What a reset draws depends on the stream alone, never on earlier episodes or on who sets the goal:
/// starts stay paired between curricula. [`testing::contract`](crate::testing::contract) checks this.
///
/// A new environment is easier written as a [`World`](crate::World).
pub trait GoalEnv: Reward + GoalSource + Send {
    /// The environment's constants.
    fn spec(&self) -> &Spec;

    /// Starts an episode: draws a start state and a goal from the environment's own joint distribution.
    ///
    /// # Errors
    /// [`EnvError::Unstable`] if the simulation breaks down while it settles.
    fn reset(&mut self, rng: &mut Rng) -> Result<(), EnvError>;

    /// Replaces the goal of the running episode.
    ///
    /// # Errors
    /// [`EnvError::GoalLength`] or [`EnvError::NotFinite`]; the old goal then stays.
    fn set_goal(&mut self, goal: &[f64]) -> Result<(), EnvError>;

    /// Applies `action`, shape `[A]`, clipped to [-1, 1], for one step.
    ///
    /// # Errors
    /// [`EnvError::ActionLength`], [`EnvError::NotFinite`], [`EnvError::Unstable`].
    fn step(&mut self, action: &[f64]) -> Result<(), EnvError>;

    /// The observation after the last reset or step.
    fn observation(&self) -> &Observation;

    /// The goal of the running episode, shape `[G]`.
    fn goal(&self) -> &[f64];

    /// What [`Renderer`](crate::render::Renderer) draws, if the environment can be drawn.
    fn scene(&self) -> Option<Scene<'_>> {
        None
    }

    /// The means to play recorded traces back, if the environment has a recorded original.
    fn playback(&mut self) -> Option<&mut dyn Playback> {
        None
    }
}

/// Draws a pool of `n` goals from the environment's own joint distribution, one reset each: shape `[n, G]`.
///
/// ```
/// use envs::rng::{Purpose, stream};
///
/// let mut env = envs::make("Point", &envs::EnvOptions::default())?;
/// let pool = envs::draw_pool(env.as_mut(), 100, &mut stream(0, Purpose::Pool))?;
/// assert_eq!((pool.len(), pool.width()), (100, 2));
/// # Ok::<(), envs::EnvError>(())
/// ```
///
/// # Errors
/// Those of [`GoalEnv::reset`].
pub fn draw_pool(env: &mut dyn GoalEnv, n: usize, rng: &mut Rng) -> Result<Goals, EnvError> {
    let mut pool = Goals::with_capacity(env.spec().goal, n);
    for _ in 0..n {
        env.reset(rng)?;
        pool.push(env.goal());
    }
    Ok(pool)
}
