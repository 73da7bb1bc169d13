//! Tests of the teachers through their public interface.

mod alp_gmm;
mod axes;
mod contract;
mod disagreement;
mod distribution;
mod her_iid;
mod hgg;
mod looks;
mod mega;
mod probe;
mod procurl;
mod registry;
mod space;
mod standstill;
mod support;
mod teach;
mod tools;
mod vds;
