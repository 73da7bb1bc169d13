//! Where a run's time goes: a short training, watched part by part.
//!
//! The training loop is the one of every run. Decorators around environment and student ([`timed`]) and a [`Watcher`] hold the
//! watches, some ten per training step at 50 ns each; the matrix products, which cannot be told apart from inside, are
//! run alone after every cycle ([`Products`]), as many as the cycle had.
//!
//! [`Watcher`]: crate::run::train::Watcher
//! [`Products`]: agents::Products

pub mod beside;
mod costs;
mod timed;
mod watch;

use std::sync::Arc;

use agents::Products;

pub use costs::{Costs, Part, Profile, Size};

use crate::Registry;
use crate::error::HarnessError;
use crate::protocol::plan::PlannedRun;
use crate::run::train::{RunError, Trainer};
use timed::{Clock, TimedAgent, TimedEnv};
use watch::Watch;

/// Trains `run` for `cycles` cycles, whatever its budget, and tells where the time went. One evaluation and one checkpoint
/// at the end stand for those of the whole run, which come once every `evaluation.every` steps.
///
/// # Errors
/// [`HarnessError::Run`] if the run breaks down, [`HarnessError::Io`] if no temporary folder can be had.
///
/// # Panics
/// If `registry` lacks the run's environment or curriculum: plans only hold known ones.
pub fn profile(registry: &Registry, run: &PlannedRun, cycles: u64) -> Result<Profile, HarnessError> {
    let broken = |error: RunError| HarnessError::Run { run: run.key.to_string(), reason: error.to_string() };
    let spec = &registry.environment(&run.key.environment).expect("a plan only holds known names").spec;
    let student = &run.config.student;
    let size = Size {
        cycles,
        steps: cycles * (student.episodes_per_cycle * spec.horizon) as u64,
        updates: cycles * student.updates_per_cycle as u64,
        evaluation_every: run.config.evaluation.every,
    };
    let mut config = run.config.clone();
    config.budget.steps = size.steps;
    config.evaluation.every = size.steps;

    agents::prepare_thread();
    let products = Products::new(student, spec).map_err(|error| broken(error.into()))?;
    let clock = Arc::new(Clock::default());
    let mut trainer = Trainer::new(registry, run.key.clone(), config).map_err(broken)?.decorated(
        |env| Box::new(TimedEnv::new(env, Arc::clone(&clock))),
        |agent| Box::new(TimedAgent::new(agent, Arc::clone(&clock))),
    );
    let folder = tempfile::tempdir().map_err(HarnessError::io("temporary folder", "create one"))?;
    let mut watch = Watch::new(folder.path(), products, student.updates_per_cycle);
    trainer.run(&mut watch).map_err(broken)?;
    let costs = watch.costs(&clock, size);
    Ok(Profile { run: run.key.clone(), batch: student.batch(), layers: student.layers(spec), size, costs })
}
