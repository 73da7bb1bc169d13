//! Bringing results of several machines together.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use reports::schema::{Manifest, Outcome};
use reports::store::layout;

use crate::error::HarnessError;
use crate::run::checkpoint::{CHECKPOINT, REPLAY};
use crate::run::folder::{self, CHECKSUMS};
use crate::run::lock::is_locked;
use crate::status::find_runs;
use crate::tracking::EVENTS;

/// What a merge did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Merged {
    /// Runs in the new folder.
    pub runs: usize,
    /// Runs that several sources had, with the same bytes.
    pub shared: usize,
}

/// A run in one of the sources.
struct Found {
    folder: PathBuf,
    manifest: Manifest,
    records: Vec<u8>,
    outcome: Option<Outcome>,
}

/// Copies the runs of all `sources` into the new folder `out`, which appears complete or not at all.
///
/// A run that several sources have must have the same config; its records must agree as far as both go, and the
/// one that has come further is taken.
///
/// # Errors
/// [`HarnessError::Conflict`] naming every conflicting run, [`HarnessError::Argument`] if `out` exists, and whatever
/// keeps files from being read or written.
pub fn merge(sources: &[PathBuf], out: &Path) -> Result<Merged, HarnessError> {
    if out.exists() {
        let reason = format!("{} exists already; name a new folder", out.display());
        return Err(HarnessError::Argument { option: "--out", reason });
    }
    let mut chosen: BTreeMap<String, Found> = BTreeMap::new();
    let mut conflicts = Vec::new();
    let mut shared = 0;
    for source in sources {
        let folders = find_runs(source)?;
        if folders.is_empty() {
            let path = layout::runs_dir(source);
            return Err(HarnessError::Damaged { path, reason: "holds no runs".into() });
        }
        for folder in folders {
            let found = read(source, folder)?;
            let id = found.manifest.run.to_string();
            let Some(other) = chosen.get(&id) else {
                chosen.insert(id, found);
                continue;
            };
            shared += 1;
            match conflict(other, &found) {
                Some(reason) => conflicts.push(format!("{id}: {reason}")),
                None if is_further(&found, other) => {
                    chosen.insert(id, found);
                }
                None => {}
            }
        }
    }
    if !conflicts.is_empty() {
        return Err(HarnessError::Conflict { runs: conflicts.join("\n  ") });
    }
    copy_all(&chosen, out)?;
    Ok(Merged { runs: chosen.len(), shared })
}

fn read(source: &Path, folder: PathBuf) -> Result<Found, HarnessError> {
    let (manifest, _) = folder::read_manifest(&folder)?;
    if folder != layout::run_dir(source, &manifest.run) {
        let reason = format!("belongs to the run {}, which does not lie here", manifest.run);
        return Err(HarnessError::Damaged { path: folder.join(layout::MANIFEST), reason });
    }
    if is_locked(&folder) {
        // Its files do not stay together while they are copied.
        return Err(HarnessError::Locked { folder });
    }
    let records = folder.join(layout::RECORDS);
    let records = if records.exists() {
        fs::read(&records).map_err(HarnessError::io(&records, "read this file"))?
    } else {
        Vec::new()
    };
    let outcome = folder::outcome(&folder, &manifest)?;
    Ok(Found { folder, manifest, records, outcome })
}

fn conflict(a: &Found, b: &Found) -> Option<String> {
    let both = format!("{} and {}", a.folder.display(), b.folder.display());
    if a.manifest.hash != b.manifest.hash {
        return Some(format!("{both} have different configs"));
    }
    if a.outcome.is_some() && b.outcome.is_some() && a.outcome != b.outcome {
        return Some(format!("{both} ended differently"));
    }
    let common = a.records.len().min(b.records.len());
    if a.records[..common] != b.records[..common] {
        return Some(format!("{both} have the same config and different records"));
    }
    None
}

/// Further is who has finished, then who has recorded more, then who has failed there.
fn is_further(a: &Found, b: &Found) -> bool {
    let rank = |found: &Found| {
        let finished = matches!(found.outcome, Some(Outcome::Finished { .. }));
        (finished, found.records.len(), found.outcome.is_some())
    };
    rank(a) > rank(b)
}

/// Copies into a temporary neighbour of `out`, then renames it.
fn copy_all(runs: &BTreeMap<String, Found>, out: &Path) -> Result<(), HarnessError> {
    let parent = match out.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(parent).map_err(HarnessError::io(parent, "create this folder"))?;
    let fresh = tempfile::Builder::new()
        .prefix(".merge-")
        .permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777))
        .tempdir_in(parent)
        .map_err(HarnessError::io(parent, "write in this folder"))?;
    for found in runs.values() {
        copy_folder(&found.folder, &layout::run_dir(fresh.path(), &found.manifest.run))?;
    }
    fs::rename(fresh.path(), out).map_err(HarnessError::io(out, "create this folder"))?;
    // Renamed away: there is nothing left for the guard to remove.
    let _ = fresh.keep();
    Ok(())
}

/// Copies a run's folder: its files, and its replay log if it has one.
fn copy_folder(from: &Path, to: &Path) -> Result<(), HarnessError> {
    fs::create_dir_all(to).map_err(HarnessError::io(to, "create this folder"))?;
    let files = [
        layout::MANIFEST,
        layout::RECORDS,
        layout::TEACHING,
        layout::TIMING,
        layout::OUTCOME,
        CHECKSUMS,
        layout::CRASHES,
        layout::WORKER_LOG,
        CHECKPOINT,
        EVENTS,
    ];
    for name in files.iter().filter(|name| from.join(name).exists()) {
        let path = from.join(name);
        fs::copy(&path, to.join(name)).map_err(HarnessError::io(path, "copy this file"))?;
    }
    let replay = from.join(REPLAY);
    if replay.exists() {
        fs::create_dir_all(to.join(REPLAY)).map_err(HarnessError::io(to, "create this folder"))?;
        let unreadable = || HarnessError::io(&replay, "copy this folder");
        for entry in fs::read_dir(&replay).map_err(unreadable())? {
            let entry = entry.map_err(unreadable())?;
            fs::copy(entry.path(), to.join(REPLAY).join(entry.file_name())).map_err(unreadable())?;
        }
    }
    Ok(())
}
