//! What an environment offers beyond [`GoalEnv`](crate::GoalEnv) so that recorded traces can be played back
//! on it.

use serde_json::{Map, Value};

use crate::draws::{DrawError, RecordedDraws};
use crate::error::EnvError;

/// A state that a trace starts from.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// Mazes and the toy task: the point's position.
    Position(Vec<f64>),
    /// Simulations.
    Simulation(SimulationStart),
}

/// The state of a MuJoCo simulation; the solver's warm start is no part of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationStart {
    /// Seconds.
    pub time: f64,
    /// Positions, shape `[nq]`.
    pub qpos: Vec<f64>,
    /// Velocities, shape `[nv]`.
    pub qvel: Vec<f64>,
    /// Controls, shape `[nu]`.
    pub ctrl: Vec<f64>,
    /// Positions of mocap bodies, shape `[nmocap, 3]`.
    pub mocap_pos: Vec<[f64; 3]>,
    /// Their orientations, shape `[nmocap, 4]`.
    pub mocap_quat: Vec<[f64; 4]>,
}

/// Why a recorded start or reset cannot be played back.
#[derive(Debug, thiserror::Error)]
pub enum PlaybackError {
    /// The environment itself failed.
    #[error(transparent)]
    Env(#[from] EnvError),
    /// The recorded draws are not those that the reset asks for.
    #[error(transparent)]
    Draws(#[from] DrawError),
    /// A part of the start state is missing or has another length than the model's.
    #[error("start.{field} should hold {expected} numbers, {got} are recorded")]
    Start {
        /// Part of the start state.
        field: &'static str,
        /// The model's length.
        expected: usize,
        /// The recorded length.
        got: usize,
    },
}

impl Start {
    /// The position of a point in the plane.
    ///
    /// # Errors
    /// [`PlaybackError::Start`] if it is the state of a simulation or not in the plane.
    pub(crate) fn position(&self) -> Result<[f64; 2], PlaybackError> {
        let recorded: &[f64] = match self {
            Self::Position(position) => position,
            Self::Simulation(_) => &[],
        };
        let got = recorded.len();
        recorded.try_into().map_err(|_| PlaybackError::Start { field: "position", expected: 2, got })
    }
}

/// Plays recorded starts and resets back.
pub trait Playback {
    /// The environment's constants under the names that recordings use.
    fn constants(&mut self) -> Map<String, Value>;

    /// Puts the environment into a recorded state; the goal stays.
    ///
    /// # Errors
    /// [`PlaybackError::Start`], or the environment's own errors.
    fn begin(&mut self, start: &Start) -> Result<(), PlaybackError>;

    /// Resets as the reference did when `draws` were recorded, with whatever solver state it kept. The reset
    /// must use up all of them.
    ///
    /// # Errors
    /// [`PlaybackError::Draws`], or the environment's own errors.
    fn reset_recorded(&mut self, draws: &mut RecordedDraws) -> Result<(), PlaybackError>;

    /// The state now, from which [`Playback::begin`] goes on, but for the solver's warm start.
    fn capture(&mut self) -> Start;
}

/// What a [`World`](crate::World) with a recorded original offers, so that [`Env`](crate::Env) can be a
/// [`Playback`].
pub trait RecordedWorld {
    /// The world's constants under the names that recordings use. The horizon `T` is added by the
    /// environment.
    fn constants(&self) -> Map<String, Value>;

    /// The state now.
    fn capture(&self) -> Start;

    /// Goes to a captured or recorded state, which becomes the current start.
    ///
    /// # Errors
    /// [`PlaybackError::Start`], or the world's own errors.
    fn restore(&mut self, state: &Start) -> Result<(), PlaybackError>;
}
