//! The benchmark harness: protocol → plan → runs → records, and the command line.
//!
//! Data flows one way. A [`protocol`] becomes a [`protocol::plan::Plan`]; a [`sweep`] carries out its runs in
//! worker processes; each [`run`] writes its own folder; `goalbench report` reads those folders and nothing
//! else.
//!
//! A program of your own with further curricula is three lines: see [`Registry`]. [`cli`] says how to add a
//! command-line flag.

pub mod archive;
pub mod cli;
pub mod config;
mod console;
pub mod error;
pub mod estimate;
pub mod export;
mod files;
mod fresh_folder;
pub mod memory;
pub mod merge;
pub mod outputs;
mod pace;
pub mod paper;
pub mod profile;
mod program;
pub mod protocol;
mod registry;
pub mod regress;
pub mod run;
pub mod status;
pub mod suggest;
pub mod sweep;
pub mod tracking;
mod tuning;

pub use error::HarnessError;
pub use program::Program;
pub use registry::Registry;
