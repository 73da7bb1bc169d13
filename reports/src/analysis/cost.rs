//! What training took: steps, gradient steps and time, and whose time it was.

use crate::analysis::complete;
use crate::analysis::group::Group;
use crate::schema::{Record, Timing};
use crate::stats;
use crate::store::Run;

/// What the finished runs of a group took up to their last evaluation; where none has finished, all of them.
/// Times are means in hours over the seeds whose last evaluation has a timing, since timings can be lost
/// where records are not.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Fewest and most steps of the budget at a seed's last evaluation.
    pub steps: (u64, u64),
    /// Mean over seeds of the steps taken in probe rollouts.
    pub probe_steps: f64,
    /// Mean over seeds of those of them that were not charged to the budget.
    pub uncharged_steps: f64,
    /// Mean over seeds of the student's gradient steps; those of a teacher's own networks are not counted.
    pub gradient_steps: f64,
    /// Seeds whose last evaluation has a timing: those that the times are means over.
    pub n_timed: usize,
    /// Wall-clock time; `None` where no seed has a timing.
    pub wall_hours: Option<f64>,
    /// Evaluations' part of it.
    pub evaluation_hours: Option<f64>,
    /// The teacher's part of it: proposing goals, observing episodes, learning, rollouts. `None` where the
    /// timings of one of them do not tell.
    pub teacher_hours: Option<f64>,
    /// The part of the student's gradient steps; likewise.
    pub learning_hours: Option<f64>,
}

impl Cost {
    /// The costs of a group; `None` without evaluations.
    pub fn of(group: &Group<'_>) -> Option<Self> {
        let last: Vec<_> = group.runs.iter().filter_map(|run| complete::recorded(run).last()).collect();
        let steps = || last.iter().map(|record| record.step);
        let mean = |number: fn(&Record) -> u64| {
            stats::mean(&last.iter().map(|record| number(record) as f64).collect::<Vec<_>>())
        };
        let timings: Vec<&Timing> = group.runs.iter().filter_map(|run| last_timing(run)).collect();
        Some(Self {
            steps: (steps().min()?, steps().max()?),
            probe_steps: mean(|record| record.probe_steps)?,
            uncharged_steps: mean(|record| record.uncharged_steps)?,
            gradient_steps: mean(|record| record.gradient_steps)?,
            n_timed: timings.len(),
            wall_hours: mean_hours(&timings, |timing| Some(timing.wall_s)),
            evaluation_hours: mean_hours(&timings, |timing| Some(timing.evaluation_s)),
            teacher_hours: mean_hours(&timings, |timing| timing.teacher_s),
            learning_hours: mean_hours(&timings, |timing| timing.learning_s),
        })
    }

    /// What share of the wall-clock time `hours` are, in [0, 1]; `None` for no time at all.
    pub fn share(&self, hours: Option<f64>) -> Option<f64> {
        let wall = self.wall_hours.filter(|&wall| wall > 0.0)?;
        Some(hours? / wall)
    }
}

/// The timing of a run's last evaluation; `None` where that is lost, and an earlier one would tell too
/// little.
pub fn last_timing(run: &Run) -> Option<&Timing> {
    let last = complete::recorded(run).last()?;
    run.timings.iter().find(|timing| timing.eval_index == last.eval_index)
}

/// Whether every evaluation of a run has a timing.
pub fn is_timed(run: &Run) -> bool {
    let records = complete::recorded(run);
    let timed = |index: u64| run.timings.iter().any(|timing| timing.eval_index == index);
    records.iter().all(|record| timed(record.eval_index))
}

/// Mean of some seconds, in hours; `None` without timings, or where one of them does not tell.
fn mean_hours(timings: &[&Timing], seconds: impl Fn(&Timing) -> Option<f64>) -> Option<f64> {
    let hours: Option<Vec<f64>> = timings.iter().map(|timing| Some(seconds(timing)? / 3600.0)).collect();
    stats::mean(&hours?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hours_by_hand() {
        let timing = |wall_s, teacher_s| Timing {
            eval_index: 0,
            step: 0,
            wall_s,
            evaluation_s: 0.0,
            teacher_s,
            learning_s: None,
            shadow_s: None,
        };
        let (a, b) = (timing(3600.0, Some(900.0)), timing(10_800.0, Some(2700.0)));
        let old = timing(3600.0, None);
        assert_eq!(mean_hours(&[&a, &b], |timing| Some(timing.wall_s)), Some(2.0));
        assert_eq!(mean_hours(&[&a, &b], |timing| timing.teacher_s), Some(0.5));
        assert_eq!(mean_hours(&[&a, &old], |timing| timing.teacher_s), None);
        assert_eq!(mean_hours(&[], |timing| timing.teacher_s), None);
        let cost = Cost {
            steps: (0, 0),
            probe_steps: 0.0,
            uncharged_steps: 0.0,
            gradient_steps: 0.0,
            n_timed: 2,
            wall_hours: Some(2.0),
            evaluation_hours: None,
            teacher_hours: Some(0.5),
            learning_hours: None,
        };
        assert_eq!((cost.share(cost.teacher_hours), cost.share(None)), (Some(0.25), None));
        assert_eq!(Cost { wall_hours: Some(0.0), ..cost }.share(Some(0.0)), None);
    }
}
