//! Where a run's time goes: a short training, watched part by part.
//!
//! The training loop is the one of every run. Decorators around environment and student (`timed`) and a [`Watcher`] hold the
//! watches, some ten per training step at 50 ns each; the matrix products, which cannot be told apart from inside, are
//! run alone after every cycle ([`Products`]), as many as the cycle had.
//!
//! [`Watcher`]: crate::run::train::Watcher
//! [`Products`]: agents::Products

pub mod beside;
mod costs;
mod memory;
mod timed;
mod watch;

use std::sync::Arc;

use agents::Products;

pub use costs::{Costs, Memory, Part, Profile, Size};

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
        steps: cycles * (student.episodes_per_cycle() * spec.horizon) as u64,
        updates: cycles * student.updates_per_cycle as u64,
        evaluation_every: run.config.evaluation.every,
    };
    let mut config = run.config.clone();
    config.budget.steps = size.steps;
    config.evaluation.every = size.steps;
    // Nothing is learned in a warm-up; what is measured here comes after it.
    config.student.warmup_episodes = 0;

    agents::prepare_thread();
    let products = Products::new(student, spec).map_err(|error| broken(error.into()))?;
    let gflop = products.gflop();
    let clock = Arc::new(Clock::default());
    let mut trainer = Trainer::new(registry, run.key.clone(), config).map_err(broken)?.decorated(
        |env| Box::new(TimedEnv::new(env, Arc::clone(&clock))),
        |agent| Box::new(TimedAgent::new(agent, Arc::clone(&clock))),
    );
    let folder = tempfile::tempdir().map_err(HarnessError::io("temporary folder", "create one"))?;
    let mut watch = Watch::new(folder.path(), products, student.updates_per_cycle);
    trainer.run(&mut watch).map_err(broken)?;
    let costs = watch.costs(&clock, size);
    let memory = memory::measure(student, spec, size.cycles * student.episodes_per_cycle() as u64)?;
    let (batch, layers) = (student.batch(), student.layers(spec));
    Ok(Profile { run: run.key.clone(), batch, layers, size, costs, gflop, memory })
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;
    use std::time::Duration;

    use reports::schema::{Record, Teaching};

    use super::timed::{Clock, TimedAgent, TimedEnv};
    use crate::Registry;
    use crate::config::layer::Layer;
    use crate::protocol::Protocol;
    use crate::protocol::plan::Plan;
    use crate::run::train::{Phase, Trainer, TrainerState, Watcher, Wish};

    /// Keeps what a run says and its last state.
    struct Keep<'a> {
        folder: &'a Path,
        records: Vec<Record>,
        student: Vec<u8>,
    }

    impl Watcher for Keep<'_> {
        fn spent(&mut self, _: Phase, _: Duration) {}

        fn record(&mut self, record: &Record, _: &Teaching) -> std::io::Result<()> {
            self.records.push(record.clone());
            Ok(())
        }

        fn cycle(&mut self, _: u64, evaluated: bool) -> std::io::Result<Wish> {
            Ok(if evaluated { Wish::Save } else { Wish::GoOn })
        }

        fn replay_folder(&self) -> &Path {
            self.folder
        }

        fn save(&mut self, state: TrainerState) -> std::io::Result<()> {
            self.student = state.student().to_vec();
            Ok(())
        }
    }

    /// Records and the final student of a short run, decorated or not.
    fn train(curriculum: &str, decorated: Option<&Arc<Clock>>) -> (Vec<Record>, Vec<u8>) {
        agents::prepare_thread();
        let registry = Registry::builtin();
        let mut protocol = Protocol::from_options();
        protocol.environments = vec!["Point".into()];
        protocol.curricula = vec![curriculum.into()];
        for set in
            ["budget.steps=120", "evaluation.every=80", "student.width=8", "student.batch=16", "pool.size=9"]
        {
            protocol.set(Layer::from_set(set).expect("path=value"));
        }
        let run = Plan::new(&protocol, &registry).expect("a plan").runs.remove(0);
        let mut trainer = Trainer::new(&registry, run.key, run.config).expect("a trainer");
        if let Some(clock) = decorated {
            trainer = trainer.decorated(
                |env| Box::new(TimedEnv::new(env, Arc::clone(clock))),
                |agent| Box::new(TimedAgent::new(agent, Arc::clone(clock))),
            );
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut keep = Keep { folder: folder.path(), records: Vec::new(), student: Vec::new() };
        trainer.run(&mut keep).expect("a healthy run");
        (keep.records, keep.student)
    }

    /// Teachers that ask the student and the environment for everything there is.
    #[test]
    fn watches_change_nothing_and_all_run() {
        for curriculum in ["vds", "teach"] {
            let clock = Arc::new(Clock::default());
            assert!(train(curriculum, Some(&clock)) == train(curriculum, None), "{curriculum}");
            let sums = [&clock.stepping, &clock.resetting, &clock.acting, &clock.storing, &clock.sampling];
            for (index, sum) in sums.iter().enumerate() {
                assert!(sum.seconds() > 0.0, "sum {index}");
            }
        }
    }
}
