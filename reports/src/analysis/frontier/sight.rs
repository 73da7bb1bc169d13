//! Whether a teacher sees the frontier: how well the weights that it gives the goals of its pool tell those
//! of intermediate success from the others.

use std::sync::Arc;

use crate::analysis::catalogue::MethodInfo;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::heat::third;
use crate::analysis::shadow::agreement::MeanStd;
use crate::analysis::whole::Analysis;
use crate::schema::Frontier;
use crate::stats::{self, Ddof};
use crate::store::Run;

/// A goal has intermediate success if p(1 − p) lies above this: p between 0.113 and 0.887.
pub const INTERMEDIATE: f64 = 0.1;

/// Whether a goal with this success rate has intermediate success.
pub fn is_intermediate(rate: f64) -> bool {
    rate * (1.0 - rate) > INTERMEDIATE
}

/// How a teacher tells some goals from the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureSight {
    /// Share of the goals that are such.
    pub share: f64,
    /// [`stats::auc`] of the teacher's weights for these goals; `None` for a teacher without weights, and
    /// where all goals are such or none is.
    pub auc: Option<f64>,
    /// Share of the goals that the teacher proposed since the evaluation before, by episodes, that are such;
    /// `None` where that is not known.
    pub proposed: Option<f64>,
}

impl MeasureSight {
    /// How the teacher that acted tells the goals of intermediate success in `measure`.
    pub fn of(measure: &Frontier) -> Self {
        Self::of_wanted(&measure.rates(), measure.weights.as_deref(), &[])
    }

    /// How a teacher with these `weights`, `[N]`, and `picks`, goals of the pool with how often they were
    /// proposed, tells the goals whose `rates`, `[N]`, are intermediate.
    pub fn of_wanted(rates: &[f64], weights: Option<&[f32]>, picks: &[(u32, u32)]) -> Self {
        let such: Vec<bool> = rates.iter().map(|&rate| is_intermediate(rate)).collect();
        let count = such.iter().filter(|&&such| such).count();
        let area = |weights: &[f32]| {
            let weights: Vec<f64> = weights.iter().map(|&weight| f64::from(weight)).collect();
            (weights.len() == such.len()).then(|| stats::auc(&weights, &such))?
        };
        let proposals = |of: &dyn Fn(u32) -> bool| -> u64 {
            picks.iter().filter(|(goal, _)| of(*goal)).map(|(_, times)| u64::from(*times)).sum()
        };
        let is_such = |goal: u32| such.get(goal as usize).copied().unwrap_or(false);
        let (all, at_them) = (proposals(&|_| true), proposals(&is_such));
        Self {
            share: count as f64 / such.len() as f64,
            auc: weights.and_then(area),
            proposed: (all > 0).then(|| at_them as f64 / all as f64),
        }
    }
}

/// What the table says about one teacher in one group of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct SightSummary {
    /// Which group.
    pub key: GroupKey,
    /// The teacher: the one that acted in these runs, or one that watched.
    pub teacher: Arc<MethodInfo>,
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
    /// Runs with a measure that has an area.
    pub n_auc: usize,
    /// [`MeasureSight::auc`], and its standard deviation over these runs.
    pub auc: MeanStd,
    /// The same over the measures of each third of a run, and over the runs that have some.
    pub auc_by_third: [MeanStd; 3],
    /// That of the last third less that of the first, over the runs that have both.
    pub auc_change: MeanStd,
}

/// One teacher in one run: means over measures.
struct RunSight {
    share: f64,
    proposed: Option<f64>,
    auc: Option<f64>,
    by_third: [Option<f64>; 3],
}

impl RunSight {
    /// Of `sights`, each with the third of the run that it belongs to; `None` without any.
    fn of(sights: &[(usize, MeasureSight)]) -> Option<Self> {
        let over = |of: &dyn Fn(&(usize, MeasureSight)) -> Option<f64>| {
            stats::mean(&sights.iter().filter_map(of).collect::<Vec<_>>())
        };
        Some(Self {
            share: over(&|(_, sight)| Some(sight.share))?,
            proposed: over(&|(_, sight)| sight.proposed),
            auc: over(&|(_, sight)| sight.auc),
            by_third: [0, 1, 2].map(|third| over(&|(at, sight)| sight.auc.filter(|_| *at == third))),
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
        let values = |of: &dyn Fn(&RunSight) -> Option<f64>| runs.iter().filter_map(of).collect::<Vec<_>>();
        let both = |values: &[f64]| (stats::mean(values), stats::std_dev(values, Ddof::Sample));
        let areas = values(&|run| run.auc);
        let means = Self {
            share: stats::mean(&values(&|run| Some(run.share)))?,
            proposed: stats::mean(&values(&|run| run.proposed)),
            n_auc: areas.len(),
            auc: both(&areas),
            auc_by_third: [0, 1, 2].map(|third| both(&values(&|run| run.by_third[third]))),
            auc_change: both(&values(&|run| Some(run.by_third[2]? - run.by_third[0]?))),
        };
        Some((runs.len(), means))
    }
}

/// What the measures of `run` say of the teacher in this place, each with its third of the run.
fn sights(run: &Run, analysis: &Analysis<'_>, place: usize, truth: Truth) -> Vec<(usize, MeasureSight)> {
    let end = run.records.last().map_or(0, |record| record.step);
    let watched = analysis.shadow.of_run(run);
    let neighbours = analysis.frontier.neighbours(run);
    let sight = |measure: &Frontier| {
        let rates = match truth {
            Truth::Itself => measure.rates(),
            Truth::Border => neighbours?.means(&measure.rates())?,
        };
        let wanted = watched.and_then(|watched| watched.measured.get(&measure.eval_index)?.get(place));
        let picks = wanted.map_or(&[][..], |wanted| &wanted.picks);
        let weights = match place {
            0 => measure.weights.as_deref(),
            _ => wanted.and_then(|wanted| wanted.weights.as_deref()),
        };
        Some((third(measure.step, end), MeasureSight::of_wanted(&rates, weights, picks)))
    };
    let trained = analysis.frontier.of_run(run).iter().filter(|measure| measure.eval_index > 0);
    trained.filter_map(sight).collect()
}

impl SightSummary {
    /// The numbers of a group's teachers, the one that acted first, then those that watched; none if none of
    /// its runs was measured after training had begun.
    pub fn of(group: &Group<'_>, analysis: &Analysis<'_>) -> Vec<Self> {
        let watched = group.runs.iter().find_map(|run| analysis.shadow.of_run(run));
        let shadows = watched.map_or(&[][..], |watched| &watched.teachers[1..]);
        let of_catalogue = |id: &String| analysis.catalogue().method(id);
        let teachers =
            [Arc::clone(&group.key.curriculum)].into_iter().chain(shadows.iter().map(of_catalogue));
        let of_teacher = |(place, teacher): (usize, Arc<MethodInfo>)| {
            let means = |truth| SightMeans::of(&group.runs, analysis, place, truth);
            let (n_seeds, itself) = means(Truth::Itself)?;
            let border = means(Truth::Border).map(|(_, means)| means);
            Some(Self { key: group.key.clone(), teacher, n_seeds, itself, border })
        };
        teachers.enumerate().filter_map(of_teacher).collect()
    }

    /// Whether the teacher watched while another one acted.
    pub fn is_shadow(&self) -> bool {
        self.teacher.id != self.key.curriculum.id
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intermediate_success_by_hand() {
        // p(1 − p) of 0, 1/5, ..., 1: 0, 0.16, 0.24, 0.24, 0.16, 0; of 1/10 it is 0.09, of 9/10 as well.
        let fifths = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
        assert_eq!(fifths.map(is_intermediate), [false, true, true, true, true, false]);
        assert_eq!([0.1, 0.2, 0.8, 0.9].map(is_intermediate), [false, true, true, false]);
    }

    #[test]
    fn a_measure_by_hand() {
        let measure = Frontier {
            episodes: 5,
            successes: vec![0, 2, 5, 4],
            weights: Some(vec![0.1, 0.4, 0.2, 0.3]),
            ..Frontier::default()
        };
        assert_eq!(MeasureSight::of(&measure), MeasureSight { share: 0.5, auc: Some(1.0), proposed: None });
        // 0.4 lies above both others, 0.1 below one and level with the other.
        let weights = Some(vec![0.1, 0.4, 0.2, 0.1]);
        let sight = MeasureSight::of(&Frontier { weights, ..measure.clone() });
        assert_eq!(sight.auc, Some(2.5 / 4.0));
        let sight = MeasureSight::of(&Frontier { weights: None, ..measure.clone() });
        assert_eq!((sight.share, sight.auc), (0.5, None));
        // Of five proposals three went to the goals of intermediate success.
        let sight = MeasureSight::of_wanted(&measure.rates(), Some(&[0.25; 4]), &[(0, 2), (1, 2), (3, 1)]);
        assert_eq!((sight.auc, sight.proposed), (Some(0.5), Some(0.6)));
        let solved = MeasureSight::of(&Frontier { successes: vec![5; 4], ..measure });
        assert_eq!((solved.share, solved.auc), (0.0, None));
    }
}
