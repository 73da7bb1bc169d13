//! How long a plan would take on this machine: a few cycles of every kind of run, measured now.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::Registry;
use crate::error::HarnessError;
use crate::protocol::plan::PlannedRun;
use crate::run::error::RunError;
use crate::run::observer::{Observer, Stage};
use crate::run::train::Trainer;

/// Cycles that are measured; the first warms up and does not count.
const CYCLES: u64 = 3;
/// Most gradient steps of a measured cycle; their time is scaled to the config's number.
const UPDATES: usize = 8;
/// Episodes of a measured evaluation.
const EPISODES: u64 = 2;

/// What a run takes, on one core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Seconds per training step: physics, student and teacher.
    pub per_step: f64,
    /// Seconds per evaluation episode.
    pub per_episode: f64,
}

impl Speed {
    /// Seconds that a run of `steps` training steps takes, evaluated before it and every `every` steps.
    pub fn of_run(&self, steps: u64, every: u64, episodes: u64) -> f64 {
        let evaluations = 1 + steps.div_ceil(every.max(1));
        self.per_step * steps as f64 + self.per_episode * (evaluations * episodes) as f64
    }
}

/// Which runs are as fast as each other: those of one environment, curriculum and student. A curriculum's own
/// options hardly change what it costs.
type Kind = (String, String, String);

fn kind(run: &PlannedRun) -> Kind {
    let student = serde_json::to_string(&run.config.student).expect("a config is plain data");
    (run.key.environment.clone(), run.key.curriculum.clone(), student)
}

/// Estimates of runs, from the speed of their kinds.
pub struct Estimates(BTreeMap<Kind, Speed>);

impl Estimates {
    /// Number of kinds among `runs`.
    pub fn kinds(runs: &[PlannedRun]) -> usize {
        runs.iter().map(kind).collect::<std::collections::BTreeSet<_>>().len()
    }

    /// Measures every kind among `runs`, `parallel` at a time, as a sweep would run them.
    ///
    /// # Errors
    /// [`HarnessError::Impossible`] naming a run that cannot be carried out here.
    pub fn measure(registry: &Registry, runs: &[PlannedRun], parallel: usize) -> Result<Self, HarnessError> {
        let mut kinds: BTreeMap<Kind, &PlannedRun> = BTreeMap::new();
        for run in runs {
            kinds.entry(kind(run)).or_insert(run);
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(parallel)
            .start_handler(|_| agents::prepare_thread())
            .build()
            .map_err(HarnessError::system("start a thread per run"))?;
        let measured: Result<BTreeMap<_, _>, _> = pool.install(|| {
            let speeds = kinds.into_par_iter().map(|(kind, run)| {
                let speed =
                    measure(registry, run).map_err(HarnessError::impossible(&run.key, "be measured"))?;
                Ok((kind, speed))
            });
            speeds.collect()
        });
        measured.map(Self)
    }

    /// Seconds that `run` takes from its beginning, on one core; `None` if its kind was not measured.
    pub fn seconds(&self, run: &PlannedRun) -> Option<f64> {
        let config = &run.config;
        let speed = self.0.get(&kind(run))?;
        Some(speed.of_run(config.budget.steps, config.evaluation.every, config.evaluation.episodes))
    }
}

fn measure(registry: &Registry, run: &PlannedRun) -> Result<Speed, RunError> {
    let mut config = run.config.clone();
    let entry = registry.environment(&run.key.environment).expect("a plan only holds known names");
    let cycle = config.student.episodes_per_cycle() as u64 * entry.spec.horizon as u64;
    config.budget.steps = CYCLES * cycle;
    config.evaluation.every = config.budget.steps;
    config.evaluation.episodes = EPISODES;
    // Nothing is learned in the warm-up, which is soon over; learning is what takes time.
    config.student.warmup_episodes = 0;
    config.student.updates_per_cycle = UPDATES.min(run.config.student.updates_per_cycle);
    let updates = run.config.student.updates_per_cycle as f64 / config.student.updates_per_cycle as f64;
    let mut watch = Stopwatch::default();
    // A teacher may ask for more rollouts than there are steps here; that no step is one errs on the safe side,
    // for nobody learns in them.
    Trainer::new(registry, run.key.clone(), config)?.without_rollouts().run(&mut watch)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_costs_its_steps_and_its_evaluations() {
        let speed = Speed { per_step: 0.001, per_episode: 0.1 };
        // 1000 steps: 1 s. Evaluated at 0, 300, 600, 900 and at the end, 20 episodes each: 5 · 20 · 0.1 = 10
        // s.
        assert!((speed.of_run(1000, 300, 20) - 11.0).abs() < 1e-12);
        // The last evaluation falls on the end: 0, 500, 1000.
        assert!((speed.of_run(1000, 500, 20) - 7.0).abs() < 1e-12);
    }
}
