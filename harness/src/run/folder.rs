//! The folder of one run: what state it is in, and how it is written.

mod checksums;
mod recorder;

use std::fs::{self, Permissions};
use std::io::{ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

use reports::schema::{Manifest, Outcome};
use reports::store::layout;
use serde::Serialize;
use serde::de::DeserializeOwned;
use tempfile::NamedTempFile;

use super::checkpoint::CHECKPOINT;
use super::manifest::{self, differences};
use crate::config::RunConfig;
use crate::error::HarnessError;
pub use checksums::CHECKSUMS;
pub use recorder::{Progress, Recorder};

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
/// [`HarnessError::OtherConfig`] if the folder holds a run with another config, or an unfinished one of another version of
/// the program; [`HarnessError::Damaged`] if its files are not what they were.
pub fn inspect(folder: &Path, wanted: &Manifest) -> Result<State, HarnessError> {
    let path = folder.join(layout::MANIFEST);
    let Some(found) = read_json::<Manifest>(&path)? else {
        let left = [layout::RECORDS, layout::OUTCOME, CHECKPOINT].into_iter();
        return match left.map(|name| folder.join(name)).find(|path| path.exists()) {
            None => Ok(State::New),
            Some(left) => Err(HarnessError::Damaged {
                path,
                reason: format!(
                    "is missing, though there is {}; delete this run's folder to train it anew",
                    left.display()
                ),
            }),
        };
    };
    let damaged = |reason| HarnessError::Damaged { path: path.clone(), reason };
    if found.run != wanted.run {
        return Err(damaged(format!("belongs to the run {}, not to {}", found.run, wanted.run)));
    }
    let other = |differences| HarnessError::OtherConfig { folder: folder.to_owned(), differences };
    if found.config != wanted.config {
        return Err(other(differences(&found.config, &wanted.config)));
    }
    manifest::config(&found).map_err(damaged)?;
    let outcome = outcome(folder, &found)?;
    if outcome.is_none() {
        check_program(folder, &found)?;
    }
    Ok(outcome.map_or(State::Begun, State::Ended))
}

/// Refuses a run of another version of the program: going on would mix what two programs computed.
fn check_program(folder: &Path, manifest: &Manifest) -> Result<(), HarnessError> {
    manifest::other_program(manifest).map_or(Ok(()), |differences| {
        Err(HarnessError::OtherConfig { folder: folder.to_owned(), differences })
    })
}

/// How the run of `manifest` in `folder` ended, its records verified; `None` if it has not.
///
/// # Errors
/// [`HarnessError::Damaged`] if its files are not what they were when it ended.
pub fn outcome(folder: &Path, manifest: &Manifest) -> Result<Option<Outcome>, HarnessError> {
    let outcome = read_json::<Outcome>(&folder.join(layout::OUTCOME))?;
    if outcome.is_some() {
        checksums::verify(folder, manifest)?;
    }
    Ok(outcome)
}

/// Makes a run that failed an unfinished one again: it goes on from its checkpoint, if it has one.
///
/// # Errors
/// [`HarnessError::OtherConfig`] if another version of the program began it, [`HarnessError::Io`] if its files cannot be removed.
pub fn reopen(folder: &Path) -> Result<(), HarnessError> {
    check_program(folder, &read_manifest(folder)?.0)?;
    // The outcome first: without it, checksums are not looked at.
    for name in [layout::OUTCOME, CHECKSUMS] {
        let path = folder.join(name);
        fs::remove_file(&path).map_err(HarnessError::io(path, "remove this file"))?;
    }
    Ok(())
}

/// The manifest in a run's folder, with its config.
///
/// # Errors
/// [`HarnessError::Damaged`] if there is none, or it is not what was written.
pub fn read_manifest(folder: &Path) -> Result<(Manifest, RunConfig), HarnessError> {
    let path = folder.join(layout::MANIFEST);
    let damaged = |reason| HarnessError::Damaged { path: path.clone(), reason };
    let manifest: Manifest = read_json(&path)?.ok_or_else(|| damaged("there is no manifest".into()))?;
    let config = manifest::config(&manifest).map_err(damaged)?;
    Ok((manifest, config))
}

/// Reads a JSON file; `None` if there is none.
///
/// # Errors
/// [`HarnessError::Damaged`] if it is something else than expected.
pub fn read_json<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, HarnessError> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        // A path that leads through a file is told when the folder is to be created.
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(None);
        }
        Err(source) => {
            return Err(HarnessError::Io { path: path.to_owned(), action: "read this file", source });
        }
    };
    serde_json::from_str(&text).map(Some).map_err(|error| HarnessError::Damaged {
        path: path.to_owned(),
        reason: format!("was cut off or altered ({error}); delete the folder that it lies in to begin anew"),
    })
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

/// A temporary file in `folder`, to be renamed into place; as readable as any other new file (the umask applies),
/// because results folders are shared.
///
/// # Errors
/// If it cannot be created.
pub fn new_file(folder: &Path) -> std::io::Result<NamedTempFile> {
    tempfile::Builder::new().permissions(Permissions::from_mode(0o666)).tempfile_in(folder)
}

/// Writes `value` as pretty JSON, whole or not at all.
///
/// # Errors
/// If it cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> std::io::Result<()> {
    let mut file = new_file(path.parent().expect("a file lies in a folder"))?;
    serde_json::to_writer_pretty(&mut file, value)?;
    file.write_all(b"\n")?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}
