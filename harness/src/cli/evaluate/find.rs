//! Which runs the paths of a command line stand for.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use reports::schema::RunKey;
use reports::store::layout;

use crate::Registry;
use crate::error::HarnessError;
use crate::run::folder::read_manifest;
use crate::run::policy::Policy;
use crate::status::find_runs;

/// A run to evaluate.
pub(super) struct Subject {
    /// Its folder.
    pub(super) folder: PathBuf,
    /// The results folder that it belongs to, absolute; its own folder where it lies by itself.
    pub(super) results: PathBuf,
    /// Whether it was given by itself, not within a results folder.
    pub(super) named: bool,
    run: RunKey,
}

/// What there is to evaluate.
pub(super) struct Found {
    /// Each run once, by results folder, environment, curriculum, variant and seed.
    pub(super) subjects: Vec<Subject>,
    /// Why other runs of results folders are not among them.
    pub(super) left_out: Vec<HarnessError>,
}

/// The runs that `paths` stand for.
///
/// # Errors
/// [`HarnessError`] if a path is neither a run nor a results folder, or a run given by itself has no policy or is damaged.
pub(super) fn find(registry: &Registry, paths: &[PathBuf]) -> Result<Found, HarnessError> {
    let mut found = Found { subjects: Vec::new(), left_out: Vec::new() };
    let mut seen = BTreeSet::new();
    for path in paths {
        let place = absolute(path)?;
        let mut add = |subject: Subject| -> Result<(), HarnessError> {
            if seen.insert(absolute(&subject.folder)?) {
                found.subjects.push(subject);
            }
            Ok(())
        };
        if path.join(layout::MANIFEST).exists() {
            let run = Policy::read(registry, path)?.run().clone();
            let results = results_of(&place, &run).unwrap_or(&place).to_owned();
            add(Subject { folder: path.clone(), results, named: true, run })?;
        } else if layout::runs_dir(path).is_dir() {
            for folder in find_runs(path)? {
                match within(path, &place, folder) {
                    Ok(subject) => add(subject)?,
                    Err(error) => found.left_out.push(error),
                }
            }
        } else {
            let reason = format!(
                "is neither a run's folder, which holds {}, nor a results folder, which holds runs/",
                layout::MANIFEST
            );
            return Err(HarnessError::Damaged { path: path.clone(), reason });
        }
    }
    found.subjects.sort_by(|a, b| (&a.results, &a.run).cmp(&(&b.results, &b.run)));
    found.left_out.sort_by_key(ToString::to_string);
    Ok(found)
}

/// The run in `folder` of the results folder `results`, which lies at `place`.
fn within(results: &Path, place: &Path, folder: PathBuf) -> Result<Subject, HarnessError> {
    let run = read_manifest(&folder)?.0.run;
    if layout::run_dir(results, &run) != folder {
        let reason = format!("belongs to the run {run}, whose place is elsewhere");
        return Err(HarnessError::Damaged { path: folder.join(layout::MANIFEST), reason });
    }
    Ok(Subject { folder, results: place.to_owned(), named: false, run })
}

/// The results folder in which `folder` is the place of `run`.
fn results_of<'a>(folder: &'a Path, run: &RunKey) -> Option<&'a Path> {
    /// From a results folder to a run: runs, environment, curriculum, variant, seed.
    const DEPTH: usize = 5;
    folder.ancestors().nth(DEPTH).filter(|results| layout::run_dir(results, run) == folder)
}

fn absolute(path: &Path) -> Result<PathBuf, HarnessError> {
    path.canonicalize().map_err(HarnessError::io(path, "find this folder"))
}
