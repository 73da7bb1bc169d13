//! Whether a teacher sees the frontier: how well the weights that it gives the goals of its pool tell those of
//! intermediate success from the others.

use std::sync::Arc;

use crate::analysis::catalogue::MethodInfo;
use crate::analysis::frontier::FrontierFiles;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::heat::third;
use crate::analysis::shadow::WatchedRun;
use crate::analysis::shadow::agreement::MeanStd;
use crate::analysis::whole::Analysis;
use crate::schema::Frontier;
use crate::stats::{self, Ddof};
use crate::store::Run;

/// A goal has intermediate success if p(1 − p) lies above this: p between 0.113 and 0.887.
pub const INTERMEDIATE: f64 = 0.1;

/// Whether a goal with so many successes in so many episodes has intermediate success.
pub fn is_intermediate(successes: u64, episodes: u64) -> bool {
    let rate = successes as f64 / episodes as f64;
    rate * (1.0 - rate) > INTERMEDIATE
}

/// What one measure says of a teacher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureSight {
    /// Share of the goals that have intermediate success.
    pub intermediate: f64,
    /// [`stats::auc`] of the teacher's weights for these goals; `None` for a teacher without weights, and where all
    /// goals have intermediate success or none has.
    pub auc: Option<f64>,
    /// Share of the goals that the teacher proposed since the evaluation before, by episodes, that have intermediate
    /// success; `None` where that is not known.
    pub proposed: Option<f64>,
}

impl MeasureSight {
    /// What `measure` says of the teacher that acted.
    pub fn of(measure: &Frontier) -> Self {
        Self::of_wanted(measure, measure.weights.as_deref(), &[])
    }

    /// What it says of any teacher with these `weights`, `[N]`, and `picks`, goals of the pool with how often they
    /// were proposed.
    pub fn of_wanted(measure: &Frontier, weights: Option<&[f32]>, picks: &[(u32, u32)]) -> Self {
        let intermediate: Vec<bool> =
            measure.successes.iter().map(|&successes| is_intermediate(successes, measure.episodes)).collect();
        let count = intermediate.iter().filter(|&&intermediate| intermediate).count();
        let area = |weights: &[f32]| {
            let weights: Vec<f64> = weights.iter().map(|&weight| f64::from(weight)).collect();
            (weights.len() == intermediate.len()).then(|| stats::auc(&weights, &intermediate))?
        };
        let proposals = |of: &dyn Fn(u32) -> bool| -> u64 {
            picks.iter().filter(|(goal, _)| of(*goal)).map(|(_, times)| u64::from(*times)).sum()
        };
        let is_one = |goal: u32| intermediate.get(goal as usize).copied().unwrap_or(false);
        let (all, at_them) = (proposals(&|_| true), proposals(&is_one));
        Self {
            intermediate: count as f64 / intermediate.len() as f64,
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
    /// Mean over these runs of the mean over their measures of [`MeasureSight::intermediate`].
    pub intermediate: f64,
    /// Mean over these runs of the mean over their measures of [`MeasureSight::proposed`]; `None` without one.
    pub proposed: Option<f64>,
    /// Runs with a measure that has an area.
    pub n_auc: usize,
    /// Mean and standard deviation over these runs of the mean over their measures of [`MeasureSight::auc`].
    pub auc: MeanStd,
    /// The same over the measures of each third of a run, and over the runs that have some.
    pub auc_by_third: [MeanStd; 3],
    /// That of the last third less that of the first, over the runs that have both.
    pub auc_change: MeanStd,
}

/// One teacher in one run.
struct RunSight {
    intermediate: f64,
    proposed: Option<f64>,
    auc: Option<f64>,
    by_third: [Option<f64>; 3],
}

impl RunSight {
    /// What the measures of `run` after the untrained student's, for no teacher has seen that one learn yet, say of the
    /// teacher in this place; `None` without any.
    fn of(run: &Run, files: &FrontierFiles, watched: Option<&WatchedRun>, place: usize) -> Option<Self> {
        let end = run.records.last().map_or(0, |record| record.step);
        let trained = files.of_run(run).iter().filter(|measure| measure.eval_index > 0);
        let sight = |measure: &Frontier| {
            let wanted = watched.and_then(|watched| watched.measured.get(&measure.eval_index)?.get(place));
            let picks = wanted.map_or(&[][..], |wanted| &wanted.picks);
            let weights = match place {
                0 => measure.weights.as_deref(),
                _ => wanted.and_then(|wanted| wanted.weights.as_deref()),
            };
            (third(measure.step, end), MeasureSight::of_wanted(measure, weights, picks))
        };
        let sights: Vec<(usize, MeasureSight)> = trained.map(sight).collect();
        let over = |of: &dyn Fn(&(usize, MeasureSight)) -> Option<f64>| {
            stats::mean(&sights.iter().filter_map(of).collect::<Vec<_>>())
        };
        Some(Self {
            intermediate: over(&|(_, sight)| Some(sight.intermediate))?,
            proposed: over(&|(_, sight)| sight.proposed),
            auc: over(&|(_, sight)| sight.auc),
            by_third: [0, 1, 2].map(|third| over(&|(at, sight)| sight.auc.filter(|_| *at == third))),
        })
    }
}

impl SightSummary {
    /// The numbers of a group's teachers, the one that acted first, then those that watched; none if none of its runs
    /// was measured after training had begun.
    pub fn of(group: &Group<'_>, analysis: &Analysis<'_>) -> Vec<Self> {
        let watched = |run: &&Run| analysis.shadow.of_run(run);
        let shadows = group.runs.iter().find_map(watched).map_or(&[][..], |watched| &watched.teachers[1..]);
        let of_catalogue = |id: &String| analysis.catalogue().method(id);
        let teachers =
            [Arc::clone(&group.key.curriculum)].into_iter().chain(shadows.iter().map(of_catalogue));
        let of_teacher = |(place, teacher): (usize, Arc<MethodInfo>)| {
            let sight = |run: &&Run| RunSight::of(run, &analysis.frontier, watched(run), place);
            Self::over(&group.key, teacher, &group.runs.iter().filter_map(sight).collect::<Vec<_>>())
        };
        teachers.enumerate().filter_map(of_teacher).collect()
    }

    fn over(key: &GroupKey, teacher: Arc<MethodInfo>, runs: &[RunSight]) -> Option<Self> {
        let values = |of: &dyn Fn(&RunSight) -> Option<f64>| runs.iter().filter_map(of).collect::<Vec<_>>();
        let both = |values: &[f64]| (stats::mean(values), stats::std_dev(values, Ddof::Sample));
        let areas = values(&|run| run.auc);
        Some(Self {
            key: key.clone(),
            teacher,
            n_seeds: runs.len(),
            intermediate: stats::mean(&values(&|run| Some(run.intermediate)))?,
            proposed: stats::mean(&values(&|run| run.proposed)),
            n_auc: areas.len(),
            auc: both(&areas),
            auc_by_third: [0, 1, 2].map(|third| both(&values(&|run| run.by_third[third]))),
            auc_change: both(&values(&|run| Some(run.by_third[2]? - run.by_third[0]?))),
        })
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
        assert_eq!([0, 1, 2, 3, 4, 5].map(|k| is_intermediate(k, 5)), [false, true, true, true, true, false]);
        assert_eq!([1, 2, 8, 9].map(|k| is_intermediate(k, 10)), [false, true, true, false]);
    }

    #[test]
    fn a_measure_by_hand() {
        let measure = Frontier {
            episodes: 5,
            successes: vec![0, 2, 5, 4],
            weights: Some(vec![0.1, 0.4, 0.2, 0.3]),
            ..Frontier::default()
        };
        assert_eq!(
            MeasureSight::of(&measure),
            MeasureSight { intermediate: 0.5, auc: Some(1.0), proposed: None }
        );
        // 0.4 lies above both others, 0.1 below one and level with the other.
        let weights = Some(vec![0.1, 0.4, 0.2, 0.1]);
        let sight = MeasureSight::of(&Frontier { weights, ..measure.clone() });
        assert_eq!(sight.auc, Some(2.5 / 4.0));
        let sight = MeasureSight::of(&Frontier { weights: None, ..measure.clone() });
        assert_eq!((sight.intermediate, sight.auc), (0.5, None));
        // Of five proposals three went to the goals of intermediate success.
        let sight = MeasureSight::of_wanted(&measure, Some(&[0.25; 4]), &[(0, 2), (1, 2), (3, 1)]);
        assert_eq!((sight.auc, sight.proposed), (Some(0.5), Some(0.6)));
        let solved = MeasureSight::of(&Frontier { successes: vec![5; 4], ..measure });
        assert_eq!((solved.intermediate, solved.auc), (0.0, None));
    }
}
