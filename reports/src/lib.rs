//! Records, their store, statistics, figures and tables.
//!
//! This crate owns the record schema ([`record`]) and knows nothing of environments or students, so that
//! figures can be redrawn without MuJoCo or libtorch. [`report::write`] turns a results folder into a report:
//!
//! ```text
//! runs/ --Store::read--> runs --groups--> one group per curve --Curve::of-------> learning curves, ablations
//!                                                             --Row::of---------> summary, what teachers picked
//!                                      --comparable--> groups --Finals::of------> comparisons, sums over environments
//!                                                             --ledger----------> verdicts on the paper's claims
//!                                                             --Readings::of----> the same under every reading of it
//!       --store::teaching--> what teachers did                --HeatMap::of-----> heat maps of mazes
//! ```
//!
//! A report is figures, tables, tidy data and one page that shows them all.
//!
//! It never prints: what is wrong with single files comes back as [`problem::Problem`]s.

pub mod analysis;
pub mod deviations;
pub mod dictionary;
pub mod environment;
pub mod error;
pub mod gate;
pub mod methods;
pub mod paper;
pub mod render;
pub mod report;
pub mod schema;
pub mod stats;
pub mod store;
pub mod synthetic;

pub use error::ReportError;
