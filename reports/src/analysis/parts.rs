//! Which part of its training something in a run belongs to, and numbers by part.

use crate::schema::Teaching;
use crate::stats::{self, Ddof};
use crate::store::Run;

/// Thirds of training.
pub const PHASES: [&str; 3] = ["early", "middle", "late"];

/// The training steps that the thirds of a run are thirds of: its budget, however far it came. Of a run whose
/// config names none, as of made-up ones, the step of its last evaluation.
pub fn budget(run: &Run) -> u64 {
    let last = || run.records.last().map(|record| record.step);
    run.manifest.budget().or_else(last).unwrap_or(0)
}

/// The third of a run of `budget` steps that `step` belongs to; what happened at a border belongs to what
/// came before. The last cycle may go beyond the budget.
pub fn third_of(step: u64, budget: u64) -> usize {
    slice_of(step, budget, PHASES.len())
}

/// Which of `count` slices of `end` steps something belongs to that happened, or ended, at `step`.
pub fn slice_of(step: u64, end: u64, count: usize) -> usize {
    let slice = u128::from(step.saturating_sub(1)) * count as u128 / u128::from(end.max(1));
    (slice as usize).min(count - 1)
}

/// The step at which an episode of `line` ended. A line holds all episodes since the one before it, which
/// ended at step `before`; they are taken to be equally long.
pub fn episode_end(line: &Teaching, before: u64, index: usize) -> u64 {
    let length = line.step.saturating_sub(before);
    before + length * (index as u64 + 1) / line.goals.len().max(1) as u64
}

/// A number over all measures of a run, and over those of each third.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ByThird {
    /// Over all of them; `None` where it is never defined.
    pub all: Option<f64>,
    /// Over those of each third, likewise.
    pub thirds: [Option<f64>; 3],
}

impl ByThird {
    /// Means of the `values` of measures, each with its third.
    pub fn means(values: &[(usize, f64)]) -> Self {
        let over = |belongs: &dyn Fn(usize) -> bool| {
            let chosen = values.iter().filter(|(third, _)| belongs(*third)).map(|(_, value)| *value);
            stats::mean(&chosen.collect::<Vec<_>>())
        };
        Self { all: over(&|_| true), thirds: [0, 1, 2].map(|third| over(&|own| own == third)) }
    }
}

/// A mean over seeds and its standard deviation; `None` for none, and for fewer than two.
pub type MeanStd = (Option<f64>, Option<f64>);

/// Of the `values` of seeds that have one.
pub fn mean_std(values: impl IntoIterator<Item = Option<f64>>) -> MeanStd {
    let values: Vec<f64> = values.into_iter().flatten().collect();
    (stats::mean(&values), stats::std_dev(&values, Ddof::Sample))
}

/// [`ByThird`] over seeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ByThirdMeans {
    /// Runs that have one.
    pub n_seeds: usize,
    /// Mean and standard deviation over them.
    pub all: MeanStd,
    /// The same of each third, over the runs that have one there.
    pub thirds: [MeanStd; 3],
}

impl ByThirdMeans {
    /// Over these runs.
    pub fn of(runs: &[ByThird]) -> Self {
        Self {
            n_seeds: runs.iter().filter(|run| run.all.is_some()).count(),
            all: mean_std(runs.iter().map(|run| run.all)),
            thirds: [0, 1, 2].map(|third| mean_std(runs.iter().map(|run| run.thirds[third]))),
        }
    }

    /// Over all of a run (0), or over one of its thirds.
    pub fn part(&self, part: usize) -> MeanStd {
        if part == 0 { self.all } else { self.thirds[part - 1] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::Outcome;
    use crate::testing::{self, records};

    #[test]
    fn thirds_by_hand() {
        assert_eq!([0, 1, 30, 31, 60, 61, 90, 95].map(|step| third_of(step, 90)), [0, 0, 0, 1, 1, 2, 2, 2]);
        assert_eq!([1, 25, 26, 50, 51, 100, 120].map(|step| slice_of(step, 100, 4)), [0, 0, 1, 1, 2, 3, 3]);
    }

    /// Everything that it measured before it failed lies in the first third.
    #[test]
    fn thirds_of_a_run_that_failed_are_those_of_its_budget() {
        let mut run = testing::run("default", 0, &[], Outcome::Failed { step: 20_000, reason: "NaN".into() });
        run.records = records(&[0, 6_000, 12_000, 18_000].map(|step| (step, 0.5)));
        run.manifest.config = serde_json::json!({ "budget": { "steps": 60_000 } });
        assert_eq!([6_000, 12_000, 18_000].map(|step| third_of(step, budget(&run))), [0; 3]);
        run.manifest.config = serde_json::Value::Null;
        assert_eq!(budget(&run), 18_000);
    }

    #[test]
    fn episodes_of_a_line_are_equally_long() {
        let line = Teaching { step: 100, goals: vec![vec![]; 3], ..Teaching::default() };
        assert_eq!([0, 1, 2].map(|index| episode_end(&line, 0, index)), [33, 66, 100]);
        assert_eq!([0, 2].map(|index| episode_end(&line, 70, index)), [80, 100]);
    }

    #[test]
    fn thirds_and_seeds_by_hand() {
        let run = ByThird::means(&[(0, 0.5), (2, 0.1), (2, 0.3)]);
        assert_eq!((run.all, run.thirds), (Some(0.3), [Some(0.5), None, Some(0.2)]));
        let other = ByThird::means(&[(0, 0.1)]);
        let means = ByThirdMeans::of(&[run, ByThird::default(), other]);
        assert_eq!((means.n_seeds, means.all.0), (2, Some(0.2)));
        let deviation = means.all.1.expect("two runs");
        assert!((deviation - 0.2 / f64::sqrt(2.0)).abs() < 1e-12);
        assert_eq!((means.thirds[1], means.thirds[2]), ((None, None), (Some(0.2), None)));
    }
}
