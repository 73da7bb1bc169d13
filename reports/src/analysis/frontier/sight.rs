//! Whether a teacher sees the frontier: how well its scores, and the weights that it gives the goals of its
//! pool, tell those of intermediate success from the others.

use crate::analysis::group::Group;
use crate::analysis::parts::{ByThird, ByThirdMeans, MeanStd, budget, mean_std, third_of};
use crate::analysis::teachers::{GroupTeacher, Testimony, known};
use crate::analysis::whole::Analysis;
use crate::schema::Frontier;
use crate::stats;
use crate::store::Run;

/// A goal has intermediate success if p(1 − p) lies above this: p between 0.113 and 0.887.
pub const INTERMEDIATE: f64 = 0.1;

/// Whether a goal with this measured success rate has intermediate success.
pub fn has_intermediate_success(rate: f64) -> bool {
    rate * (1.0 - rate) > INTERMEDIATE
}

/// How a teacher tells some goals from the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureSight {
    /// Share of the goals that are such.
    pub share: f64,
    /// [`stats::auc`] of the teacher's weights for these goals; `None` for a teacher without weights, and
    /// where all goals are such or none is.
    pub weights: Option<f64>,
    /// The same of its scores, over the goals that it scored.
    pub scores: Option<f64>,
    /// Share of the goals that the teacher proposed since the evaluation before, by episodes, that are such;
    /// `None` where that is not known.
    pub proposed: Option<f64>,
}

impl MeasureSight {
    /// How the teacher that acted tells the goals of intermediate success in `measure`.
    pub fn of(measure: &Frontier) -> Self {
        Self::of_told(&measure.rates(), &Testimony::at(measure, None, 0))
    }

    /// How a teacher that `told` this tells the goals whose `rates`, `[N]`, are intermediate.
    pub fn of_told(rates: &[f64], told: &Testimony<'_>) -> Self {
        let such: Vec<bool> = rates.iter().map(|&rate| has_intermediate_success(rate)).collect();
        let count = such.iter().filter(|&&such| such).count();
        let proposals = |of: &dyn Fn(u32) -> bool| -> u64 {
            told.picks.iter().filter(|(goal, _)| of(*goal)).map(|(_, times)| u64::from(*times)).sum()
        };
        let is_such = |goal: u32| such.get(goal as usize).copied().unwrap_or(false);
        let (all, at_them) = (proposals(&|_| true), proposals(&is_such));
        let weights = told.weights.map(|weights| weights.iter().copied().map(Some).collect::<Vec<_>>());
        Self {
            share: count as f64 / such.len() as f64,
            weights: area(weights.as_deref(), &such),
            scores: area(told.scores(), &such),
            proposed: (all > 0).then(|| at_them as f64 / all as f64),
        }
    }
}

/// [`stats::auc`] of those of `values`, `[N]`, that there are, for the goals that are `such`, `[N]`.
fn area(values: Option<&[Option<f32>]>, such: &[bool]) -> Option<f64> {
    let values = values.filter(|values| values.len() == such.len())?;
    let widened: Vec<Option<f64>> = values.iter().map(|value| value.map(f64::from)).collect();
    let (values, such) = known(&widened, such);
    stats::auc(&values, &such)
}

/// What the table says about one teacher in one group of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct SightSummary {
    /// Which teacher, and in which group.
    pub teacher: GroupTeacher,
    /// The runs with a measure after training has begun.
    pub n_seeds: usize,
    /// Of goals that have intermediate success themselves.
    pub itself: SightMeans,
    /// Of goals that have it together with those next to them; `None` where nobody tells where goals lie.
    pub border: Option<SightMeans>,
}

/// Means over runs of the means over their measures.
#[derive(Clone, Debug, PartialEq)]
pub struct SightMeans {
    /// [`MeasureSight::share`].
    pub share: f64,
    /// [`MeasureSight::proposed`]; `None` without one.
    pub proposed: Option<f64>,
    /// [`MeasureSight::weights`].
    pub weights: AreaMeans,
    /// [`MeasureSight::scores`].
    pub scores: AreaMeans,
}

/// Areas of runs, each the mean over measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaMeans {
    /// Over all of a run, and over each third.
    pub parts: ByThirdMeans,
    /// That of the last third less that of the first, over the runs that have both.
    pub change: MeanStd,
}

impl AreaMeans {
    fn of(runs: &[ByThird]) -> Self {
        let change = |run: &ByThird| Some(run.thirds[2]? - run.thirds[0]?);
        Self { parts: ByThirdMeans::of(runs), change: mean_std(runs.iter().map(change)) }
    }
}

/// One teacher in one run: means over measures.
struct RunSight {
    share: f64,
    proposed: Option<f64>,
    weights: ByThird,
    scores: ByThird,
}

impl RunSight {
    /// Of `sights`, each with the third of the run that it belongs to; `None` without any.
    fn of(sights: &[(usize, MeasureSight)]) -> Option<Self> {
        let over = |of: fn(&MeasureSight) -> Option<f64>| {
            let told = sights.iter().filter_map(|(third, sight)| Some((*third, of(sight)?)));
            ByThird::means(&told.collect::<Vec<_>>())
        };
        Some(Self {
            share: over(|sight| Some(sight.share)).all?,
            proposed: over(|sight| sight.proposed).all,
            weights: over(|sight| sight.weights),
            scores: over(|sight| sight.scores),
        })
    }
}

/// Whose success makes a goal one that a teacher should see.
#[derive(Clone, Copy)]
enum Truth {
    Itself,
    Border,
}

impl SightMeans {
    /// Of the teacher in this place in `runs`; `None` if none of them was measured after training had begun.
    /// The untrained student's measure is left out: no teacher has seen it learn yet.
    fn of(runs: &[&Run], analysis: &Analysis<'_>, place: usize, truth: Truth) -> Option<(usize, Self)> {
        let sight = |run: &&Run| RunSight::of(&sights(run, analysis, place, truth));
        let runs: Vec<RunSight> = runs.iter().filter_map(sight).collect();
        let areas = |of: fn(&RunSight) -> ByThird| AreaMeans::of(&runs.iter().map(of).collect::<Vec<_>>());
        let means = Self {
            share: mean_std(runs.iter().map(|run| Some(run.share))).0?,
            proposed: mean_std(runs.iter().map(|run| run.proposed)).0,
            weights: areas(|run| run.weights),
            scores: areas(|run| run.scores),
        };
        Some((runs.len(), means))
    }
}

/// What the measures of `run` say of the teacher in this place, each with its third of the run.
fn sights(run: &Run, analysis: &Analysis<'_>, place: usize, truth: Truth) -> Vec<(usize, MeasureSight)> {
    let (budget, watched) = (budget(run), analysis.shadow.of_run(run));
    let neighbours = analysis.frontier.neighbours(run);
    let sight = |measure: &Frontier| {
        let rates = match truth {
            Truth::Itself => measure.rates(),
            Truth::Border => neighbours?.means(&measure.rates())?,
        };
        let told = Testimony::at(measure, watched, place);
        Some((third_of(measure.step, budget), MeasureSight::of_told(&rates, &told)))
    };
    let trained = analysis.frontier.of_run(run).iter().filter(|measure| measure.eval_index > 0);
    trained.filter_map(sight).collect()
}

impl SightSummary {
    /// The numbers of a group's teachers in their places; none if none of the runs that count
    /// ([`Group::settled`]) was measured after training had begun.
    pub fn of(group: &Group<'_>, analysis: &Analysis<'_>) -> Vec<Self> {
        let group = group.settled();
        let of_teacher = |(place, teacher): (usize, GroupTeacher)| {
            let means = |truth| SightMeans::of(&group.runs, analysis, place, truth);
            let (n_seeds, itself) = means(Truth::Itself)?;
            let border = means(Truth::Border).map(|(_, means)| means);
            Some(Self { teacher, n_seeds, itself, border })
        };
        GroupTeacher::all(&group, analysis).into_iter().enumerate().filter_map(of_teacher).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::Beliefs;

    #[test]
    fn intermediate_success_by_hand() {
        // p(1 − p) of 0, 1/5, ..., 1: 0, 0.16, 0.24, 0.24, 0.16, 0; of 1/10 it is 0.09, of 9/10 as well.
        let fifths = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
        assert_eq!(fifths.map(has_intermediate_success), [false, true, true, true, true, false]);
        assert_eq!([0.1, 0.2, 0.8, 0.9].map(has_intermediate_success), [false, true, true, false]);
    }

    #[test]
    fn a_measure_by_hand() {
        let measure = Frontier {
            episodes: 5,
            successes: vec![0, 2, 5, 4],
            weights: Some(vec![0.1, 0.4, 0.2, 0.3]),
            ..Frontier::default()
        };
        let expected = MeasureSight { share: 0.5, weights: Some(1.0), scores: None, proposed: None };
        assert_eq!(MeasureSight::of(&measure), expected);
        // 0.4 lies above both others, 0.1 below one and level with the other.
        let weights = Some(vec![0.1, 0.4, 0.2, 0.1]);
        let sight = MeasureSight::of(&Frontier { weights, ..measure.clone() });
        assert_eq!(sight.weights, Some(2.5 / 4.0));
        let sight = MeasureSight::of(&Frontier { weights: None, ..measure.clone() });
        assert_eq!((sight.share, sight.weights), (0.5, None));
        // Of five proposals three went to the goals of intermediate success.
        let picks = [(0, 2), (1, 2), (3, 1)];
        let told = Testimony { weights: Some(&[0.25; 4]), picks: &picks, ..Testimony::default() };
        let sight = MeasureSight::of_told(&measure.rates(), &told);
        assert_eq!((sight.weights, sight.proposed), (Some(0.5), Some(0.6)));
        let solved = MeasureSight::of(&Frontier { successes: vec![5; 4], ..measure });
        assert_eq!((solved.share, solved.weights), (0.0, None));
    }

    #[test]
    fn scores_are_judged_apart_from_weights_and_over_the_goals_that_have_one() {
        let scored = |scores: [Option<f32>; 4]| {
            let beliefs = Some(Beliefs { success: None, scores: Some(scores.to_vec()) });
            let weights = Some(vec![0.1, 0.4, 0.2, 0.3]);
            let measure = Frontier {
                episodes: 5,
                successes: vec![0, 2, 5, 4],
                weights,
                beliefs,
                ..Frontier::default()
            };
            let sight = MeasureSight::of(&measure);
            (sight.weights, sight.scores)
        };
        // The second and the fourth goal have intermediate success: both score lower than the others.
        assert_eq!(scored([3.0, 1.0, 2.0, 0.0].map(Some)), (Some(1.0), Some(0.0)));
        // Nothing is known yet, while weights differ for another reason.
        assert_eq!(scored([0.0; 4].map(Some)), (Some(1.0), Some(0.5)));
        // Of the first goal and the last nothing is known: 1 against 2.
        assert_eq!(scored([None, Some(1.0), Some(2.0), None]), (Some(1.0), Some(0.0)));
        assert_eq!(scored([None, Some(1.0), None, Some(2.0)]), (Some(1.0), None), "goals of one kind");
    }
}
