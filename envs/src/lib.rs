//! Goal-conditioned environments.
//!
//! [`GoalEnv`] is what students and the harness see of an environment. [`environments`] lists those of this
//! crate, [`Environment`] is a row of that list, and of those that a program adds from outside. [`World`] is
//! the short way to write one: [`Env`] makes a [`GoalEnv`] of it. [`testing::contract`] checks what everybody
//! relies on, [`trace`] proves that the built-in ones behave like the originals. All random numbers come from
//! the seeded streams of [`rng`]. Nothing here knows of students or teachers.
//!
//! ```
//! use envs::EnvOptions;
//! use envs::rng::{Purpose, stream};
//!
//! let mut env = envs::make("MazeA", &EnvOptions::default())?;
//! env.reset(&mut stream(0, Purpose::Environment))?;
//! for _ in 0..env.spec().horizon {
//!     env.step(&[1.0, 0.5])?;
//! }
//! let reward = env.reward(&env.observation().achieved, env.goal());
//! assert!(reward == 0.0 || reward == -1.0);
//! # Ok::<(), envs::EnvError>(())
//! ```

mod draws;
mod env;
mod error;
mod metric;
mod mujoco;
mod playback;
pub mod registry;
pub mod render;
pub mod rng;
mod rotation;
mod rows;
mod scene;
pub mod testing;
pub mod trace;
mod world;
mod worlds;
mod writer;

pub use draws::{Draw, DrawError, DrawKind, Draws, RecordedDraws};
pub use env::{Defaults, GoalEnv, GoalSource, Observation, Reward, Spec, draw_pool};
pub use error::EnvError;
pub use metric::WithinDistance;
pub use mujoco::{MUJOCO_VERSION, Physics};
pub use playback::{Playback, PlaybackError, RecordedWorld, SimulationStart, Start};
pub use registry::{
    EnvOptions, Environment, PaperRow, SUITES, Suite, Verification, environments, find, make, suite,
};
pub use rows::{Goals, Rows};
pub use world::{Env, World};
