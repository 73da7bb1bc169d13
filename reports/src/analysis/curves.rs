//! Learning curves: mean and standard deviation over seeds at every evaluated step.

use std::collections::{BTreeMap, HashMap};

use crate::analysis::group::{Group, GroupKey};
use crate::stats::{self, Ddof};

/// Standard deviations over seeds divide by n - 1, in figures and tables: seeds are a sample of all seeds.
pub const DDOF: Ddof = Ddof::Sample;

/// The success rate at one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Training steps taken.
    pub step: u64,
    /// Seeds that were evaluated at this step.
    pub n: usize,
    /// Mean success rate over those seeds, in [0, 1].
    pub mean: f64,
    /// Standard deviation over those seeds ([`DDOF`]); `None` for one seed.
    pub std: Option<f64>,
    /// Mean over those seeds of the student's gradient steps.
    pub gradient_steps: f64,
    /// Mean over those seeds of the hours of wall-clock time, evaluations included; `None` where one has no
    /// timing.
    pub hours: Option<f64>,
}

/// What learning curves are drawn against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Training steps in the environment.
    EnvironmentSteps,
    /// Gradient steps of the student.
    GradientSteps,
    /// Hours of wall-clock time.
    Hours,
}

impl Point {
    /// How far training is here; `None` without timings.
    pub fn at(&self, progress: Progress) -> Option<f64> {
        match progress {
            Progress::EnvironmentSteps => Some(self.step as f64),
            Progress::GradientSteps => Some(self.gradient_steps),
            Progress::Hours => self.hours,
        }
    }
}

/// What the seeds of a group have at one step.
#[derive(Default)]
struct Step {
    rates: Vec<f64>,
    gradient_steps: Vec<f64>,
    hours: Vec<f64>,
}

/// The learning curve of one group.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Which group.
    pub key: GroupKey,
    /// One point per step at which any seed was evaluated, by rising step; never empty.
    pub points: Vec<Point>,
    /// Fewest and most episodes in an evaluation.
    pub episodes: (u64, u64),
}

impl Curve {
    /// The curve of a group. A seed without an evaluation at some step is left out there, which lowers that
    /// point's `n`.
    pub fn of(group: &Group<'_>) -> Self {
        let mut by_step: BTreeMap<u64, Step> = BTreeMap::new();
        let mut episodes = (u64::MAX, 0);
        for run in &group.runs {
            // Looked up, never iterated over.
            let seconds: HashMap<u64, f64> =
                run.timings.iter().map(|timing| (timing.eval_index, timing.wall_s)).collect();
            for record in &run.records {
                let step = by_step.entry(record.step).or_default();
                step.rates.push(record.success_rate);
                step.gradient_steps.push(record.gradient_steps as f64);
                step.hours.extend(seconds.get(&record.eval_index).map(|seconds| seconds / 3600.0));
                episodes = (episodes.0.min(record.episodes), episodes.1.max(record.episodes));
            }
        }
        let points = by_step.into_iter().filter_map(|(step, seeds)| {
            let n = seeds.rates.len();
            Some(Point {
                step,
                n,
                mean: stats::mean(&seeds.rates)?,
                std: stats::std_dev(&seeds.rates, DDOF),
                gradient_steps: stats::mean(&seeds.gradient_steps)?,
                hours: stats::mean(&seeds.hours).filter(|_| seeds.hours.len() == n),
            })
        });
        Self { key: group.key.clone(), points: points.collect(), episodes }
    }

    /// Fewest and most seeds behind a point.
    pub fn seeds(&self) -> (usize, usize) {
        let n = || self.points.iter().map(|point| point.n);
        (n().min().unwrap_or(0), n().max().unwrap_or(0))
    }
}
