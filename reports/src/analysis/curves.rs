//! Learning curves: mean and standard deviation over seeds at every evaluated step.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::complete;
use crate::analysis::cost;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::scores;
use crate::schema::{Record, Timing};
use crate::stats::{self, Ddof};
use crate::store::Run;

/// Standard deviations over seeds divide by n - 1, in figures and tables: seeds are a sample of all seeds.
pub const DDOF: Ddof = Ddof::Sample;

/// The success rate at one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Training steps taken.
    pub step: u64,
    /// Seeds that were evaluated here, or before and after it.
    pub n: usize,
    /// Mean success rate over those seeds, in [0, 1].
    pub mean: f64,
    /// Standard deviation over those seeds ([`DDOF`]); `None` for one seed.
    pub std: Option<f64>,
    /// Mean over those seeds of the student's gradient steps.
    pub gradient_steps: f64,
    /// Mean over those seeds of the steps of probe rollouts that are not charged to the budget.
    pub uncharged_steps: f64,
    /// Mean over those seeds, but the ones that failed before and those with an evaluation without timing, of
    /// the hours of wall-clock time, evaluations included; `None` where none is left.
    pub hours: Option<f64>,
}

/// What learning curves are drawn against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Steps of the budget: training steps in the environment, and charged probe rollouts.
    EnvironmentSteps,
    /// All steps in the environment but those of evaluations: uncharged probe rollouts, too.
    AllSteps,
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
            Progress::AllSteps => Some(self.step as f64 + self.uncharged_steps),
            Progress::GradientSteps => Some(self.gradient_steps),
            Progress::Hours => self.hours,
        }
    }
}

/// The learning curve of one group.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Which group.
    pub key: GroupKey,
    /// One point per step at which most seeds were evaluated, by rising step; never empty.
    pub points: Vec<Point>,
    /// Fewest and most episodes in an evaluation.
    pub episodes: (u64, u64),
    /// Whether some seeds were evaluated at other steps: their rates here lie on the line between two
    /// evaluations.
    pub interpolated: bool,
    /// Seeds that failed, and count 0 from their failure on.
    pub failed: usize,
}

impl Curve {
    /// The curve of a group. A seed without evaluations as far as some step is left out there, which lowers
    /// that point's `n`.
    pub fn of(group: &Group<'_>) -> Self {
        let steps = common_steps(&group.runs);
        let records = || group.runs.iter().flat_map(|run| &run.records);
        let known: BTreeSet<u64> = steps.iter().copied().collect();
        let timed: Vec<bool> = group.runs.iter().map(|run| cost::is_timed(run)).collect();
        Self {
            key: group.key.clone(),
            points: steps.into_iter().filter_map(|step| point(&group.runs, &timed, step)).collect(),
            episodes: (
                records().map(|record| record.episodes).min().unwrap_or(u64::MAX),
                records().map(|record| record.episodes).max().unwrap_or(0),
            ),
            interpolated: records().any(|record| !known.contains(&record.step)),
            failed: group.failed(),
        }
    }

    /// Fewest and most seeds behind a point.
    pub fn seeds(&self) -> (usize, usize) {
        let n = || self.points.iter().map(|point| point.n);
        (n().min().unwrap_or(0), n().max().unwrap_or(0))
    }
}

/// The steps that a curve of `runs` has points at: those of the run that most others agree with as far as
/// they go (of several such runs the one that goes on for longest), then those of the run that goes on for
/// longest, from one more interval on. Runs with other steps would else take turns in the mean, which would
/// then jump to and fro.
fn common_steps(runs: &[&Run]) -> Vec<u64> {
    let mut distinct: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
    for run in runs {
        *distinct.entry(run.records.iter().map(|record| record.step).collect()).or_default() += 1;
    }
    let agreeing = |steps: &[u64]| -> usize {
        distinct.iter().filter(|(other, _)| steps.starts_with(other)).map(|(_, count)| count).sum()
    };
    let rank = |steps: &&Vec<u64>| (agreeing(steps), steps.last().copied(), steps.len());
    let mut common = distinct.keys().max_by_key(rank).cloned().unwrap_or_default();
    // A run whose last evaluation came a little later than those of the others adds no point of its own.
    let beyond = match common[..] {
        [.., before, last] => last + (last - before),
        _ => common.last().map_or(0, |last| last + 1),
    };
    let longest = distinct.keys().max_by_key(|steps| (steps.last().copied(), steps.len()));
    common.extend(longest.into_iter().flatten().filter(|step| **step >= beyond));
    common
}

/// The point of a curve of `runs` at `step`, of which those that are `timed` tell the time; `None` where none
/// of them is there.
fn point(runs: &[&Run], timed: &[bool], step: u64) -> Option<Point> {
    let (mut rates, mut times) = (Vec::new(), Vec::new());
    let (mut gradient_steps, mut uncharged_steps) = (Vec::new(), Vec::new());
    for (run, &timed) in runs.iter().zip(timed) {
        let Some(rate) = scores::rate_at(&run.records, step) else { continue };
        rates.push(rate);
        let taken = |number: fn(&Record) -> u64| {
            let points = run.records.iter().map(|record| (record.step, number(record) as f64));
            scores::value_at(points, step)
        };
        gradient_steps.extend(taken(|record| record.gradient_steps));
        uncharged_steps.extend(taken(|record| record.uncharged_steps));
        if timed && complete::recorded(run).last().is_some_and(|last| step <= last.step) {
            times.extend(hours(run, step));
        }
    }
    Some(Point {
        step,
        n: rates.len(),
        mean: stats::mean(&rates)?,
        std: stats::std_dev(&rates, DDOF),
        gradient_steps: stats::mean(&gradient_steps)?,
        uncharged_steps: stats::mean(&uncharged_steps)?,
        hours: stats::mean(&times),
    })
}

/// Hours of wall-clock time until `step`; `None` where the evaluation there, or those before and after it,
/// have no timing.
fn hours(run: &Run, step: u64) -> Option<f64> {
    let timed = |record: &Record| {
        let is_it = |timing: &&Timing| timing.eval_index == record.eval_index;
        let timing = run.timings.iter().find(is_it)?;
        Some((record.step, timing.wall_s / 3600.0))
    };
    let after = run.records.partition_point(|record| record.step < step);
    let next = run.records.get(after)?;
    let before = &run.records[if next.step == step { after } else { after.checked_sub(1)? }];
    scores::value_at([timed(before)?, timed(next)?].into_iter(), step)
}
