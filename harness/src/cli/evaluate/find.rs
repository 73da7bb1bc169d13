//! Which runs the paths of a command line stand for.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use reports::schema::RunKey;
use reports::store::problem::StoreProblem;
use reports::store::{Results, RunFolder, StoreError, Survey, layout};

use crate::Registry;
use crate::error::{HarnessError, chain};
use crate::run::folder::{outcome, read_manifest};
use crate::run::policy::Policy;

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
pub(super) struct Chosen {
    /// Each run once, by results folder, environment, curriculum, variant and seed.
    pub(super) subjects: Vec<Subject>,
    /// Why other runs of results folders are not among them.
    pub(super) left_out: Vec<HarnessError>,
    /// What lies where runs belong and is none, in a line each.
    pub(super) strays: Vec<String>,
    /// Whether runs may lie in what could not be read.
    pub(super) hides_runs: bool,
}

/// The runs that `paths` stand for.
///
/// # Errors
/// [`HarnessError`] if a path is neither a run nor a results folder, or a run given by itself has no policy
/// or is damaged.
pub(super) fn find(registry: &Registry, paths: &[PathBuf]) -> Result<Chosen, HarnessError> {
    let mut chosen =
        Chosen { subjects: Vec::new(), left_out: Vec::new(), strays: Vec::new(), hides_runs: false };
    let (mut given, mut seen) = (BTreeSet::new(), BTreeSet::new());
    for path in paths {
        let place = absolute(path)?;
        if !given.insert(place.clone()) {
            continue;
        }
        let mut add = |subject: Subject| -> Result<(), HarnessError> {
            if seen.insert(absolute(&subject.folder)?) {
                chosen.subjects.push(subject);
            }
            Ok(())
        };
        if RunFolder::new(path).has(layout::MANIFEST)? {
            let run = Policy::read(registry, path)?.run().clone();
            outcome(path, &read_manifest(path)?.0)?;
            let results = results_of(&place, &run).unwrap_or(&place).to_owned();
            add(Subject { folder: path.clone(), results, named: true, run })?;
            continue;
        }
        let Survey { runs, lost, strays } = Results::new(path).survey().map_err(neither)?;
        chosen.hides_runs |= strays.iter().any(StoreProblem::hides_runs);
        chosen.strays.extend(strays.iter().map(|stray| format!("{}: {stray}", path.display())));
        for folder in runs.into_iter().chain(lost) {
            match within(&place, &folder) {
                Ok(subject) => add(subject)?,
                Err(error) => chosen.left_out.push(error),
            }
        }
    }
    chosen.subjects.sort_by(|a, b| (&a.results, &a.run).cmp(&(&b.results, &b.run)));
    chosen.left_out.sort_by_cached_key(|error| chain(error));
    Ok(chosen)
}

/// Of a path that is no run's folder, and no results folder either.
fn neither(error: StoreError) -> HarnessError {
    match error {
        StoreError::NotResults { path } => {
            let reason = format!(
                "is neither a run's folder, which holds {}, nor a results folder, which holds runs/",
                layout::MANIFEST
            );
            HarnessError::Missing { path, reason }
        }
        error => error.into(),
    }
}

/// The run in `folder` of the results folder `results`.
fn within(results: &Path, folder: &RunFolder) -> Result<Subject, HarnessError> {
    let manifest = read_manifest(folder.path())?.0;
    folder.check_place(&manifest)?;
    outcome(folder.path(), &manifest)?;
    let folder = folder.path().to_owned();
    Ok(Subject { folder, results: results.to_owned(), named: false, run: manifest.run })
}

/// The results folder in which `folder` is the place of `run`.
fn results_of<'a>(folder: &'a Path, run: &RunKey) -> Option<&'a Path> {
    // `runs` and what lies between it and a run.
    folder.ancestors().nth(1 + layout::DEPTH).filter(|results| layout::run_dir(results, run) == folder)
}

fn absolute(path: &Path) -> Result<PathBuf, HarnessError> {
    path.canonicalize().map_err(HarnessError::io(path, "find this folder"))
}
