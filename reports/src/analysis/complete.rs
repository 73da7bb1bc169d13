//! Which runs may be compared: those that used up their budget and were evaluated at the same steps.
//!
//! A run that has not ended is further behind than its method is, and its area under the curve is one of
//! another stretch of training. No verdict, test or sum over environments rests on such a run.

use std::collections::BTreeMap;

use crate::analysis::group::Group;
use crate::store::Run;

/// `groups` cut to the runs that may be compared with each other: finished ones, evaluated at the steps that
/// most finished runs of their environment among `groups` were evaluated at (of two equally common lists of
/// steps, those that go on for longer). Shape: one group per group; some may be left without a run.
pub fn comparable<'a>(groups: &[&Group<'a>]) -> Vec<Group<'a>> {
    let cut = |group: &&Group<'a>| {
        let same = |other: &&&Group<'a>| other.key.environment == group.key.environment;
        let common = common_steps(groups.iter().filter(same).flat_map(|group| group.runs.iter().copied()));
        let fits = |run: &&&'a Run| run.is_finished() && Some(steps(run)) == common;
        Group { key: group.key.clone(), runs: group.runs.iter().filter(fits).copied().collect() }
    };
    groups.iter().map(cut).collect()
}

/// Two groups of one environment, cut to the runs that may be compared.
#[derive(Clone, Debug)]
pub struct Pair<'a> {
    /// The first group.
    pub a: Group<'a>,
    /// The second one.
    pub b: Group<'a>,
    /// Runs of both that were cut.
    pub left_out: usize,
}

impl<'a> Pair<'a> {
    /// The comparable runs of `a` and `b`.
    pub fn of(a: &Group<'a>, b: &Group<'a>) -> Self {
        let mut pair = Self { a: a.clone(), b: b.clone(), left_out: 0 };
        for (group, cut) in [&mut pair.a, &mut pair.b].into_iter().zip(comparable(&[a, b])) {
            pair.left_out += group.runs.len() - cut.runs.len();
            *group = cut;
        }
        pair
    }
}

/// The steps at which most of the finished `runs` were evaluated; `None` if none is finished.
fn common_steps<'a>(runs: impl Iterator<Item = &'a Run>) -> Option<Vec<u64>> {
    let mut counts: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
    for run in runs.filter(|run| run.is_finished()) {
        *counts.entry(steps(run)).or_default() += 1;
    }
    let rank = |(steps, count): &(Vec<u64>, usize)| (*count, steps.last().copied(), steps.len());
    counts.into_iter().max_by_key(rank).map(|(steps, _)| steps)
}

/// The steps at which a run was evaluated.
fn steps(run: &Run) -> Vec<u64> {
    run.records.iter().map(|record| record.step).collect()
}
