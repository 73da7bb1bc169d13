//! The numbers of each environment, curriculum and variant.

use crate::analysis::cost::Cost;
use crate::analysis::curves::{Curve, DDOF, Point};
use crate::analysis::finals::Finals;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::scores;
use crate::stats::{self, Resampling};
use crate::store::Run;

/// What the tables say about one group. Success rates are shares in [0, 1].
///
/// Numbers are those of the runs that have ended ([`Group::settled`]): finished ones, and failed ones that
/// count 0 from their failure on. A run that has not ended is further behind than its method is, and is mixed
/// with none of these; only where no run has ended yet the numbers are those of all, as far as they got.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupSummary {
    /// Which group.
    pub key: GroupKey,
    /// Seeds with at least one evaluation.
    pub n_seeds: usize,
    /// Those of them whose run used up its budget.
    pub n_finished: usize,
    /// Those of them whose run failed, and counts 0 from its failure on.
    pub n_failed: usize,
    /// Seeds that the numbers are of: `n_finished + n_failed`, or all where that is 0.
    pub n_counted: usize,
    /// Mean over seeds of [`scores::final_score`]; `None` where only untrained students were evaluated.
    pub final_mean: Option<f64>,
    /// Their standard deviation ([`DDOF`]); `None` for one seed.
    pub final_std: Option<f64>,
    /// The mean and the standard deviation without failed runs; `None` where none failed, or none finished.
    pub final_of_finished: Option<(f64, Option<f64>)>,
    /// Mean over seeds of [`scores::final_any_score`]; `None` where a seed has no record of it.
    pub final_any_mean: Option<f64>,
    /// Interquartile mean of the final scores.
    pub final_iqm: Option<f64>,
    /// Bootstrap interval of the interquartile mean; `None` for one seed.
    pub final_ci: Option<(f64, f64)>,
    /// The highest point of the mean curve, the earliest if there are several, among points of all seeds.
    pub best: Option<Point>,
    /// Mean over seeds of [`scores::area_under_curve`].
    pub auc_mean: Option<f64>,
    /// Their standard deviation ([`DDOF`]).
    pub auc_std: Option<f64>,
    /// Median steps to a success rate of 0.5; see [`median_steps`].
    pub steps_to_50: Option<u64>,
    /// Seeds that reached 0.5; the others are censored at their last evaluation.
    pub reached_50: usize,
    /// Median steps to a success rate of 0.8; see [`median_steps`].
    pub steps_to_80: Option<u64>,
    /// Seeds that reached 0.8.
    pub reached_80: usize,
    /// What they took.
    pub cost: Cost,
}

impl GroupSummary {
    /// The numbers of a group; final scores average the last `window` evaluations of a seed.
    pub fn of(group: &Group<'_>, window: usize, resampling: Resampling) -> Option<Self> {
        let finished = group.filtered(Run::is_finished);
        let counted = group.settled();
        let runs = &counted.runs;
        let finals = Finals::of(&counted, window).scores();
        let of_finished = Finals::of(&finished, window).scores();
        let areas: Vec<f64> = runs.iter().filter_map(|run| scores::area_under_curve(&run.records)).collect();
        let times = |threshold: f64| -> Vec<Option<u64>> {
            runs.iter().map(|run| scores::steps_to(&run.records, threshold, window)).collect()
        };
        let (to_50, to_80) = (times(0.5), times(0.8));
        let any: Option<Vec<f64>> =
            runs.iter().map(|run| scores::final_any_score(&run.records, window)).collect();
        let iqm = |strata: &[Vec<f64>]| stats::iqm(&strata[0]);
        let n_failed = counted.failed();
        let with_spread = |scores: &[f64]| Some((stats::mean(scores)?, stats::std_dev(scores, DDOF)));
        Some(Self {
            key: group.key.clone(),
            n_seeds: group.runs.len(),
            n_finished: finished.runs.len(),
            n_failed,
            n_counted: runs.len(),
            final_mean: stats::mean(&finals),
            final_std: stats::std_dev(&finals, DDOF),
            final_of_finished: with_spread(&of_finished).filter(|_| n_failed > 0),
            final_any_mean: any.and_then(|any| stats::mean(&any)),
            final_iqm: stats::iqm(&finals),
            final_ci: stats::stratified_interval(&[&finals], iqm, resampling),
            best: best(&Curve::of(&counted), runs.len()),
            auc_mean: stats::mean(&areas),
            auc_std: stats::std_dev(&areas, DDOF),
            steps_to_50: median_steps(&to_50),
            reached_50: to_50.iter().flatten().count(),
            steps_to_80: median_steps(&to_80),
            reached_80: to_80.iter().flatten().count(),
            cost: Cost::of(if finished.runs.is_empty() { group } else { &finished })?,
        })
    }
}

/// The earliest highest point among those with `n` seeds.
fn best(curve: &Curve, n: usize) -> Option<Point> {
    let complete = curve.points.iter().filter(|point| point.n == n);
    complete.rev().max_by(|a, b| a.mean.total_cmp(&b.mean)).copied()
}

/// The step by which at least half of the seeds had reached a threshold: the lower median of `times`, one
/// entry per seed, `None` for a seed that had not by its last evaluation (censored) and so counts as later
/// than all others; `None` if fewer than half of them did. Where all seeds were trained for equally long this
/// is the Kaplan-Meier median; a seed that was stopped before the others makes it no earlier than that.
pub fn median_steps(times: &[Option<u64>]) -> Option<u64> {
    let mut reached: Vec<u64> = times.iter().flatten().copied().collect();
    reached.sort_unstable();
    let half = times.len().div_ceil(2).max(1);
    reached.get(half - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_steps_by_hand() {
        assert_eq!(median_steps(&[Some(30), None, Some(10)]), Some(30));
        assert_eq!(median_steps(&[Some(30), None, Some(10), Some(20)]), Some(20));
        assert_eq!(median_steps(&[None, None, Some(10), Some(20)]), Some(20));
        assert_eq!(median_steps(&[None, None, Some(10)]), None);
        assert_eq!(median_steps(&[]), None);
    }
}
