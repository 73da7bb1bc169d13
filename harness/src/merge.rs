//! Bringing results of several machines together.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use reports::schema::{Manifest, Outcome};
use reports::store::{Results, RunFolder, layout};

use crate::error::HarnessError;
use crate::protocol::copy;
use crate::run::folder;
use crate::run::lock::is_locked;

/// What a merge did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Merged {
    /// Runs in the new folder.
    pub runs: usize,
    /// Runs that several sources had, with the same bytes.
    pub shared: usize,
}

/// A run in one of the sources.
struct Candidate {
    folder: RunFolder,
    manifest: Manifest,
    records: Vec<u8>,
    outcome: Option<Outcome>,
}

/// Copies the runs of all `sources` into the new folder `out`, which appears complete or not at all.
///
/// A run that several sources have must have the same config; its records must agree as far as both go, and
/// the one that has come further is taken.
///
/// # Errors
/// [`HarnessError::Conflict`] naming every conflicting run, [`HarnessError::Exists`] if `out` does, and
/// whatever keeps files from being read or written.
pub fn merge(sources: &[PathBuf], out: &Path) -> Result<Merged, HarnessError> {
    if out.exists() {
        return Err(HarnessError::Exists { folder: out.to_owned() });
    }
    let mut chosen: BTreeMap<String, Candidate> = BTreeMap::new();
    let mut conflicts = Vec::new();
    let mut shared = 0;
    for source in sources {
        let folders = Results::new(source).runs()?;
        if folders.is_empty() {
            let path = layout::runs_dir(source);
            return Err(HarnessError::Missing { path, reason: "holds no runs".into() });
        }
        for folder in folders {
            let found = read(folder)?;
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
    copy_all(&chosen, sources, out)?;
    Ok(Merged { runs: chosen.len(), shared })
}

fn read(folder: RunFolder) -> Result<Candidate, HarnessError> {
    let (manifest, _) = folder::read_manifest(folder.path())?;
    folder.check_place(&manifest)?;
    if is_locked(folder.path()) {
        // Its worker would change the files while they are copied.
        return Err(HarnessError::Locked { folder: folder.path().to_owned() });
    }
    let records = folder.bytes(layout::RECORDS)?.unwrap_or_default();
    let outcome = folder::outcome(folder.path(), &manifest)?;
    Ok(Candidate { folder, manifest, records, outcome })
}

fn conflict(a: &Candidate, b: &Candidate) -> Option<String> {
    let both = format!("{} and {}", a.folder.path().display(), b.folder.path().display());
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

/// Whether `a` has come further: a finished run has, then one with more records, then one that has failed.
fn is_further(a: &Candidate, b: &Candidate) -> bool {
    let rank = |found: &Candidate| {
        let finished = matches!(found.outcome, Some(Outcome::Finished { .. }));
        (finished, found.records.len(), found.outcome.is_some())
    };
    rank(a) > rank(b)
}

/// Copies into a temporary neighbour of `out`, then renames it.
fn copy_all(runs: &BTreeMap<String, Candidate>, sources: &[PathBuf], out: &Path) -> Result<(), HarnessError> {
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
        found.folder.copy_to(&layout::run_dir(fresh.path(), &found.manifest.run))?;
    }
    for source in sources {
        copy::bring(source, fresh.path())?;
    }
    fs::rename(fresh.path(), out).map_err(HarnessError::io(out, "create this folder"))?;
    // Renamed away: there is nothing left for the guard to remove.
    let _ = fresh.keep();
    Ok(())
}
