//! Tests of the teachers through their public interface.

mod alp_gmm;
mod axes;
mod contract;
mod disagreement;
mod distribution;
mod goid;
mod her_iid;
mod hgg;
mod judge;
mod looks;
mod lp;
mod mega;
mod plr;
mod probe;
mod process;
mod procurl;
mod registry;
mod sfl;
mod shadow;
mod space;
mod standstill;
mod support;
mod teach;
mod tools;
mod vds;
