//! Goal-conditioned environments.
//!
//! [`GoalEnv`] is the trait, [`registry`] the table of all environments, [`trace`] the proof that they behave like
//! the originals. Random draws come from the seeded streams of [`rng`]. Nothing here knows of students or teachers.

mod draws;
mod env;
mod error;
mod fetch;
mod hand;
mod maze;
mod metric;
mod mujoco;
mod point;
pub mod registry;
pub mod render;
mod replay;
pub mod rng;
mod rotation;
mod rows;
pub mod trace;
mod world;
mod writer;

pub use draws::{Draw, DrawError, DrawKind, RecordedDraws};
pub use env::{Family, GoalEnv, GoalSource, Observation, Reward, Spec, draw_pool};
pub use error::EnvError;
pub use maze::maze_walls;
pub use mujoco::{MUJOCO_VERSION, Physics};
pub use registry::{ENVIRONMENTS, Environment, Options, find, make, suite};
pub use replay::{Replay, ReplayError, SimulationStart, Start};
pub use rows::{Goals, Rows};
