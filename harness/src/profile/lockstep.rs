//! A cohort's speed beside that of a run alone, and where its clock goes.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use reports::schema::RunKey;
use reports::wording::{counted, counted_u64};
use serde::Serialize;
use serde_json::{Value, json};

use crate::Registry;
use crate::config::frontier::FrontierOptions;
use crate::error::HarnessError;
use crate::protocol::plan::PlannedRun;
use crate::run::cohort::{Means, Observed};
use crate::run::error::RunError;
use crate::run::observer::{Observer, Stage, StageTimes};
use crate::run::train::Trainer;

/// Seconds of the clock per training step of any lane. What lanes do side by side counts as a thread's share
/// of the clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LockstepCosts {
    /// Steps and resets of the environments.
    pub physics: f64,
    /// Exploring actions, and taking in episodes.
    pub acting: f64,
    /// Drawing and relabelling batches.
    pub drawing: f64,
    /// The rest of the students' learning.
    pub learning: f64,
    /// Teachers.
    pub teachers: f64,
    /// Evaluations of whole runs.
    pub evaluating: f64,
    /// Waiting for the slowest lane, and everything else.
    pub rest: f64,
}

impl LockstepCosts {
    /// The parts in the order in which they are shown, with what they are.
    fn parts(&self) -> [(&'static str, f64, &'static str); 7] {
        [
            ("physics", self.physics, "steps and resets of the environments"),
            ("acting", self.acting, "exploring actions, episodes into replay and normalisers"),
            ("drawing", self.drawing, "batches from replay, relabelled"),
            ("learning", self.learning, "the rest of the updates"),
            ("teachers", self.teachers, "proposing, observing, learning"),
            ("evaluating", self.evaluating, "greedy episodes"),
            ("rest", self.rest, "waiting for the slowest lane, and the loop"),
        ]
    }

    /// Seconds of the clock per training step, all in all.
    fn total(&self) -> f64 {
        self.parts().iter().map(|(_, seconds, _)| seconds).sum()
    }

    /// The mean of several.
    fn mean(all: &[Self]) -> Self {
        let of = |field: fn(&Self) -> f64| all.iter().map(field).sum::<f64>() / all.len() as f64;
        Self {
            physics: of(|costs| costs.physics),
            acting: of(|costs| costs.acting),
            drawing: of(|costs| costs.drawing),
            learning: of(|costs| costs.learning),
            teachers: of(|costs| costs.teachers),
            evaluating: of(|costs| costs.evaluating),
            rest: of(|costs| costs.rest),
        }
    }
}

/// A cohort beside a run alone, a measurement of each per round.
#[derive(Clone, Debug, PartialEq)]
pub struct Lockstep {
    /// Lane 0; the others have the next seeds.
    pub run: RunKey,
    /// Runs in lockstep.
    pub lanes: usize,
    /// Threads that they share.
    pub threads: usize,
    /// Cycles of every measurement.
    pub cycles: u64,
    /// Of the run alone, on one thread.
    pub alone: Vec<LockstepCosts>,
    /// Of the cohort.
    pub together: Vec<LockstepCosts>,
}

impl Lockstep {
    /// Speed of the cohort over that of the run alone, round by round. The two of a round are measured one
    /// right after the other, so that other work on the machine slows both alike.
    fn gains(&self) -> Vec<f64> {
        self.alone
            .iter()
            .zip(&self.together)
            .map(|(alone, together)| alone.total() / together.total())
            .collect()
    }

    /// The median of the rounds' gains.
    pub fn gain(&self) -> f64 {
        reports::stats::median(&self.gains()).expect("at least one round")
    }

    /// All numbers; times in seconds.
    pub fn as_json(&self) -> Value {
        let side = |all: &[LockstepCosts]| {
            let mean = LockstepCosts::mean(all);
            let shares =
                mean.parts().map(|(name, seconds, _)| (name.to_owned(), json!(seconds / mean.total())));
            json!({
                "clock_seconds_per_step": mean,
                "shares": Value::Object(shares.into_iter().collect()),
                "steps_per_second": all.iter().map(|costs| 1.0 / costs.total()).collect::<Vec<_>>(),
            })
        };
        json!({
            "run": self.run,
            "lanes": self.lanes,
            "threads": self.threads,
            "cycles": self.cycles,
            "alone": side(&self.alone),
            "lockstep": side(&self.together),
            "gain": self.gain(),
            "gain_per_thread": self.gain() / self.threads as f64,
        })
    }

    /// Tables for people.
    pub fn as_text(&self) -> String {
        let Self { run, lanes, threads, cycles, .. } = self;
        let mut text = format!(
            "{run}: {} in lockstep on {}, beside a run alone; {} each\n\n\
             µs of the clock per training step, mean of the rounds\n\
             {:<12}{:>18}{:>18}\n",
            counted(*lanes, "run"),
            counted(*threads, "thread"),
            counted_u64(*cycles, "cycle"),
            "",
            "alone",
            "in lockstep"
        );
        let [alone, together] = [&self.alone, &self.together].map(|all| LockstepCosts::mean(all));
        let with_share =
            |seconds: f64, total: f64| format!("{:.1} {:5.1} %", 1e6 * seconds, 100.0 * seconds / total);
        for ((name, one, about), (_, other, _)) in alone.parts().into_iter().zip(together.parts()) {
            let (one, other) = (with_share(one, alone.total()), with_share(other, together.total()));
            let _ = writeln!(text, "{name:<12}{one:>18}{other:>18}  {about}");
        }
        let _ = writeln!(text, "\ntraining steps/s    alone  lockstep   gain");
        let speeds = self.alone.iter().zip(&self.together).zip(self.gains());
        for (round, ((alone, together), gain)) in speeds.enumerate() {
            let (alone, together) = (1.0 / alone.total(), 1.0 / together.total());
            let _ = writeln!(text, "round {:<12} {alone:>7.1} {together:>9.1} {gain:>6.2}", round + 1);
        }
        let _ = writeln!(
            text,
            "\n{lanes} runs in lockstep are {:.3} times as fast as one, {:.3} times per thread (median of the rounds)\n\
             One evaluation is counted for every evaluation.every steps; checkpoints are left out.",
            self.gain(),
            self.gain() / *threads as f64
        );
        text
    }
}

/// Trains `run` alone and `lanes` runs of it, with the seeds from its own on, in lockstep on as many threads
/// as there are cores for them: both for `cycles` cycles in each of `rounds` rounds, whatever their budget.
///
/// # Errors
/// [`HarnessError::Impossible`] if a run breaks down, [`HarnessError::System`] if there are no threads.
///
/// # Panics
/// If `registry` lacks the run's environment or curriculum: plans only hold known ones.
pub fn lockstep(
    registry: &Registry,
    run: &PlannedRun,
    lanes: usize,
    cycles: u64,
    rounds: u16,
) -> Result<Lockstep, HarnessError> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(lanes);
    let (mut alone, mut together) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        alone.push(measure(registry, run, [1, 1], cycles)?);
        together.push(measure(registry, run, [lanes, threads], cycles)?);
    }
    Ok(Lockstep { run: run.key.clone(), lanes, threads, cycles, alone, together })
}

fn measure(
    registry: &Registry,
    run: &PlannedRun,
    [lanes, threads]: [usize; 2],
    cycles: u64,
) -> Result<LockstepCosts, HarnessError> {
    let broken = |error: RunError| HarnessError::impossible(&run.key, "be profiled")(error);
    let spec = &registry.environment(&run.key.environment).expect("a plan only holds known names").spec;
    let cycle = (run.config.student.episodes_per_cycle() * spec.horizon) as u64;
    let mut config = run.config.clone();
    // The first cycle warms up; after the last one comes an evaluation, as before the first.
    config.budget.steps = (cycles + 2) * cycle;
    config.evaluation.every = config.budget.steps;
    config.frontier = FrontierOptions::default();
    // Nothing is learned in a warm-up; what is measured here comes after it.
    config.student.warmup_episodes = 0;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .start_handler(|_| agents::prepare_thread())
        .build()
        .map_err(HarnessError::system("start the threads of a cohort"))?;
    let lane = |index: u64| {
        let key = RunKey { seed: run.key.seed + index, ..run.key.clone() };
        let trainer = Trainer::new(registry, key, config.clone())?.without_rollouts();
        Ok(Observed { trainer, observer: LaneWatch { cycles, ..LaneWatch::default() } })
    };
    let lanes: Vec<Observed<LaneWatch>> =
        (0..lanes as u64).map(lane).collect::<Result<_, RunError>>().map_err(broken)?;
    let (width, steps) = (lanes.len(), cycles * cycle * lanes.len() as u64);
    let means = Means { pool: Some(&pool), width, turns: None };
    let watches = Observed::train(lanes, means).map_err(broken)?;
    Ok(costs(&watches, steps as f64, threads as f64, run.config.evaluation.every as f64))
}

/// What `steps` training steps of all lanes took, on `threads` threads, with an evaluation of each lane for
/// every `every` of its steps.
fn costs(watches: &[LaneWatch], steps: f64, threads: f64, every: f64) -> LockstepCosts {
    let of_lanes = |stage: Stage| {
        watches.iter().map(|watch| watch.at[1].seconds(stage) - watch.at[0].seconds(stage)).sum::<f64>()
    };
    let side_by_side = |stages: &[Stage]| stages.iter().map(|&stage| of_lanes(stage)).sum::<f64>() / threads;
    // The end of a cycle is that of its last lane.
    let end = |mark: usize| watches.iter().filter_map(|watch| watch.ends[mark]).max();
    let clock = end(1).zip(end(0)).map_or(0.0, |(last, first)| (last - first).as_secs_f64());
    let drawing = side_by_side(&[Stage::Sampling]);
    let mut costs = LockstepCosts {
        physics: side_by_side(&[Stage::Stepping, Stage::Resetting]),
        acting: side_by_side(&[Stage::Acting, Stage::Storing]),
        drawing,
        // Lanes are told shares of the clock, not of a thread.
        learning: of_lanes(Stage::Learning) - drawing,
        teachers: side_by_side(&[Stage::Teaching, Stage::Probing]),
        evaluating: 0.0,
        rest: 0.0,
    };
    costs.rest = clock - costs.total();
    let evaluating: f64 = watches.iter().map(|watch| watch.evaluating.as_secs_f64()).sum();
    let evaluations: u32 = watches.iter().map(|watch| watch.evaluations).sum();
    let per_step = |seconds: f64| seconds / steps;
    LockstepCosts {
        physics: per_step(costs.physics),
        acting: per_step(costs.acting),
        drawing: per_step(costs.drawing),
        learning: per_step(costs.learning),
        teachers: per_step(costs.teachers),
        evaluating: evaluating / f64::from(evaluations) / threads / every,
        rest: per_step(costs.rest),
    }
}

/// Takes a lane's times after its first cycle and after so many more.
#[derive(Clone, Debug, Default)]
struct LaneWatch {
    cycles: u64,
    ended: u64,
    times: StageTimes,
    at: [StageTimes; 2],
    ends: [Option<Instant>; 2],
    evaluating: Duration,
    evaluations: u32,
}

impl Observer for LaneWatch {
    fn spent(&mut self, stage: Stage, time: Duration) {
        self.times.spent(stage, time);
        if stage == Stage::Evaluating {
            self.evaluating += time;
            self.evaluations += 1;
        }
    }

    fn cycle(&mut self, _: u64) -> std::io::Result<()> {
        self.ended += 1;
        let marks = [1, 1 + self.cycles];
        if let Some(mark) = marks.iter().position(|&mark| mark == self.ended) {
            self.at[mark] = self.times;
            self.ends[mark] = Some(Instant::now());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two lanes on two threads, 100 steps each, of which the clock took 4 s.
    #[test]
    fn what_is_done_side_by_side_takes_its_share_of_the_clock() {
        let begun = Instant::now();
        let lane = |seconds: u64| {
            let mut watch = LaneWatch { cycles: 2, ..LaneWatch::default() };
            watch.spent(Stage::Evaluating, Duration::from_secs(10));
            watch.spent(Stage::Stepping, Duration::from_secs(50));
            watch.cycle(50).expect("it only notes");
            watch.spent(Stage::Stepping, Duration::from_secs(seconds));
            watch.spent(Stage::Learning, Duration::from_millis(500));
            watch.spent(Stage::Sampling, Duration::from_millis(250));
            watch.cycle(100).expect("it only notes");
            watch.cycle(150).expect("it only notes");
            watch.spent(Stage::Stepping, Duration::from_secs(50));
            watch.ends = [Some(begun), Some(begun + Duration::from_secs(seconds))];
            watch
        };
        let costs = costs(&[lane(1), lane(4)], 200.0, 2.0, 1000.0);
        let expected = LockstepCosts {
            physics: 2.5 / 200.0,
            acting: 0.0,
            drawing: 0.25 / 200.0,
            learning: 0.75 / 200.0,
            teachers: 0.0,
            evaluating: 0.005,
            rest: 0.5 / 200.0,
        };
        for ((name, found, _), (_, expected, _)) in costs.parts().into_iter().zip(expected.parts()) {
            assert!((found - expected).abs() < 1e-12, "{name}: {found}, not {expected}");
        }
    }

    #[test]
    fn rounds_are_compared_one_by_one() {
        let costs = |physics: f64| LockstepCosts { physics, ..LockstepCosts::default() };
        let run = RunKey {
            environment: "MazeA".into(),
            curriculum: "teach".into(),
            variant: "default".into(),
            seed: 0,
        };
        let found = Lockstep {
            run,
            lanes: 4,
            threads: 2,
            cycles: 3,
            alone: vec![costs(0.01), costs(0.04), costs(0.01)],
            together: vec![costs(0.005), costs(0.02), costs(0.01)],
        };
        assert!((found.gain() - 2.0).abs() < 1e-12);
        let json = found.as_json();
        assert!((json["gain_per_thread"].as_f64().expect("a number") - 1.0).abs() < 1e-12);
        assert!((json["lockstep"]["shares"]["physics"].as_f64().expect("a share") - 1.0).abs() < 1e-12);
        let text = found.as_text();
        for part in ["4 runs in lockstep on 2 threads", "2.000 times as fast as one, 1.000 times per thread"]
        {
            assert!(text.contains(part), "{text}");
        }
    }
}
