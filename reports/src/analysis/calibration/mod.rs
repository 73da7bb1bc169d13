//! Whether what teachers believe of the goals of their pools is true: estimates of success beside measured
//! success, and scores beside the change of it.

pub mod estimate;
pub mod progress;

use crate::analysis::frontier::FrontierFiles;
use crate::analysis::parts::{budget, third_of};
use crate::analysis::shadow::ShadowFiles;
use crate::analysis::teachers::{Testimony, known};
use crate::stats;
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
    /// The teacher's estimate of it, `[N]`; `None` where it has none.
    pub estimates: Option<Vec<Option<f64>>>,
    /// The teacher's score of every goal, `[N]`; `None` likewise.
    pub scores: Option<Vec<Option<f64>>>,
}

impl Judged {
    /// The estimates that there are, and success at the same goals; `None` of a teacher without any.
    fn estimated(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        Some(known(self.estimates.as_deref()?, &self.success))
    }

    /// Mean of the estimates.
    pub fn mean_estimate(&self) -> Option<f64> {
        stats::mean(&self.estimated()?.0)
    }

    /// How far the estimates hold, by bin; `None` without any.
    pub fn reliability(&self) -> Option<Vec<stats::ReliabilityBin>> {
        let (estimates, success) = self.estimated()?;
        Some(stats::reliability(&estimates, &success, BINS))
    }

    /// Rank correlation of estimates and success, over the goals with an estimate; `None` where one of them
    /// makes no difference.
    pub fn rank_correlation(&self) -> Option<f64> {
        let (estimates, success) = self.estimated()?;
        stats::spearman(&estimates, &success)
    }
}

/// What the teacher in this place, the one that acted or one that watched, believed at each measure of
/// `run`, by rising evaluation; all measures, those of the untrained student and those without a belief too.
pub fn of_teacher(run: &Run, frontier: &FrontierFiles, shadow: &ShadowFiles, place: usize) -> Vec<Judged> {
    let (budget, watched) = (budget(run), shadow.of_run(run));
    let measures = frontier.of_run(run).iter();
    let judged = measures.map(|measure| {
        let told = Testimony::at(measure, watched, place);
        let fitting = |values: Option<&[Option<f32>]>| {
            let values = values.filter(|values| values.len() == measure.successes.len())?;
            Some(values.iter().map(|value| value.map(f64::from)).collect())
        };
        Judged {
            eval_index: measure.eval_index,
            step: measure.step,
            third: third_of(measure.step, budget),
            success: measure.rates(),
            estimates: fitting(told.estimates()),
            scores: fitting(told.scores()),
        }
    });
    judged.collect()
}
