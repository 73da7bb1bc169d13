//! Measuring how fast runs are: a few cycles each, alone or in lockstep, in a process of their own.

use std::panic::resume_unwind;
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use rayon::ThreadPool;
use reports::schema::{Manifest, RunKey};
use serde::{Deserialize, Serialize};

use super::Speed;
use crate::Registry;
use crate::config::RunConfig;
use crate::config::frontier::FrontierOptions;
use crate::error::{HarnessError, ManifestError, chain};
use crate::run::cohort::{Means, Observed};
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

/// A kind of cohort to be measured, a JSON line on the process' standard input.
#[derive(Serialize, Deserialize)]
pub(super) struct Subject {
    /// Which of the kinds it is.
    pub(super) index: usize,
    /// The runs of such a cohort, at least one.
    pub(super) manifests: Vec<Manifest>,
}

/// What was measured, a JSON line each on its standard output.
#[derive(Serialize, Deserialize)]
pub(super) struct Measurement {
    /// Which of the kinds it is.
    pub(super) index: usize,
    /// Its speed, or why it cannot be measured.
    pub(super) speed: Result<Speed, String>,
}

/// What `goalbench measure-runs` does: measures the kinds that its standard input names, `parallel` at a
/// time, each on up to `threads` threads, and in their order, as a sweep would run them.
///
/// # Errors
/// [`HarnessError::System`] if nobody asks or listens.
pub fn measure_runs(registry: &Registry, parallel: usize, threads: usize) -> Result<ExitCode, HarnessError> {
    errand::end_with_asker()?;
    let subjects: Vec<Subject> = errand::questions().collect::<Result<_, _>>()?;
    // In order: the first are the ones that must not be missing. No thread of a pool hands them out: while
    // one waits for another pool, it would begin with the next.
    let next = Mutex::new(subjects.into_iter());
    let answers = || {
        loop {
            let subject = next.lock().expect("no holder of this lock panics").next();
            let Some(Subject { index, manifests }) = subject else { return Ok(()) };
            let pool = pool(threads.min(manifests.len()))?;
            errand::answer(&Measurement { index, speed: speed(registry, &manifests, &pool) })?;
        }
    };
    thread::scope(|scope| {
        let started: Vec<_> = (0..parallel).map(|_| scope.spawn(answers)).collect();
        let ended =
            started.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
        ended.collect::<Result<(), HarnessError>>().map(|()| ExitCode::Success)
    })
}

fn pool(threads: usize) -> Result<ThreadPool, HarnessError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .start_handler(|_| agents::prepare_thread())
        .build()
        .map_err(HarnessError::system("start the threads that measure runs"))
}

fn speed(registry: &Registry, manifests: &[Manifest], pool: &ThreadPool) -> Result<Speed, String> {
    let [Manifest { run, .. }, ..] = manifests else { unreachable!("a cohort has a run") };
    let action = "be measured";
    let runs: Result<Vec<_>, ManifestError> =
        manifests.iter().map(|manifest| Ok((manifest.run.clone(), manifest::config(manifest)?))).collect();
    let measured = runs
        .map_err(HarnessError::impossible(run, action))
        .and_then(|runs| measure(registry, runs, pool).map_err(HarnessError::impossible(run, action)));
    measured.map_err(|error| chain(&error))
}

fn measure(
    registry: &Registry,
    runs: Vec<(RunKey, RunConfig)>,
    pool: &ThreadPool,
) -> Result<Speed, RunError> {
    let (key, config) = &runs[0];
    let entry = registry.environment(&key.environment).expect("a plan only holds known names");
    let cycle = config.student.episodes_per_cycle() as u64 * entry.spec.horizon as u64;
    let updates = config.student.updates_per_cycle;
    let fewer = UPDATES.min(updates);
    let lanes: Vec<Observed<Stopwatch>> = runs
        .into_iter()
        .map(|(key, mut config)| {
            config.budget.steps = CYCLES * cycle;
            config.evaluation.every = config.budget.steps;
            config.evaluation.episodes = EPISODES;
            // Its episodes cost what those of evaluations do.
            config.frontier = FrontierOptions::default();
            // Nothing is learned in the warm-up, which is soon over; learning is what takes time.
            config.student.warmup_episodes = 0;
            config.student.updates_per_cycle = fewer;
            // A teacher may ask for more rollouts than there are steps here; that no step is one errs on the
            // safe side, for nobody learns in them.
            let trainer = Trainer::new(registry, key, config)?.without_rollouts();
            Ok(Observed { trainer, observer: Stopwatch::default() })
        })
        .collect::<Result<_, RunError>>()?;
    let (width, steps) = (lanes.len(), (CYCLES - 1) * cycle * lanes.len() as u64);
    let watches = Observed::train(lanes, Means { pool: Some(pool), width, turns: None })?;
    let sum = |of: fn(&Stopwatch) -> Duration| watches.iter().map(of).sum::<Duration>().as_secs_f64();
    // The end of a cycle is that of its last lane; what lanes do side by side takes a thread's share of the
    // clock. A lane's learning is its share already.
    let end = |cycle: usize| watches.iter().map(|watch| watch.cycles[cycle]).max().expect("there is a lane");
    let at_once = pool.current_num_threads() as f64;
    let clock = (end(CYCLES as usize - 1) - end(0)).as_secs_f64();
    let learning = sum(|watch| watch.learning);
    let rest = clock - sum(|watch| watch.evaluation_meanwhile) / at_once - learning;
    let episodes = watches.iter().map(|watch| watch.evaluations).sum::<u64>() * EPISODES;
    Ok(Speed {
        per_step: (rest + learning * updates as f64 / fewer as f64) / steps as f64,
        per_episode: sum(|watch| watch.evaluation) / at_once / episodes as f64,
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
