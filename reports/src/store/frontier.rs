//! Measures of the frontier. Read apart from the records, which mean the same without them.

use std::path::Path;

use super::load::Loader;
use super::problem::StoreProblem;
use super::{Results, Run, RunFolder, check};
use crate::schema::Frontier;

/// The success of a run's student at every goal of the pool, by rising evaluation, and what is wrong with the
/// file. Runs that were not asked to measure it have no such file: nothing, and no problem.
pub fn frontier(results: &Path, run: &Run) -> (Vec<Frontier>, Vec<StoreProblem>) {
    let folder = RunFolder::of(results, run.key());
    let results = Results::new(results);
    let mut loader = Loader::new(&results, &folder);
    let measures = check::frontier(&mut loader, &run.manifest, &run.records);
    (measures, loader.into_problems())
}
