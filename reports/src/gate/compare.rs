//! Comparing runs with those of a baseline.
//!
//! Curves that are equal byte for byte need no statistics. Otherwise every group of cells is tested by every
//! metric. The unit is a seed: its score is the mean over the group's cells, which share the seed's initial
//! weights and evaluation episodes and are therefore not independent of each other. Scores of the seeds now
//! are tested against those of the baseline by exact permutation, one-sided for success, and p-values are
//! corrected for all tests by Holm's method. A group fell where p is at most alpha and the fall at least the
//! smallest effect that matters.
//!
//! So of all checks of unchanged code with other seeds at most a share of alpha fails, whatever the
//! distribution of scores: a permutation test is exact, Holm's correction allows for any dependence, and the
//! smallest effect only lets more pass.

use serde::{Deserialize, Serialize};

use super::cells::{Cell, Failure};
use super::error::GateError;
use super::group::{Scope, groups};
use super::metric::{METRICS, Metric};
use crate::stats::{self, Resampling};

/// When a check fails.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Highest share of checks of unchanged code that may fail, in (0, 1): corrected p-values up to it count.
    pub alpha: f64,
    /// Smallest fall of a success rate that matters, and smallest share by which effective goals must move,
    /// in [0, 1].
    pub smallest_effect: f64,
    /// Evaluations at the end of a run that its final success is averaged over, at least 1.
    pub window: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { alpha: 0.02, smallest_effect: 0.05, window: 3 }
    }
}

/// Scores of a group's seeds by one metric, before and now.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Which group.
    pub scope: Scope,
    /// By what it was scored.
    pub metric: Metric,
    /// A score per seed of the baseline.
    pub before: Vec<f64>,
    /// A score per seed of the check.
    pub now: Vec<f64>,
}

/// The test of one group by one metric.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Test {
    /// Which group.
    pub scope: Scope,
    /// By what it was scored.
    #[serde(rename = "measure")]
    pub metric: Metric,
    /// Mean score of the baseline.
    pub before: f64,
    /// Mean score now.
    pub now: f64,
    /// [`Metric::change`] from one to the other.
    pub change: f64,
    /// Bootstrap interval of `now - before` over seeds; for groups that fell or moved only, `null` for a
    /// single seed.
    pub interval: Option<(f64, f64)>,
    /// Exact p-value: one-sided for success, two-sided for effective goals.
    pub p: f64,
    /// The same by Holm's correction for all tests of the check.
    pub p_holm: f64,
    /// Whether the group fell, or for effective goals moved.
    pub failed: bool,
}

/// The outcome of a check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckResult {
    /// When it fails.
    pub settings: Settings,
    /// Seeds of the baseline.
    pub seeds_before: Vec<u64>,
    /// Seeds of the check.
    pub seeds_now: Vec<u64>,
    /// Runs that the baseline has too.
    pub shared: usize,
    /// How many of those are equal, byte for byte.
    pub identical: usize,
    /// Cells with a run that is not.
    pub differing: Vec<String>,
    /// Runs that broke down.
    pub failures: Vec<Failure>,
    /// All tests, the widest groups first.
    pub tests: Vec<Test>,
}

impl CheckResult {
    /// Whether every run is one of the baseline's, byte for byte.
    pub fn is_identical(&self) -> bool {
        self.identical == self.shared && self.seeds_now.iter().all(|seed| self.seeds_before.contains(seed))
    }

    /// The tests that failed.
    pub fn failed(&self) -> impl Iterator<Item = &Test> {
        self.tests.iter().filter(|test| test.failed)
    }

    /// Whether the check passed; if `exact`, only where no curve differs.
    pub fn passed(&self, exact: bool) -> bool {
        let falls = self.failed().next().is_some() || (exact && !self.is_identical());
        self.failures.is_empty() && !falls
    }
}

/// Compares the cells of a check with those of a baseline: the same, in the same order.
///
/// # Panics
/// If the cells are not the same.
pub fn compare(before: &[Cell], now: &[Cell], failures: Vec<Failure>, settings: Settings) -> CheckResult {
    assert!(before.iter().map(Cell::id).eq(now.iter().map(Cell::id)), "cells come in the same order");
    let samples = samples(before, now, settings.window);
    let seeds = |cells: &[Cell]| -> Vec<u64> {
        cells.first().map(|cell| cell.curves.keys().copied().collect()).unwrap_or_default()
    };
    let (seeds_before, seeds_now) = (seeds(before), seeds(now));
    let mut tests = judge(&samples, settings);
    for (test, sample) in tests.iter_mut().zip(&samples).filter(|(test, _)| test.failed) {
        test.interval = interval(sample);
    }
    let mut result = CheckResult {
        settings,
        seeds_before,
        seeds_now,
        shared: 0,
        identical: 0,
        differing: Vec::new(),
        failures,
        tests,
    };
    for (before, now) in before.iter().zip(now) {
        let pairs = now.curves.iter().filter_map(|(seed, curve)| Some((curve, before.curves.get(seed)?)));
        let equal: Vec<bool> = pairs.map(|(now, before)| now.records == before.records).collect();
        result.shared += equal.len();
        result.identical += equal.iter().filter(|equal| **equal).count();
        if equal.contains(&false) {
            result.differing.push(now.id());
        }
    }
    result
}

/// Ways to split the seeds that are still enumerated in a moment.
const MOST_PERMUTATIONS: f64 = 5e6;

/// Refuses numbers of seeds with which no test can fail: that gate would be no gate.
///
/// # Errors
/// [`GateError::TooFewSeeds`] and [`GateError::TooManySeeds`], which say what would do.
pub fn check_seeds(now: usize, before: usize, tests: usize, alpha: f64) -> Result<(), GateError> {
    let splits = stats::permutations(now, before);
    if now == 0 || tests as f64 / splits > alpha {
        return Err(GateError::TooFewSeeds { now, before, tests, splits, alpha });
    }
    if splits > MOST_PERMUTATIONS {
        return Err(GateError::TooManySeeds { now, before, splits });
    }
    Ok(())
}

/// Scores of every group by every metric that it takes.
pub fn samples(before: &[Cell], now: &[Cell], window: usize) -> Vec<Sample> {
    let mut samples = Vec::new();
    for metric in METRICS {
        for group in groups(now).into_iter().filter(|group| group.takes(metric)) {
            let scores = |cells: &[Cell]| scores(cells, &group.cells, metric, window);
            if let (Some(before), Some(now)) = (scores(before), scores(now)) {
                samples.push(Sample { scope: group.scope, metric, before, now });
            }
        }
    }
    samples
}

/// The score of every seed: the mean over the cells of `group`. `None` where a run lacks the metric.
fn scores(cells: &[Cell], group: &[usize], metric: Metric, window: usize) -> Option<Vec<f64>> {
    let of_seed = |seed: &u64| {
        let scores: Option<Vec<f64>> = group
            .iter()
            .map(|&index| metric.of(&cells[index], cells[index].curves.get(seed)?, window))
            .collect();
        stats::mean(&scores?)
    };
    cells[*group.first()?].curves.keys().map(of_seed).collect()
}

/// Tests every sample. Shape: one test per sample.
///
/// # Panics
/// If a sample has no seed on one side.
pub fn judge(samples: &[Sample], settings: Settings) -> Vec<Test> {
    let known = "a sample has seeds on both sides";
    let p = |sample: &Sample| {
        let p = stats::permutation(&sample.now, &sample.before).expect(known);
        if sample.metric.is_success() { p.lower } else { p.either }
    };
    let p_values: Vec<f64> = samples.iter().map(p).collect();
    let test = |((sample, &p), p_holm): ((&Sample, &f64), f64)| {
        let (before, now) =
            (stats::mean(&sample.before).expect(known), stats::mean(&sample.now).expect(known));
        let change = sample.metric.change(before, now);
        let matters = if sample.metric.is_success() { -change } else { change.abs() };
        Test {
            scope: sample.scope.clone(),
            metric: sample.metric,
            before,
            now,
            change,
            interval: None,
            p,
            p_holm,
            failed: p_holm <= settings.alpha && matters >= settings.smallest_effect,
        }
    };
    samples.iter().zip(&p_values).zip(stats::holm(&p_values)).map(test).collect()
}

/// Percentile bootstrap interval (95 %) of the mean now minus the mean before, seeds resampled on each side.
fn interval(sample: &Sample) -> Option<(f64, f64)> {
    let difference = |sides: &[Vec<f64>]| Some(stats::mean(&sides[0])? - stats::mean(&sides[1])?);
    stats::stratified_interval(&[&sample.now, &sample.before], difference, Resampling::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gate::testing::cell;

    const SETTINGS: Settings = Settings { alpha: 0.05, smallest_effect: 0.1, window: 1 };

    #[test]
    fn a_fall_of_every_seed_is_found_by_hand() {
        let before = [cell("A", "x", &[8, 9, 10, 8, 9, 10])];
        let now = [cell("A", "x", &[5, 6, 4])];
        let found = compare(&before, &now, vec![], SETTINGS);
        // One of 84 splits is as low; the area is half the last success, the final success all of it.
        let [area, last] = &found.tests[..] else { panic!("two metrics: {:?}", found.tests) };
        assert_eq!((area.p, area.p_holm, area.failed), (1.0 / 84.0, 2.0 / 84.0, true));
        assert!((area.change + 0.2).abs() < 1e-12 && (last.change + 0.4).abs() < 1e-12);
        let (low, high) = last.interval.expect("several seeds");
        assert!((-0.6..-0.4).contains(&low) && (-0.4..-0.2).contains(&high), "{low} to {high}");
        assert!(!found.passed(false));
    }

    #[test]
    fn small_or_doubtful_falls_pass() {
        let before = [cell("A", "x", &[9, 9, 9, 9, 9, 9])];
        let small = compare(&before, &[cell("A", "x", &[8, 8, 9])], vec![], SETTINGS);
        assert!(small.passed(false) && !small.passed(true), "{:?}", small.tests);
        let better = compare(&before, &[cell("A", "x", &[10, 10, 10])], vec![], SETTINGS);
        assert!(better.passed(false));
        let doubtful = compare(&before, &[cell("A", "x", &[2, 9, 9])], vec![], SETTINGS);
        assert!(doubtful.passed(false), "one seed of three fell: {:?}", doubtful.tests);
    }

    #[test]
    fn cells_are_averaged_seed_by_seed() {
        let cells = [cell("A", "x", &[0, 10]), cell("A", "y", &[10, 5])];
        let all = samples(&cells, &cells, 1);
        let last = all
            .iter()
            .find(|s| s.metric == Metric::FinalSuccess && s.scope.to_string() == "A, all curricula");
        assert_eq!(last.expect("the environment is a group").now, [0.5, 0.75]);
    }

    #[test]
    fn equal_bytes_are_named_identical_and_other_seeds_are_not() {
        let before = [cell("A", "x", &[8, 9, 10, 8, 9, 10])];
        let same = compare(&before, &[cell("A", "x", &[8, 9, 10])], vec![], SETTINGS);
        assert_eq!((same.shared, same.identical, same.is_identical()), (3, 3, true));
        let one = compare(&before, &[cell("A", "x", &[8, 9, 9])], vec![], SETTINGS);
        assert_eq!((one.identical, &one.differing[..]), (2, &["A/x/default".to_owned()][..]));
        assert!(!one.is_identical());
    }

    #[test]
    fn a_run_that_broke_down_fails_the_check() {
        let before = [cell("A", "x", &[8, 9, 10, 8, 9, 10])];
        let failure = Failure { run: "A/x/default/seed-1".into(), reason: "diverged".into() };
        let found = compare(&before, &[cell("A", "x", &[8, 9, 10])], vec![failure], SETTINGS);
        assert!(!found.passed(false));
    }

    #[test]
    fn a_gate_that_cannot_fail_is_refused() {
        let error = check_seeds(2, 4, 6, 0.05).expect_err("1 in 15").to_string();
        assert!(error.contains("no fall can be significant") && error.contains("1 in 15"), "{error}");
        assert!(check_seeds(0, 4, 6, 0.05).is_err());
        assert!(check_seeds(30, 30, 6, 0.05).is_err());
        assert!(check_seeds(5, 12, 90, 0.02).is_ok());
    }

    #[test]
    fn a_teacher_that_spreads_otherwise_is_found_in_both_directions() {
        let teacher = |goals: &[f64]| {
            let mut cell = cell("A", "teach", &vec![5; goals.len()]);
            for (curve, &goals) in cell.curves.values_mut().zip(goals) {
                curve.effective_goals = Some(goals);
            }
            [cell]
        };
        let before = teacher(&[100.0, 101.0, 102.0, 103.0, 104.0, 105.0]);
        for now in [[150.0, 151.0, 152.0], [50.0, 51.0, 52.0]] {
            let settings = Settings { alpha: 0.1, ..SETTINGS };
            let found = compare(&before, &teacher(&now), vec![], settings);
            let failed: Vec<Metric> = found.failed().map(|test| test.metric).collect();
            assert_eq!(failed, [Metric::EffectiveGoals], "{now:?}");
        }
    }
}
