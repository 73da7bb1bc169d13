//! Whether a teacher sees the frontier: how well the weights that it gives the goals of its pool tell those
//! of intermediate success from the others.

use crate::analysis::frontier::FrontierFiles;
use crate::analysis::group::{Group, GroupKey};
use crate::schema::Frontier;
use crate::stats::{self, Ddof};

/// A goal has intermediate success if p(1 − p) lies above this: p between 0.113 and 0.887.
pub const INTERMEDIATE: f64 = 0.1;

/// Whether a goal with so many successes in so many episodes has intermediate success.
pub fn is_intermediate(successes: u64, episodes: u64) -> bool {
    let rate = successes as f64 / episodes as f64;
    rate * (1.0 - rate) > INTERMEDIATE
}

/// What one measure says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureSight {
    /// Share of the goals that have intermediate success.
    pub intermediate: f64,
    /// [`stats::auc`] of the teacher's weights for these goals; `None` for a teacher without weights, and
    /// where all goals have intermediate success or none has.
    pub auc: Option<f64>,
}

impl MeasureSight {
    /// What `measure` says.
    pub fn of(measure: &Frontier) -> Self {
        let intermediate: Vec<bool> =
            measure.successes.iter().map(|&successes| is_intermediate(successes, measure.episodes)).collect();
        let count = intermediate.iter().filter(|&&intermediate| intermediate).count();
        let area = |weights: &Vec<f32>| {
            let weights: Vec<f64> = weights.iter().map(|&weight| f64::from(weight)).collect();
            stats::auc(&weights, &intermediate)
        };
        Self {
            intermediate: count as f64 / intermediate.len() as f64,
            auc: measure.weights.as_ref().and_then(area),
        }
    }
}

/// What the table says about one group of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct SightSummary {
    /// Which group.
    pub key: GroupKey,
    /// Its runs with a measure after training has begun.
    pub n_seeds: usize,
    /// Mean over these runs of the mean over their measures of [`MeasureSight::intermediate`].
    pub intermediate: f64,
    /// Runs with a measure that has an area.
    pub n_auc: usize,
    /// Mean over these runs of the mean over their measures of [`MeasureSight::auc`]; `None` without one.
    pub auc: Option<f64>,
    /// Standard deviation over these runs; `None` for fewer than two.
    pub auc_std: Option<f64>,
}

impl SightSummary {
    /// The numbers of a group; `None` if none of its runs was measured after training had begun. The
    /// untrained student's measure is left out: no teacher has seen it learn yet.
    pub fn of(group: &Group<'_>, files: &FrontierFiles) -> Option<Self> {
        let mut intermediate = Vec::new();
        let mut areas = Vec::new();
        for run in &group.runs {
            let trained = files.of_run(run).iter().filter(|measure| measure.eval_index > 0);
            let sights: Vec<MeasureSight> = trained.map(MeasureSight::of).collect();
            let shares: Vec<f64> = sights.iter().map(|sight| sight.intermediate).collect();
            intermediate.extend(stats::mean(&shares));
            let of_run: Vec<f64> = sights.iter().filter_map(|sight| sight.auc).collect();
            areas.extend(stats::mean(&of_run));
        }
        Some(Self {
            key: group.key.clone(),
            n_seeds: intermediate.len(),
            intermediate: stats::mean(&intermediate)?,
            n_auc: areas.len(),
            auc: stats::mean(&areas),
            auc_std: stats::std_dev(&areas, Ddof::Sample),
        })
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
        assert_eq!(MeasureSight::of(&measure), MeasureSight { intermediate: 0.5, auc: Some(1.0) });
        // 0.4 lies above both others, 0.1 below one and level with the other.
        let weights = Some(vec![0.1, 0.4, 0.2, 0.1]);
        let sight = MeasureSight::of(&Frontier { weights, ..measure.clone() });
        assert_eq!(sight.auc, Some(2.5 / 4.0));
        let sight = MeasureSight::of(&Frontier { weights: None, ..measure.clone() });
        assert_eq!((sight.intermediate, sight.auc), (0.5, None));
        let solved = MeasureSight::of(&Frontier { successes: vec![5; 4], ..measure });
        assert_eq!((solved.intermediate, solved.auc), (0.0, None));
    }
}
