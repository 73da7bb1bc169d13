//! How students learned. Read apart from the records, which mean the same without it.

use std::path::Path;

use super::load::Loader;
use super::problem::StoreProblem;
use super::{Results, Run, RunFolder, check};
use crate::schema::Learning;

/// How the learning of a run's student stood, by rising evaluation, and what is wrong with the file. Results
/// of old versions have no such file: nothing, and no problem.
pub fn learning(results: &Path, run: &Run) -> (Vec<Learning>, Vec<StoreProblem>) {
    let folder = RunFolder::of(results, run.key());
    let results = Results::new(results);
    let mut loader = Loader::new(&results, &folder);
    let learning = check::learning(&mut loader, &run.manifest, &run.records);
    (learning, loader.into_problems())
}
