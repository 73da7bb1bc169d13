//! The folder of one run: what state it is in, and how it is written.

mod recorder;

use std::fs;
use std::path::Path;

use reports::schema::{Manifest, Outcome};
use reports::store::layout::{self, Lives};
pub use reports::store::read_json;
use reports::store::{RunFolder, StoreError, checksums};

use super::manifest::{self, differences};
use crate::config::RunConfig;
use crate::error::{HarnessError, ManifestError};
use crate::files::write_json;
pub use recorder::{Extent, Recorder};

/// What a run's folder holds.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// Nothing yet.
    New,
    /// A run with this config that has not ended.
    Begun,
    /// A run with this config that has ended.
    Ended(Outcome),
}

/// Looks at `folder` for the run that `wanted` describes; changes nothing.
///
/// # Errors
/// [`HarnessError::OtherConfig`] if the folder holds a run with another config or another version of the
/// curriculum, or an unfinished one of another program; [`HarnessError::Damaged`], [`HarnessError::Manifest`]
/// or [`HarnessError::Store`] if its files are not what they were.
pub fn inspect(folder: &Path, wanted: &Manifest) -> Result<State, HarnessError> {
    let run = RunFolder::new(folder);
    let path = run.file(layout::MANIFEST);
    let Some(found) = run.manifest()? else {
        let mut left = [layout::RECORDS, layout::OUTCOME, layout::CHECKPOINT].into_iter();
        return match left.find(|name| run.has(name)) {
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
    let other = |differences| HarnessError::OtherConfig { folder: folder.to_owned(), differences };
    if found.config != wanted.config {
        return Err(other(differences(&found.config, &wanted.config)));
    }
    manifest::config(&found).map_err(damaged)?;
    if let Some(differences) = manifest::other_curriculum(&found, wanted) {
        return Err(other(differences));
    }
    let outcome = outcome(folder, &found)?;
    if outcome.is_none() {
        check_program(folder, &found, wanted)?;
    }
    Ok(outcome.map_or(State::Begun, State::Ended))
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
    if outcome.is_some() {
        checksums::check_ended(&run, manifest).map_err(anew)?;
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
    write_json(&folder.join(layout::MANIFEST), manifest)
        .map_err(HarnessError::io(folder, "write the manifest"))
}
