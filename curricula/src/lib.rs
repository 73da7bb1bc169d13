//! The teachers: automatic curricula over goals.
//!
//! [`Curriculum`] is what a teacher does during a run, [`Method`] what it is as an entry of a table, and
//! [`CURRICULA`] the table of those that come with this crate. A new teacher is one file,
//! its `pub mod` line in [`methods`] and one row of the table; outside this workspace it is the same file and an [`Entry`]
//! made from it.
//!
//! The other modules are what teachers have in common: a [`Probe`] asks the student for its confidence and remembers the
//! answers in a [`Window`], a [`Distribution`] over goals comes of them (both are a [`PoolState`]), and
//! [`snapshot`] keeps it all for a resumed run.

mod curriculum;
mod distribution;
mod error;
pub mod methods;
mod pool_state;
mod probe;
mod registry;
pub mod snapshot;
mod variance;
mod window;

pub use curriculum::{Choice, Curriculum, Lesson, Proposal, Rank, Setting, Statistics};
pub use distribution::Distribution;
pub use error::CurriculumError;
pub use pool_state::PoolState;
pub use probe::{Answer, Probe, ProbeConfig, StateSource};
pub use registry::{Build, CURRICULA, Entry, Method};
pub use variance::{ROUNDING, population_variance, rounding};
pub use window::Window;
