//! The benchmark harness: protocol → plan → runs → records, and the command line.
//!
//! Data flows one way. A [`protocol`] becomes a [`protocol::plan::Plan`]; the [`executor`] carries out its runs in worker
//! processes; each [`run`] writes its own folder; `goalbench report` reads those folders and nothing else.
//!
//! A program of one's own with further curricula is three lines: see [`Registry`].

pub mod cli;
pub mod config;
pub mod error;
pub mod estimate;
pub mod executor;
pub mod merge;
pub mod paper;
pub mod profile;
pub mod progress;
pub mod protocol;
mod registry;
pub mod regress;
pub mod run;
mod sha256;
pub mod status;
pub mod suggest;
pub mod tracking;

pub use error::HarnessError;
pub use registry::Registry;
