//! Records, their store, statistics, figures and tables.
//!
//! This crate owns the record schema ([`schema`]) and knows nothing of environments or students, so that
//! figures can be redrawn without MuJoCo or libtorch. Nor does it know of methods or of a paper: that is
//! handed in as a [`Catalogue`]. [`write()`] turns a results folder into a report:
//!
//! ```text
//! runs/ --store--> runs --analysis (with stats)--> numbers --artefacts (with render)--> report/
//! ```
//!
//! Each part knows those before it alone: `schema`, `store`, `stats`, `analysis`, `render`, `artefacts`. What
//! a report shows is the table [`artefacts::ARTEFACTS`].
//!
//! The crate never prints: what is wrong with single files comes back as [`store::problem::StoreProblem`]s.

pub mod analysis;
pub mod artefacts;
pub mod error;
pub mod gate;
pub mod render;
pub mod schema;
pub mod stats;
pub mod store;
pub mod synthetic;
#[cfg(test)]
mod testing;
pub mod wording;

pub use analysis::catalogue::Catalogue;
pub use analysis::guests::Guest;
pub use analysis::options::ReportOptions;
pub use artefacts::{TidyData, Written, tidy_data, write, write_beside};
pub use error::ReportError;
