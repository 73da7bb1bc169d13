//! One run: its folder, its training loop, its evaluations. Several go through their cycles in lockstep: a
//! [`cohort`].

pub mod checkpoint;
pub mod cohort;
pub mod error;
pub mod evaluate;
pub mod folder;
mod frontier;
pub mod lock;
pub mod manifest;
pub mod observer;
pub mod picks;
pub mod policy;
mod probing;
mod shadow;
pub mod state;
pub mod train;
