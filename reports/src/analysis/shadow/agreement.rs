//! How far teachers agree that saw the same student at the same moments.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::analysis::catalogue::{Catalogue, MethodInfo};
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::parts::{MeanStd, mean_std};
use crate::analysis::shadow::{ShadowFiles, WatchedRun};
use crate::analysis::teachers::teachers;
use crate::stats::{self, RankOrder};

/// Two teachers in one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// Their places among the run's teachers.
    pub pair: (usize, usize),
    /// Mean over the evaluations of each third of the rank correlation of their orders; `None` where it was
    /// never defined.
    pub correlation: [Option<f64>; 3],
    /// The same of the overlap of the goals that they want most.
    pub overlap: [Option<f64>; 3],
}

/// Values of a run so far, by pair and third.
pub(super) struct Sums {
    teachers: usize,
    pairs: Vec<[[Vec<f64>; 3]; 2]>,
}

impl Sums {
    pub(super) fn of(teachers: usize) -> Self {
        Self { teachers, pairs: vec![Default::default(); teachers * teachers] }
    }

    /// Takes in the orders of all teachers at an evaluation in this third.
    pub(super) fn add(&mut self, third: usize, orders: &[Option<RankOrder>]) {
        for (a, b) in pairs(self.teachers) {
            if let (Some(one), Some(other)) = (&orders[a], &orders[b]) {
                let [correlations, overlaps] = &mut self.pairs[a * self.teachers + b];
                correlations[third].extend(one.correlation(other));
                overlaps[third].extend(one.overlap(other));
            }
        }
    }

    /// Every two teachers that both had an order.
    pub(super) fn agreement(&self) -> Vec<Agreement> {
        let of_pair = |(a, b): (usize, usize)| {
            let means = |values: &[Vec<f64>; 3]| values.each_ref().map(|values| stats::mean(values));
            let [correlation, overlap] = self.pairs[a * self.teachers + b].each_ref().map(means);
            let any = overlap.iter().any(Option::is_some);
            any.then_some(Agreement { pair: (a, b), correlation, overlap })
        };
        pairs(self.teachers).filter_map(of_pair).collect()
    }
}

/// Every two of so many teachers.
fn pairs(teachers: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..teachers).flat_map(move |a| (a + 1..teachers).map(move |b| (a, b)))
}

/// What the table says about two teachers in one group of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct AgreementSummary {
    /// Which group.
    pub key: GroupKey,
    /// The two; the first may be the one that acted.
    pub teachers: [Arc<MethodInfo>; 2],
    /// Runs that count ([`Group::settled`]) in which both had an order.
    pub n_seeds: usize,
    /// [`Agreement::correlation`] over these runs.
    pub correlation: [MeanStd; 3],
    /// [`Agreement::overlap`] over these runs.
    pub overlap: [MeanStd; 3],
}

impl AgreementSummary {
    /// Whether one of the two is the teacher that acted.
    pub fn has_acting(&self) -> bool {
        self.teachers[0].id == self.key.curriculum.id
    }

    /// Every two teachers of a group whose order could be compared in some run.
    pub fn of(group: &Group<'_>, files: &ShadowFiles, catalogue: &Catalogue) -> Vec<Self> {
        let group = group.settled();
        let runs: Vec<&WatchedRun> = group.runs.iter().filter_map(|run| files.of_run(run)).collect();
        let Some(ids) = runs.first().map(|run| &run.teachers) else { return Vec::new() };
        let teachers = teachers(&group, files, catalogue);
        let method = |place: usize| Arc::clone(&teachers[place]);
        let told: BTreeSet<(usize, usize)> =
            runs.iter().flat_map(|run| &run.agreement).map(|agreement| agreement.pair).collect();
        let mut rows = Vec::new();
        for pair in told {
            let found = runs.iter().filter(|run| run.teachers == *ids).flat_map(|run| &run.agreement);
            let found: Vec<&Agreement> = found.filter(|agreement| agreement.pair == pair).collect();
            let over_runs = |of: fn(&Agreement) -> [Option<f64>; 3]| {
                [0, 1, 2].map(|third| mean_std(found.iter().map(|agreement| of(agreement)[third])))
            };
            let correlation = over_runs(|agreement| agreement.correlation);
            if correlation.iter().any(|(mean, _)| mean.is_some()) {
                rows.push(Self {
                    key: group.key.clone(),
                    teachers: [method(pair.0), method(pair.1)],
                    n_seeds: found.len(),
                    correlation,
                    overlap: over_runs(|agreement| agreement.overlap),
                });
            }
        }
        rows
    }
}
