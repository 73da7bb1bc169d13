//! What shadows would have done. Read apart from the records, which mean the same without it.

use std::path::Path;

use super::load::Loader;
use super::problem::StoreProblem;
use super::{Results, Run, RunFolder, check};
use crate::schema::Shadowing;

/// What a run's shadows would have done, by rising evaluation, and what is wrong with the file. Runs without
/// shadows have no such file: nothing, and no problem.
pub fn shadowing(results: &Path, run: &Run) -> (Vec<Shadowing>, Vec<StoreProblem>) {
    let folder = RunFolder::of(results, run.key());
    let results = Results::new(results);
    let mut loader = Loader::new(&results, &folder);
    let lines = check::shadowing(&mut loader, &run.manifest, &run.records);
    (lines, loader.into_problems())
}
