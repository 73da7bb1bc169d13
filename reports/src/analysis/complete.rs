//! Which runs may be compared: those that used up their budget and were evaluated at the same steps, and
//! those that failed.
//!
//! A run that has not ended is further behind than its method is, and its area under the curve is one of
//! another stretch of training. No verdict, test or sum over environments rests on such a run. A run that
//! failed is another matter: its student is of no use, and to leave it out would flatter the method that
//! fails. [`failed_as_zero`] completes it.

use std::collections::BTreeMap;

use serde_json::Map;

use crate::analysis::group::Group;
use crate::analysis::options::Failures;
use crate::schema::{Outcome, Record};
use crate::store::{Run, Store};

/// The failed runs of `store` as they count: each with success 0 at every evaluation that it would still have
/// had, at the steps of most finished runs of its environment, curriculum and variant, or of its environment
/// where none of those finished. None under [`Failures::Apart`], nor where no run of the environment tells
/// the steps.
pub fn failed_as_zero(store: &Store, failures: Failures) -> Vec<Run> {
    let failed = store.runs().iter().filter(|run| matches!(run.outcome, Some(Outcome::Failed { .. })));
    match failures {
        Failures::Zero => failed.filter_map(|run| completed(run, model(store, run)?)).collect(),
        Failures::Apart => Vec::new(),
    }
}

/// A finished run with the evaluations that a failed one would have had.
fn model<'a>(store: &'a Store, failed: &Run) -> Option<&'a Run> {
    let key = failed.key();
    let finished = || {
        let same_results = |run: &Run| store.is_own(run) == store.is_own(failed);
        let here = move |run: &&Run| {
            run.is_finished() && run.key().environment == key.environment && same_results(run)
        };
        store.runs().iter().filter(here)
    };
    let alike = |run: &&Run| (&run.key().curriculum, &run.key().variant) == (&key.curriculum, &key.variant);
    let grid = common_steps(finished().filter(alike)).or_else(|| common_steps(finished()))?;
    finished().find(|run| steps(run) == grid)
}

/// The failed run `run` with the evaluations of `model`: its own up to its last one, then failures. It keeps
/// its outcome, with the step of its last evaluation. `None` where it has all of them.
fn completed(run: &Run, model: &Run) -> Option<Run> {
    let Some(Outcome::Failed { reason, .. }) = &run.outcome else { return None };
    let last = run.records.last();
    let end = last.map_or(0, |record| record.step);
    let own = |step: u64| run.records.iter().rev().find(|record| record.step <= step);
    let record = |model: &Record| {
        let known = own(model.step).filter(|_| model.step <= end);
        match known {
            Some(own) => Record { step: model.step, eval_index: model.eval_index, ..own.clone() },
            None => Record {
                environment: run.key().environment.clone(),
                curriculum: run.key().curriculum.clone(),
                variant: run.key().variant.clone(),
                seed: run.key().seed,
                success_rate: 0.0,
                any_success_rate: last.map_or(Some(0.0), |last| last.any_success_rate.map(|_| 0.0)),
                teacher: Map::new(),
                ..model.clone()
            },
        }
    };
    let records: Vec<Record> = model.records.iter().map(record).collect();
    let outcome = Some(Outcome::Failed { step: end, reason: reason.clone() });
    let run = Run { manifest: run.manifest.clone(), records, timings: run.timings.clone(), outcome };
    is_completed(&run).then_some(run)
}

/// Whether this is a failed run that [`failed_as_zero`] completed.
pub fn is_completed(run: &Run) -> bool {
    recorded(run).len() < run.records.len()
}

/// The evaluations of a run that took place: all, or those of a completed one up to its failure.
pub fn recorded(run: &Run) -> &[Record] {
    match run.outcome {
        Some(Outcome::Failed { step, .. }) => {
            &run.records[..run.records.partition_point(|record| record.step <= step)]
        }
        _ => &run.records,
    }
}

/// `groups` cut to the runs that may be compared with each other: finished ones, evaluated at the steps that
/// most finished runs of their environment among `groups` were evaluated at (of two equally common lists of
/// steps, those that go on for longer), and failed ones that were completed to these. Runs of archives decide
/// nothing unless there are no others. Shape: one group per group; some may be left without a run.
pub fn comparable<'a>(groups: &[&Group<'a>]) -> Vec<Group<'a>> {
    let cut = |group: &&Group<'a>| {
        let same = |other: &&&Group<'a>| other.key.environment == group.key.environment;
        let runs = |own_alone: bool| {
            let here = groups.iter().filter(same).filter(move |group| group.is_own() || !own_alone);
            here.flat_map(|group| group.runs.iter().copied())
        };
        let common = common_steps(runs(true)).or_else(|| common_steps(runs(false)));
        let ended = |run: &Run| run.is_finished() || is_completed(run);
        let fits = |run: &&&'a Run| ended(run) && Some(steps(run)) == common;
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
    /// Runs of both that failed, and count 0 from their failure on.
    pub failed: usize,
}

impl<'a> Pair<'a> {
    /// The comparable runs of `a` and `b`.
    pub fn of(a: &Group<'a>, b: &Group<'a>) -> Self {
        let mut pair = Self { a: a.clone(), b: b.clone(), left_out: 0, failed: 0 };
        for (group, cut) in [&mut pair.a, &mut pair.b].into_iter().zip(comparable(&[a, b])) {
            pair.left_out += group.runs.len() - cut.runs.len();
            pair.failed += cut.failed();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;

    #[test]
    fn a_failed_run_counts_0_from_its_failure_on() {
        let model = run("default", 0, &[0.0, 0.5, 0.5, 1.0], Outcome::Finished { step: 30 });
        let failed = run("default", 1, &[0.1, 0.7], Outcome::Failed { step: 17, reason: "NaN".into() });
        let whole = completed(&failed, &model).unwrap();
        let points: Vec<(u64, f64, u64)> = whole
            .records
            .iter()
            .map(|record| (record.step, record.success_rate, record.gradient_steps))
            .collect();
        assert_eq!(points, [(0, 0.1, 0), (10, 0.7, 4), (20, 0.0, 8), (30, 0.0, 12)]);
        assert!(whole.records.iter().all(|record| record.seed == 1 && record.any_success_rate.is_none()));
        assert_eq!(recorded(&whole), failed.records);
        assert!(is_completed(&whole) && !is_completed(&model) && !is_completed(&failed));
    }

    #[test]
    fn one_that_failed_before_its_first_evaluation_counts_0_throughout() {
        let model = run("default", 0, &[0.5, 0.5], Outcome::Finished { step: 10 });
        let failed = run("default", 1, &[], Outcome::Failed { step: 3, reason: "NaN".into() });
        let whole = completed(&failed, &model).unwrap();
        assert_eq!(whole.records.iter().map(|record| record.success_rate).collect::<Vec<_>>(), [0.0, 0.0]);
    }
}
