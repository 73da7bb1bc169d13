//! The teachers: automatic curricula over goals.
//!
//! A [`Method`] is a way to teach. All that changes while it teaches is its state ([`TeacherState`]). A
//! [`Teacher`] holds both, and saves and loads the state. The harness sees it as a [`Curriculum`].
//! [`CURRICULA`] is the table of the methods that come with this crate: a new one is one file, its `pub mod`
//! line in [`methods`] and one row of the table. Outside this workspace it is the same file, and an [`Entry`]
//! made from it.
//!
//! Many teachers work alike: a [`Probe`] asks the student for its confidence in every goal and remembers the
//! answers in a [`Window`]; from these follows a [`Distribution`] over goals. [`PoolState`] and
//! [`ScoredPool`] put the parts together.
//!
//! Teachers that go by success keep a [`History`] of it, for goals or for [`Regions`] of them. Others go by
//! what the student has achieved: [`Mixture`], [`KernelDensity`] and [`assignment`] are the tools for that.
//! Whoever wants to know more than training shows asks for [`Rollouts`].
//! Fresh goals come from [`sample_goals`].
//!
//! [`testing::contract`] checks what every method must keep, and [`testing::Class`] is where it can be
//! watched at work.

mod achieved;
mod assignment;
mod config;
mod curriculum;
mod density;
mod distribution;
mod error;
mod fresh;
mod history;
mod judgement;
mod kmeans;
mod method;
pub mod methods;
mod mixture;
mod played;
mod pool_state;
mod probe;
mod regions;
mod registry;
mod replayed;
mod rollouts;
mod scaling;
pub mod snapshot;
mod state;
mod teacher;
pub mod testing;
mod variance;
mod window;

pub use assignment::assignment;
pub use config::{Configured, schema_of};
pub use curriculum::{Curriculum, Lesson, Proposal, ProposedGoal, Rank, Setting, Statistics, TeacherSummary};
pub use density::{KernelDensity, divergence};
pub use distribution::Distribution;
pub use error::CurriculumError;
pub use fresh::sample_goals;
pub use history::History;
pub use judgement::{Judgement, learnability};
pub use method::Method;
pub use mixture::{Gaussian, Mixture, REGULARISATION, parameters};
pub use played::nearest_goal;
pub use pool_state::{PoolState, ScoredPool};
pub use probe::{Answer, Probe, ProbeConfig, StateSource};
pub use regions::Regions;
pub use registry::{CURRICULA, Configure, Entry};
pub use rollouts::{RolloutPolicy, RolloutRequest, Rollouts};
pub use scaling::Scaling;
pub use state::{PlainState, TeacherState};
pub use teacher::Teacher;
pub use variance::{ROUNDING, population_variance, rounding};
pub use window::Window;
