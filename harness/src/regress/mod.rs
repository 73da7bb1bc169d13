//! The regression gate: does a change make a method learn worse?
//!
//! A [sweep](crate::sweep) carries out a reduced protocol, [`cells`] reads its curves, [`baseline`] keeps them in a small JSON file. A later
//! check carries the same protocol out again and [compares](mod@compare): equal curves, byte for byte, or else a test of every
//! [`group`] of runs by every [`measure`]. [`false_alarms`] counts how often unchanged code would fail.
//!
//! The page `harness/docs/regression.md` says how to use it and what it was seen to catch.

pub mod baseline;
pub mod cells;
pub mod compare;
pub mod config;
pub mod false_alarms;
pub mod group;
mod json;
pub mod measure;
pub mod output;

pub use baseline::Baseline;
pub use compare::{Comparison, compare};
