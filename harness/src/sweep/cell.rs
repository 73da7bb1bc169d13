//! One config per cell: the runs of one environment, curriculum and variant differ in their seeds alone, also
//! those that other commands left in the results folder.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use reports::schema::Manifest;
use reports::store::RunFolder;

use super::job::Job;
use super::slurm;
use crate::error::HarnessError;
use crate::run::folder::{self, State};
use crate::run::lock::is_locked;
use crate::run::manifest::differences;

/// Refuses a plan whose cells hold other seeds with another config.
///
/// # Errors
/// [`HarnessError::OtherConfig`] naming the first of them and the differences.
pub(super) fn check(jobs: &[Job]) -> Result<(), HarnessError> {
    for (run, found, job) in others(jobs)? {
        if folder::has_begun(&run)? || is_locked(run.path())? {
            let differences = differences(&found.config, &job.manifest.config);
            return Err(HarnessError::OtherConfig { folder: run.path().to_owned(), differences });
        }
    }
    Ok(())
}

/// Forgets the runs of the plan's cells that another command planned with another config and that never
/// began.
///
/// # Errors
/// [`HarnessError::Queued`] if a job array of that command is still in the queue; whatever keeps a folder
/// from being removed.
pub(super) fn forget_unbegun(results: &Path, jobs: &[Job]) -> Result<(), HarnessError> {
    let others: Vec<RunFolder> = others(jobs)?.into_iter().map(|(run, ..)| run).collect();
    let planned = jobs.iter().filter(|job| job.state == State::New).map(|job| RunFolder::new(&job.folder));
    let unbegun: Vec<RunFolder> = planned.filter(|run| run.path().exists()).chain(others).collect();
    if unbegun.is_empty() {
        return Ok(());
    }
    slurm::check_queue(results)?;
    unbegun.iter().try_for_each(|run| folder::forget(run.path(), results))
}

/// The runs in the cells of `jobs` that are none of them and have another config, each with its manifest and
/// one of the jobs of its cell. What cannot be read is left to `goalbench status`, which names it.
fn others(jobs: &[Job]) -> Result<Vec<(RunFolder, Manifest, &Job)>, HarnessError> {
    let planned: BTreeSet<&Path> = jobs.iter().map(|job| job.folder.as_path()).collect();
    let cells: BTreeMap<&Path, &Job> =
        jobs.iter().filter_map(|job| Some((job.folder.parent()?, job))).collect();
    let mut found = Vec::new();
    for (cell, job) in cells {
        let paths = guard::files::entries(cell).map_err(HarnessError::io(cell, "read this folder"))?;
        for path in paths.into_iter().flatten() {
            let run = RunFolder::new(&path);
            if planned.contains(path.as_path()) || run.key().is_none() {
                continue;
            }
            let Ok(Some(manifest)) = run.manifest() else { continue };
            if manifest.config != job.manifest.config {
                found.push((run, manifest, job));
            }
        }
    }
    Ok(found)
}
