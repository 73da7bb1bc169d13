//! The folder of one run: what state it is in, and how it is written.

mod check;
mod recorder;

use std::fs;
use std::path::Path;

use reports::schema::{Manifest, Outcome};
use reports::store::layout::{self, Lives};
pub use reports::store::read_json;
use reports::store::{RunFolder, StoreError, check_ended};

use super::lock::{Lock, is_locked};
use super::manifest::{self, differences};
use crate::config::RunConfig;
use crate::error::{HarnessError, ManifestError};
use crate::files::write_json;
pub use check::{Sound, check, check_beginning};
pub use recorder::{CommonExtent, Extent, MeasuredExtent, Recorder};

/// What a run's folder holds.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// Nothing yet, or a run that never began.
    New,
    /// A run with this config but for its budget, which is smaller: this many training steps.
    Shorter(u64),
    /// A run with this config that has not ended.
    Begun,
    /// A run with this config that has ended.
    Ended(Outcome),
}

/// Looks at `folder` for the run that `wanted` describes; changes nothing.
///
/// A run that never began, because its sweep was stopped before, blocks no other config.
///
/// # Errors
/// [`HarnessError::OtherConfig`] if the folder holds a run with another config or another version of the
/// curriculum, or an unfinished one of another program; [`HarnessError::Damaged`], [`HarnessError::Manifest`]
/// or [`HarnessError::Store`] if its files are not what they were.
pub fn inspect(folder: &Path, wanted: &Manifest) -> Result<State, HarnessError> {
    let run = RunFolder::new(folder);
    let path = run.file(layout::MANIFEST);
    let Some(found) = run.manifest()? else {
        return match run.leftover()? {
            None => Ok(State::New),
            Some(left) => Err(HarnessError::Damaged {
                path,
                reason: format!(
                    "is missing, though there is {}; delete this run's folder to train it anew",
                    run.file(left).display()
                ),
            }),
        };
    };
    let damaged = |source| HarnessError::Manifest { path: path.clone(), source };
    if found.run != wanted.run {
        let (found, wanted) = (Box::new(found.run), Box::new(wanted.run.clone()));
        return Err(damaged(ManifestError::OtherRun { found, wanted }));
    }
    let shorter = manifest::smaller_budget(&found, wanted);
    let is_other = found.config != wanted.config || manifest::other_program(&found, wanted).is_some();
    if is_other && !has_begun(&run)? && !is_locked(folder)? {
        return Ok(State::New);
    }
    let other = |differences| HarnessError::OtherConfig { folder: folder.to_owned(), differences };
    if found.config != wanted.config && shorter.is_none() {
        return Err(other(differences(&found.config, &wanted.config)));
    }
    manifest::config(&found).map_err(damaged)?;
    if let Some(differences) = manifest::other_curriculum(&found, wanted) {
        return Err(other(differences));
    }
    let outcome = outcome(folder, &found)?;
    if outcome.is_none() || shorter.is_some() {
        check_program(folder, &found, wanted)?;
    }
    Ok(match (shorter, outcome) {
        (Some(steps), _) => State::Shorter(steps),
        (None, Some(outcome)) => State::Ended(outcome),
        (None, None) => State::Begun,
    })
}

/// Removes the folder of a run that never began, and the folders above it that are empty then, below
/// `results`.
///
/// # Errors
/// [`HarnessError::Store`] or [`HarnessError::Io`] if its files cannot be looked at or removed.
pub fn forget(folder: &Path, results: &Path) -> Result<(), HarnessError> {
    let run = RunFolder::new(folder);
    if has_begun(&run)? || is_locked(folder)? {
        return Ok(());
    }
    // The manifest goes first: what is left without it is no run.
    [Lives::Always, Lives::UntilReopened, Lives::UntilDiscarded]
        .into_iter()
        .try_for_each(|lives| run.remove(lives))?;
    let above = folder.ancestors().take_while(|above| *above != results);
    // Others may lie in one of them.
    let _ = above.map(fs::remove_dir).take_while(Result::is_ok).count();
    Ok(())
}

/// Whether the run has recorded anything.
///
/// # Errors
/// [`StoreError`] if nobody can tell.
pub fn has_begun(run: &RunFolder) -> Result<bool, StoreError> {
    Ok(run.has_content(layout::RECORDS)? || run.has(layout::CHECKPOINT)? || run.has(layout::OUTCOME)?)
}

/// Refuses a run of another version of the program: going on would mix what two programs computed.
fn check_program(folder: &Path, found: &Manifest, wanted: &Manifest) -> Result<(), HarnessError> {
    manifest::other_program(found, wanted).map_or(Ok(()), |differences| {
        Err(HarnessError::OtherConfig { folder: folder.to_owned(), differences })
    })
}

/// How the run of `manifest` in `folder` ended, its records verified; `None` if it has not.
///
/// # Errors
/// [`HarnessError::Damaged`] or [`HarnessError::Store`] if its files are not what they were when it ended.
pub fn outcome(folder: &Path, manifest: &Manifest) -> Result<Option<Outcome>, HarnessError> {
    let run = RunFolder::new(folder);
    let outcome = run.outcome()?;
    if let Some(outcome) = &outcome {
        check_ended(&run, manifest, outcome).map_err(anew)?;
    }
    Ok(outcome)
}

/// An altered run, with what to do about it.
fn anew(error: StoreError) -> HarnessError {
    match error {
        StoreError::Altered { path, reason } => HarnessError::Damaged {
            path,
            reason: format!("{reason}; delete this run's folder to train it anew"),
        },
        error => error.into(),
    }
}

/// Turns a failed run, which `wanted` describes, back into an unfinished one: it goes on from its checkpoint
/// if it has one.
///
/// # Errors
/// [`HarnessError::OtherConfig`] if another version of the program began it, [`HarnessError::Store`] if its
/// files cannot be removed.
pub fn reopen(folder: &Path, wanted: &Manifest) -> Result<(), HarnessError> {
    check_program(folder, &read_manifest(folder)?.0, wanted)?;
    Ok(RunFolder::new(folder).remove(Lives::UntilReopened)?)
}

/// Lets the run in `folder` train on to the larger budget of `wanted`. It must have been looked at before:
/// its state was [`State::Shorter`].
///
/// A kill at any moment leaves one of two sound states: the run as it was, at most without its outcome, which
/// its checkpoint brings back; or the run with its new budget, unfinished. One that failed stays failed.
///
/// # Errors
/// [`HarnessError::Locked`] if a process is carrying it out; whatever keeps its files from being read or
/// written.
pub fn extend(folder: &Path, wanted: &Manifest) -> Result<(), HarnessError> {
    let _lock = Lock::take(folder)?;
    let (found, config) = read_manifest(folder)?;
    let run = RunFolder::new(folder);
    if let Some(Outcome::Finished { .. }) = outcome(folder, &found)? {
        run.remove(Lives::UntilReopened)?;
    }
    write_manifest(folder, &manifest::extended(found, config.budget.steps, wanted))
}

/// The manifest in a run's folder, with its config.
///
/// # Errors
/// [`HarnessError::Manifest`] or [`HarnessError::Store`] if there is none, or it is not what was written.
pub fn read_manifest(folder: &Path) -> Result<(Manifest, RunConfig), HarnessError> {
    let run = RunFolder::new(folder);
    let damaged = |source| HarnessError::Manifest { path: run.file(layout::MANIFEST), source };
    let manifest = run.manifest()?.ok_or_else(|| damaged(ManifestError::Missing))?;
    let config = manifest::config(&manifest).map_err(damaged)?;
    Ok((manifest, config))
}

/// Creates the folder with its manifest.
///
/// # Errors
/// [`HarnessError::Io`] naming the folder.
pub fn create(folder: &Path, manifest: &Manifest) -> Result<(), HarnessError> {
    fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
    write_manifest(folder, manifest)
}

fn write_manifest(folder: &Path, manifest: &Manifest) -> Result<(), HarnessError> {
    write_json(&folder.join(layout::MANIFEST), manifest)
        .map_err(HarnessError::io(folder, "write the manifest"))
}
