//! Whether what teachers believe of the goals of their pools is true: estimates of success beside measured
//! success, and scores beside the change of it.

pub mod estimate;
pub mod progress;

use std::sync::Arc;

use crate::analysis::catalogue::MethodInfo;
use crate::analysis::frontier::FrontierFiles;
use crate::analysis::group::Group;
use crate::analysis::heat::third;
use crate::analysis::shadow::ShadowFiles;
use crate::analysis::shadow::agreement::MeanStd;
use crate::analysis::whole::Analysis;
use crate::schema::Beliefs;
use crate::stats::{self, Ddof};
use crate::store::Run;

/// Bins of estimates of equal width.
pub const BINS: usize = 10;

/// What a teacher believed at a measure of its student, and what was true.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// The evaluation beside which it was measured, and the training steps until then.
    pub eval_index: u64,
    /// Training steps so far.
    pub step: u64,
    /// The third of the run that it belongs to.
    pub third: usize,
    /// Measured success at every goal, `[N]`.
    pub success: Vec<f64>,
    /// The teacher's estimate of it, `[N]`; `None` of a teacher without one.
    pub estimates: Option<Vec<f64>>,
    /// The teacher's score of every goal, `[N]`; `None` likewise.
    pub scores: Option<Vec<f64>>,
}

impl Judged {
    /// How far the estimates hold, by bin; `None` without any.
    pub fn reliability(&self) -> Option<Vec<stats::ReliabilityBin>> {
        Some(stats::reliability(self.estimates.as_deref()?, &self.success, BINS))
    }

    /// Rank correlation of estimates and success; `None` where one of them makes no difference.
    pub fn rank_correlation(&self) -> Option<f64> {
        stats::spearman(self.estimates.as_deref()?, &self.success)
    }
}

/// What the teacher in this place, the one that acted or one that watched, believed at each measure of
/// `run`, by rising evaluation; all measures, those of the untrained student and those without a belief too.
pub fn of_teacher(run: &Run, frontier: &FrontierFiles, shadow: &ShadowFiles, place: usize) -> Vec<Judged> {
    let end = run.records.last().map_or(0, |record| record.step);
    let watched = shadow.of_run(run);
    let widened = |values: &Vec<f32>| values.iter().map(|&value| f64::from(value)).collect::<Vec<f64>>();
    let measures = frontier.of_run(run).iter();
    let judged = measures.map(|measure| {
        let of_shadow = || watched?.measured.get(&measure.eval_index)?.get(place)?.beliefs.as_ref();
        let beliefs = if place == 0 { measure.beliefs.as_ref() } else { of_shadow() };
        let told = |of: fn(&Beliefs) -> Option<&Vec<f32>>| {
            let values = beliefs.and_then(of).filter(|values| values.len() == measure.successes.len());
            values.map(widened)
        };
        Judged {
            eval_index: measure.eval_index,
            step: measure.step,
            third: third(measure.step, end),
            success: measure.rates(),
            estimates: told(|beliefs| beliefs.success.as_ref()),
            scores: told(|beliefs| beliefs.scores.as_ref()),
        }
    });
    judged.collect()
}

/// The teachers of a group's runs in their places: the one that acted first, then those that watched.
pub fn teachers(group: &Group<'_>, analysis: &Analysis<'_>) -> Vec<Arc<MethodInfo>> {
    let watched = group.runs.iter().find_map(|run| analysis.shadow.of_run(run));
    let shadows = watched.map_or(&[][..], |watched| &watched.teachers[1..]);
    let of_catalogue = |id: &String| analysis.catalogue().method(id);
    [Arc::clone(&group.key.curriculum)].into_iter().chain(shadows.iter().map(of_catalogue)).collect()
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
        let both = |of: &dyn Fn(&ByThird) -> Option<f64>| {
            let values: Vec<f64> = runs.iter().filter_map(of).collect();
            (stats::mean(&values), stats::std_dev(&values, Ddof::Sample))
        };
        Self {
            n_seeds: runs.iter().filter(|run| run.all.is_some()).count(),
            all: both(&|run| run.all),
            thirds: [0, 1, 2].map(|third| both(&|run| run.thirds[third])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
