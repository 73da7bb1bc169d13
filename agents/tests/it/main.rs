//! Tests of the student through the crate's public interface.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

#[path = "../support/mod.rs"]
mod support;

mod cohort;
mod contract;
mod determinism;
mod learning;
mod presets;
mod toy;
mod values;
