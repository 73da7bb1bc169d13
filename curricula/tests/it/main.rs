//! Tests of the teachers through their public interface.

mod axes;
mod contract;
mod disagreement;
mod distribution;
mod her_iid;
mod looks;
mod probe;
mod process;
mod procurl;
mod registry;
mod space;
mod standstill;
mod support;
mod teach;
mod vds;
