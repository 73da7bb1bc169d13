//! What tests of environments need, inside and outside of this crate.

mod allocations;
mod contract;

pub use allocations::{CountingAllocator, allocations};
pub use contract::contract;
