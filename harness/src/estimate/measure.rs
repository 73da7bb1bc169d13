//! Measuring how fast runs are: a few cycles each, in a process of their own.

use std::time::{Duration, Instant};

use rayon::prelude::*;
use reports::schema::{Manifest, RunKey};
use serde::{Deserialize, Serialize};

use super::Speed;
use crate::Registry;
use crate::config::RunConfig;
use crate::config::frontier::FrontierOptions;
use crate::error::{HarnessError, chain};
use crate::run::error::RunError;
use crate::run::manifest;
use crate::run::observer::{Observer, Stage};
use crate::run::train::Trainer;
use crate::sweep::{ExitCode, errand};

/// Cycles that are measured; the first warms up and does not count.
const CYCLES: u64 = 3;
/// Most gradient steps of a measured cycle; their time is scaled to the config's number.
const UPDATES: usize = 8;
/// Episodes of a measured evaluation.
const EPISODES: u64 = 2;

/// A kind of run to be measured, a JSON line on the process' standard input.
#[derive(Serialize, Deserialize)]
pub(super) struct Subject {
    /// Which of the kinds it is.
    pub(super) index: usize,
    /// A run of it.
    pub(super) manifest: Manifest,
}

/// What was measured, a JSON line each on its standard output.
#[derive(Serialize, Deserialize)]
pub(super) struct Measurement {
    /// Which of the kinds it is.
    pub(super) index: usize,
    /// Its speed, or why it cannot be measured.
    pub(super) speed: Result<Speed, String>,
}

/// What `goalbench measure-runs` does: measures the kinds that its standard input names, `parallel` at a time
/// and in their order, as a sweep would run them.
///
/// # Errors
/// [`HarnessError::System`] if nobody asks or listens.
pub fn measure_runs(registry: &Registry, parallel: usize) -> Result<ExitCode, HarnessError> {
    errand::end_with_asker()?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(parallel)
        .start_handler(|_| agents::prepare_thread())
        .build()
        .map_err(HarnessError::system("start a thread per run"))?;
    let subjects: Vec<Subject> = errand::questions().collect::<Result<_, _>>()?;
    // One at a time for each thread: the first are the ones that must not be missing.
    let answers = || {
        subjects.into_par_iter().with_max_len(1).try_for_each(|Subject { index, manifest }| {
            errand::answer(&Measurement { index, speed: speed(registry, manifest) })
        })
    };
    pool.install(answers).map(|()| ExitCode::Success)
}

fn speed(registry: &Registry, manifest: Manifest) -> Result<Speed, String> {
    let run = &manifest.run;
    let action = "be measured";
    let measured =
        manifest::config(&manifest).map_err(HarnessError::impossible(run, action)).and_then(|config| {
            measure(registry, run.clone(), config).map_err(HarnessError::impossible(run, action))
        });
    measured.map_err(|error| chain(&error))
}

fn measure(registry: &Registry, run: RunKey, mut config: RunConfig) -> Result<Speed, RunError> {
    let entry = registry.environment(&run.environment).expect("a plan only holds known names");
    let cycle = config.student.episodes_per_cycle() as u64 * entry.spec.horizon as u64;
    config.budget.steps = CYCLES * cycle;
    config.evaluation.every = config.budget.steps;
    config.evaluation.episodes = EPISODES;
    // Its episodes cost what those of evaluations do.
    config.frontier = FrontierOptions::default();
    // Nothing is learned in the warm-up, which is soon over; learning is what takes time.
    config.student.warmup_episodes = 0;
    let updates = config.student.updates_per_cycle;
    config.student.updates_per_cycle = UPDATES.min(updates);
    let updates = updates as f64 / config.student.updates_per_cycle as f64;
    let mut watch = Stopwatch::default();
    // A teacher may ask for more rollouts than there are steps here; that no step is one errs on the safe
    // side, for nobody learns in them.
    Trainer::new(registry, run, config)?.without_rollouts().run(&mut watch)?;
    let [first, .., last] = watch.cycles[..] else { unreachable!("{CYCLES} cycles were run") };
    let learning = watch.learning.as_secs_f64();
    let rest = (last - first - watch.evaluation_meanwhile).as_secs_f64() - learning;
    Ok(Speed {
        per_step: (rest + learning * updates) / ((CYCLES - 1) * cycle) as f64,
        per_episode: watch.evaluation.as_secs_f64() / (watch.evaluations * EPISODES) as f64,
    })
}

/// Takes the time and keeps nothing.
#[derive(Default)]
struct Stopwatch {
    cycles: Vec<Instant>,
    evaluation: Duration,
    evaluations: u64,
    // After the first cycle:
    evaluation_meanwhile: Duration,
    learning: Duration,
}

impl Observer for Stopwatch {
    fn spent(&mut self, stage: Stage, time: Duration) {
        let warm = !self.cycles.is_empty();
        match stage {
            Stage::Evaluating => {
                self.evaluation += time;
                self.evaluations += 1;
                self.evaluation_meanwhile += if warm { time } else { Duration::ZERO };
            }
            Stage::Learning if warm => self.learning += time,
            _ => {}
        }
    }

    fn cycle(&mut self, _: u64) -> std::io::Result<()> {
        self.cycles.push(Instant::now());
        Ok(())
    }
}
