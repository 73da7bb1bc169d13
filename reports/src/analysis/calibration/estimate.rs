//! Whether a teacher's estimates of success hold.

use super::{BINS, Judged, of_teacher};
use crate::analysis::group::Group;
use crate::analysis::parts::{ByThird, ByThirdMeans};
use crate::analysis::teachers::GroupTeacher;
use crate::analysis::whole::Analysis;
use crate::stats::{self, Ddof, ReliabilityBin};

/// The bins of one run, or of several.
pub type Bins = [ReliabilityBin; BINS];

/// What the measures of one run say of a teacher's estimates.
#[derive(Clone, Debug, Default, PartialEq)]
struct RunCalibration {
    /// Over all measures after training had begun, then over those of each third.
    bins: [Bins; 4],
    /// Rank correlation of estimates and success, mean over measures.
    correlation: ByThird,
}

impl RunCalibration {
    /// Of these measures; `None` without an estimate after training had begun.
    fn of(measures: &[Judged]) -> Option<Self> {
        let mut run = Self::default();
        let mut correlations = Vec::new();
        for judged in measures.iter().filter(|judged| judged.eval_index > 0) {
            let Some(found) = judged.reliability() else { continue };
            for bins in [0, judged.third + 1] {
                for (bin, found) in run.bins[bins].iter_mut().zip(&found) {
                    *bin = bin.with(found);
                }
            }
            correlations.extend(judged.rank_correlation().map(|value| (judged.third, value)));
        }
        run.correlation = ByThird::means(&correlations);
        run.bins[0].iter().any(|bin| bin.count > 0).then_some(run)
    }

    fn error(&self) -> ByThird {
        let [all, thirds @ ..] = self.bins.each_ref().map(|bins| stats::calibration_error(bins));
        ByThird { all, thirds }
    }

    /// Mean estimate and mean success.
    fn means(&self) -> Option<(f64, f64)> {
        let all = self.bins[0].iter().fold(ReliabilityBin::default(), |sum, bin| sum.with(bin));
        all.estimate().zip(all.outcome())
    }
}

/// A bin over the runs of a group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeedBin {
    /// The estimates of all runs together.
    pub bin: ReliabilityBin,
    /// Runs with an estimate here.
    pub n_seeds: usize,
    /// Standard deviation over these runs of the measured success; `None` for fewer than two.
    pub std: Option<f64>,
}

/// What tables and figures say of one teacher's estimates in one group of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Which teacher, and in which group.
    pub teacher: GroupTeacher,
    /// Runs that count ([`Group::settled`]) with an estimate after training had begun.
    pub n_seeds: usize,
    /// Mean estimate and mean measured success, over the measures of a run, then over runs.
    pub means: (f64, f64),
    /// [`stats::calibration_error`] of each run, and of each third of it.
    pub error: ByThirdMeans,
    /// Rank correlation of estimates and success over the pool, means over measures.
    pub correlation: ByThirdMeans,
    /// Over all of a run, then over each third.
    pub bins: [[SeedBin; BINS]; 4],
}

impl Calibration {
    /// Of every teacher of a group that has estimates.
    pub fn of(group: &Group<'_>, analysis: &Analysis<'_>) -> Vec<Self> {
        let group = group.settled();
        let of_place = |(place, teacher)| {
            let judged = |run| of_teacher(run, &analysis.frontier, &analysis.shadow, place);
            let runs = group.runs.iter().filter_map(|run| RunCalibration::of(&judged(run)));
            Self::over(teacher, &runs.collect::<Vec<_>>())
        };
        GroupTeacher::all(&group, analysis).into_iter().enumerate().filter_map(of_place).collect()
    }

    fn over(teacher: GroupTeacher, runs: &[RunCalibration]) -> Option<Self> {
        let means: Vec<(f64, f64)> = runs.iter().filter_map(RunCalibration::means).collect();
        let (estimates, successes): (Vec<f64>, Vec<f64>) = means.into_iter().unzip();
        let errors: Vec<ByThird> = runs.iter().map(RunCalibration::error).collect();
        let correlations: Vec<ByThird> = runs.iter().map(|run| run.correlation).collect();
        Some(Self {
            teacher,
            n_seeds: runs.len(),
            means: (stats::mean(&estimates)?, stats::mean(&successes)?),
            error: ByThirdMeans::of(&errors),
            correlation: ByThirdMeans::of(&correlations),
            bins: [0, 1, 2, 3].map(|part| {
                std::array::from_fn(|index| {
                    let bins: Vec<ReliabilityBin> = runs.iter().map(|run| run.bins[part][index]).collect();
                    seed_bin(&bins)
                })
            }),
        })
    }
}

fn seed_bin(bins: &[ReliabilityBin]) -> SeedBin {
    let outcomes: Vec<f64> = bins.iter().filter_map(ReliabilityBin::outcome).collect();
    SeedBin {
        bin: bins.iter().fold(ReliabilityBin::default(), |sum, bin| sum.with(bin)),
        n_seeds: outcomes.len(),
        std: stats::std_dev(&outcomes, Ddof::Sample),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::analysis::catalogue::Catalogue;
    use crate::analysis::group::GroupKey;

    fn judged(eval_index: u64, third: usize, estimates: &[f64], success: &[f64]) -> Judged {
        Judged {
            eval_index,
            third,
            success: success.to_vec(),
            estimates: Some(estimates.iter().copied().map(Some).collect()),
            ..Judged::default()
        }
    }

    #[test]
    fn calibration_by_hand() {
        let measures = [
            // Nobody has trained yet.
            judged(0, 0, &[1.0, 1.0], &[0.0, 0.0]),
            judged(1, 0, &[0.25, 0.75], &[0.0, 1.0]),
            judged(2, 2, &[0.25, 0.85], &[0.0, 0.5]),
        ];
        let first = RunCalibration::of(&measures).expect("estimates");
        // Bins of 0.25 (twice, never true), 0.75 and 0.85: (0.5 + 0.25 + 0.35) / 4.
        let error = first.error();
        let close = |found: Option<f64>, expected: f64| {
            assert!((found.expect("defined") - expected).abs() < 1e-12, "{found:?} is not {expected}");
        };
        close(error.all, 0.275);
        close(error.thirds[0], 0.25);
        close(error.thirds[2], 0.3);
        assert_eq!(error.thirds[1], None);
        assert_eq!(first.correlation.all, Some(1.0));
        assert_eq!(RunCalibration::of(&measures[..1]), None);
        // Goals without an estimate count for nothing.
        let mut partly = judged(1, 0, &[0.25, 0.75, 0.0], &[0.0, 1.0, 1.0]);
        partly.estimates.as_mut().expect("estimates")[2] = None;
        close(RunCalibration::of(std::slice::from_ref(&partly)).expect("estimates").error().all, 0.25);
        assert_eq!((partly.rank_correlation(), partly.mean_estimate()), (Some(1.0), Some(0.5)));
        let second = RunCalibration::of(&[judged(1, 1, &[0.25, 0.75], &[0.5, 0.5])]).expect("estimates");
        assert_eq!(second.correlation.all, None, "all goals are alike");

        let key = GroupKey::new(&Catalogue::default(), "E", "nova", "default");
        let teacher = GroupTeacher { method: Arc::clone(&key.curriculum), key };
        let both = Calibration::over(teacher, &[first, second]).expect("two runs");
        assert_eq!((both.n_seeds, both.error.n_seeds, both.correlation.n_seeds), (2, 2, 1));
        close(both.error.all.0, f64::midpoint(0.275, 0.25));
        close(Some(both.means.0), f64::midpoint(0.525, 0.5));
        close(Some(both.means.1), f64::midpoint(0.375, 0.5));
        // Success of 0 in one run and of 0.5 in the other, pooled: 0.5 of three.
        let low = both.bins[0][2];
        assert_eq!((low.bin.count, low.n_seeds), (3, 2));
        close(low.bin.outcome(), 0.5 / 3.0);
        close(low.std, 0.5 / f64::sqrt(2.0));
        assert_eq!((both.bins[3][8].n_seeds, both.bins[3][8].std), (1, None));
        assert!(!both.teacher.is_shadow());
    }
}
