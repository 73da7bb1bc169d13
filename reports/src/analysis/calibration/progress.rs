//! Whether a teacher's scores follow the student's progress: the change of measured success.

use super::{Judged, of_teacher};
use crate::analysis::group::Group;
use crate::analysis::parts::{ByThird, ByThirdMeans};
use crate::analysis::teachers::{GroupTeacher, known};
use crate::analysis::whole::Analysis;
use crate::stats;

/// Rank correlations of the scores at a measure with the absolute change of success, over the goals that have
/// a score.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScoreAndChange {
    /// The third of the run that the measure belongs to.
    pub third: usize,
    /// With the change since the measure before; `None` for the first, and where scores or changes make no
    /// difference between goals.
    pub since: Option<f64>,
    /// With the change until the measure after; likewise.
    pub until: Option<f64>,
    /// Share of the goals whose success has changed since the measure before; `None` for the first.
    pub changed: Option<f64>,
}

impl ScoreAndChange {
    /// At each of the measures of a run, by rising evaluation; `None` at one without scores.
    pub fn of(measures: &[Judged]) -> Vec<Option<Self>> {
        let at = |index: usize| {
            let judged = &measures[index];
            let scores = judged.scores.as_deref()?;
            let before = index.checked_sub(1).map(|before| change(&measures[before], judged));
            let after = measures.get(index + 1).map(|after| change(judged, after));
            let moved = |change: &Vec<f64>| change.iter().filter(|&&change| change > 0.0).count() as f64;
            let correlation = |change: &Vec<f64>| {
                let (scores, change) = known(scores, change);
                stats::spearman(&scores, &change)
            };
            Some(Self {
                third: judged.third,
                since: before.as_ref().and_then(correlation),
                until: after.as_ref().and_then(correlation),
                changed: before.map(|change| moved(&change) / change.len() as f64),
            })
        };
        (0..measures.len()).map(at).collect()
    }
}

/// |p(now) − p(then)| of every goal, `[N]`; the two are of one pool.
fn change(then: &Judged, now: &Judged) -> Vec<f64> {
    now.success.iter().zip(&then.success).map(|(now, then)| (now - then).abs()).collect()
}

/// What the table says of one teacher in one group of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgressSummary {
    /// Which teacher, and in which group.
    pub teacher: GroupTeacher,
    /// Runs that count ([`Group::settled`]) with scores after training had begun.
    pub n_seeds: usize,
    /// [`ScoreAndChange::changed`], mean over measures, then over runs.
    pub changed: Option<f64>,
    /// [`ScoreAndChange::since`], means over measures.
    pub since: ByThirdMeans,
    /// [`ScoreAndChange::until`], likewise.
    pub until: ByThirdMeans,
}

impl ProgressSummary {
    /// Of every teacher of a group that scores goals.
    pub fn of(group: &Group<'_>, analysis: &Analysis<'_>) -> Vec<Self> {
        let group = group.settled();
        let of_place = |(place, teacher)| {
            let judged = |run| of_teacher(run, &analysis.frontier, &analysis.shadow, place);
            let runs = group.runs.iter().map(|run| scored(&judged(run)));
            let runs: Vec<Vec<ScoreAndChange>> = runs.filter(|run| !run.is_empty()).collect();
            let over = |of: fn(&ScoreAndChange) -> Option<f64>| -> Vec<ByThird> {
                let values = |run: &Vec<ScoreAndChange>| {
                    let told = run.iter().filter_map(|at| Some((at.third, of(at)?)));
                    ByThird::means(&told.collect::<Vec<_>>())
                };
                runs.iter().map(values).collect()
            };
            (!runs.is_empty()).then(|| Self {
                teacher,
                n_seeds: runs.len(),
                changed: ByThirdMeans::of(&over(|at| at.changed)).all.0,
                since: ByThirdMeans::of(&over(|at| at.since)),
                until: ByThirdMeans::of(&over(|at| at.until)),
            })
        };
        GroupTeacher::all(&group, analysis).into_iter().enumerate().filter_map(of_place).collect()
    }
}

/// The measures after training had begun at which there are scores.
fn scored(measures: &[Judged]) -> Vec<ScoreAndChange> {
    let found = ScoreAndChange::of(measures).into_iter().zip(measures);
    found.filter(|(_, judged)| judged.eval_index > 0).filter_map(|(at, _)| at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_and_changes_by_hand() {
        let judged = |eval_index, third, success: [f64; 3], scores: Option<[f64; 3]>| Judged {
            eval_index,
            third,
            success: success.to_vec(),
            scores: scores.map(|scores| scores.map(Some).to_vec()),
            ..Judged::default()
        };
        let measures = [
            judged(0, 0, [0.0, 0.0, 0.0], None),
            // It has forgotten nothing yet: changes 0.5, 0 and 0.2.
            judged(1, 0, [0.5, 0.0, 0.2], Some([3.0, 1.0, 2.0])),
            // Changes 0.5, 0.1 and 0: a decline is a change.
            judged(2, 1, [0.0, 0.1, 0.2], Some([1.0, 2.0, 3.0])),
            judged(3, 2, [0.0, 0.1, 0.2], Some([1.0, 2.0, 3.0])),
        ];
        let found = ScoreAndChange::of(&measures);
        assert_eq!(found[0], None);
        let first = found[1].expect("scores");
        assert_eq!((first.since, first.changed), (Some(1.0), Some(2.0 / 3.0)));
        // Ranks 3, 1, 2 against 3, 2, 1.
        assert_eq!(first.until, Some(0.5));
        let second = found[2].expect("scores");
        assert_eq!((second.since, second.until), (Some(-1.0), None), "nothing changes after that");
        let last = found[3].expect("scores");
        assert_eq!((last.since, last.until, last.changed), (None, None, Some(0.0)));
        assert_eq!(scored(&measures).len(), 3);
        // Changes of 0.5, 0.1 and 0; of the first goal nothing is known: 1, 2 against 0.1, 0.
        let mut partly = measures.clone();
        partly[2].scores = Some(vec![None, Some(1.0), Some(2.0)]);
        let found = ScoreAndChange::of(&partly)[2].expect("scores");
        assert_eq!((found.since, found.changed), (Some(-1.0), Some(2.0 / 3.0)));
    }
}
