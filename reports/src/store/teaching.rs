//! What teachers did. Read apart from everything else, and for one run at a time: it is large, and only heat
//! maps need it. So a report reads, and checks, these files in mazes alone.

use std::path::Path;

use super::load::Loader;
use super::problem::StoreProblem;
use super::{Results, Run, RunFolder, check};
use crate::schema::Teaching;

/// What the teacher of a run did, by rising evaluation, and what is wrong with the file. Results of old
/// versions have no such file: nothing, and no problem.
pub fn teaching(results: &Path, run: &Run) -> (Vec<Teaching>, Vec<StoreProblem>) {
    let folder = RunFolder::of(results, run.key());
    let results = Results::new(results);
    let mut loader = Loader::new(&results, &folder);
    let teaching = check::teaching(&mut loader, &run.manifest, &run.records);
    (teaching, loader.into_problems())
}
