//! Where a run's time goes: a short training, watched part by part.
//!
//! The training loop is that of every run: it tells its observer how long each
//! [`Stage`](crate::run::observer::Stage) took. Only the matrix products cannot be timed inside it; as many
//! as a cycle had are run alone after it ([`Products`]).

pub mod beside;
mod costs;
mod lockstep;
mod memory;
mod watch;

use agents::{ProductRates, Products};

pub use costs::{CostPart, Costs, Memory, RunProfile, Size};
pub use lockstep::{Lockstep, LockstepCosts, lockstep};

use crate::Registry;
use crate::config::frontier::FrontierOptions;
use crate::error::HarnessError;
use crate::protocol::plan::PlannedRun;
use crate::run::error::RunError;
use crate::run::train::Trainer;
use watch::Watch;

/// Trains `run` for `cycles` cycles, whatever its budget, and tells where the time went. One evaluation and
/// one checkpoint at the end stand for those of the whole run, which come once every `evaluation.every`
/// steps.
///
/// # Errors
/// [`HarnessError::Impossible`] if the run breaks down, [`HarnessError::System`] if no temporary
/// folder can be created.
///
/// # Panics
/// If `registry` lacks the run's environment or curriculum: plans only hold known ones.
pub fn profile(registry: &Registry, run: &PlannedRun, cycles: u64) -> Result<RunProfile, HarnessError> {
    let broken = |error: RunError| HarnessError::impossible(&run.key, "be profiled")(error);
    let spec = &registry.environment(&run.key.environment).expect("a plan only holds known names").spec;
    let student = &run.config.student;
    let size = Size {
        cycles,
        steps: cycles * (student.episodes_per_cycle() * spec.horizon) as u64,
        updates: cycles * student.updates_per_cycle as u64,
        evaluation_every: run.config.evaluation.every,
    };
    let mut config = run.config.clone();
    config.budget.steps = size.steps;
    config.evaluation.every = size.steps;
    config.frontier = FrontierOptions::default();
    config.shadow.clear();
    // Nothing is learned in a warm-up; what is measured here comes after it.
    config.student.warmup_episodes = 0;

    agents::prepare_thread();
    let products = Products::new(student, spec).map_err(|error| broken(error.into()))?;
    let gflop = products.gflop();
    let mut trainer = Trainer::new(registry, run.key.clone(), config).map_err(broken)?.without_rollouts();
    let folder = tempfile::tempdir().map_err(HarnessError::system("create a temporary folder"))?;
    let mut watch = Watch::new(folder.path(), products, student.updates_per_cycle);
    trainer.run(&mut watch).map_err(broken)?;
    let costs = watch.costs(size);
    let rates = ProductRates::measure(student, spec).map_err(|error| broken(error.into()))?;
    let memory = memory::measure(student, spec, size.cycles * student.episodes_per_cycle() as u64)?;
    let (batch, layers) = (student.batch(), student.layers(spec));
    Ok(RunProfile { run: run.key.clone(), batch, layers, size, costs, gflop, rates, memory })
}
