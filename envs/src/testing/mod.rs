//! What tests of environments need, inside and outside of this crate.

mod contract;

pub use contract::contract;
