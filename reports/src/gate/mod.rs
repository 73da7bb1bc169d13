//! The regression gate: did a change make a method learn worse?
//!
//! ```text
//! results folder --cells::read-----------------------> cells now ------+
//! baseline file  --Baseline::read--> Baseline::cells_of --> cells before --compare--> CheckResult
//! CheckResult --output--> text, Markdown, JSON, JUnit, figure
//! ```
//!
//! [`cells`] reads the curves of runs, [`baseline`] keeps them in a small JSON file. [`compare()`] sets those
//! of a check against them: equal curves, byte for byte, or else a test of every [`group`] of cells by every
//! [`metric`]. [`false_alarms`] counts how often unchanged code would fail. Who carries the runs out is no
//! matter here: the page `harness/docs/regression.md` says how the gate is used and what it was seen to
//! catch.

pub mod baseline;
pub mod cells;
pub mod compare;
pub mod config;
mod error;
pub mod false_alarms;
pub mod group;
mod json;
pub mod metric;
pub mod output;
#[cfg(test)]
mod testing;

pub use baseline::Baseline;
pub use compare::{CheckResult, compare};
pub use error::GateError;
