//! Whether the runs of a cell were made by the same program and the same version of their curriculum.

use std::path::Path;

use super::Run;
use super::layout;
use super::problem::{Fault, StoreProblem};
use crate::schema::{CURRICULUM, PROGRAM, RunKey};

/// Names every run that was made otherwise than the first of its cell (same environment, curriculum and
/// variant) that says how it was made. `runs` come sorted by key.
pub(super) fn differing(runs: &[Run]) -> Vec<StoreProblem> {
    let cell = |run: &Run| {
        let RunKey { environment, curriculum, variant, .. } = run.key().clone();
        (environment, curriculum, variant)
    };
    let cells = runs.chunk_by(|a, b| cell(a) == cell(b));
    cells
        .flat_map(|cell| [CURRICULUM, PROGRAM].into_iter().flat_map(move |name| differing_in(name, cell)))
        .collect()
}

/// Names the runs of `cell` that have another version of `name` than its first with any.
fn differing_in(name: &'static str, cell: &[Run]) -> Vec<StoreProblem> {
    let mut told = cell.iter().filter_map(|run| Some((run, run.manifest.versions.get(name)?)));
    let Some((first, expected)) = told.next() else { return Vec::new() };
    let others = told.filter(|(_, found)| *found != expected);
    let problem = |(run, found): (&Run, &String)| {
        let path = layout::run_dir(Path::new(""), run.key()).join(layout::MANIFEST);
        let other = first.key().clone();
        let fault = Fault::Maker { name, found: found.clone(), other, expected: expected.clone() };
        StoreProblem { path, line: None, fault }
    };
    others.map(problem).collect()
}
