//! Tests of reports through the crate's public interface.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod altered;
mod calibration;
mod comparable;
mod data;
mod efficiency;
mod families;
mod figures;
mod film;
mod footer;
mod frontier;
mod latex;
mod ledger;
mod noise;
mod page;
mod readings;
mod report;
mod rollouts;
mod shadow;
mod statistics;
mod store;
mod student;
mod support;
mod teaching;
mod timings;
mod tuning;
mod verdicts;
