//! What an ended run was when it ended, so that a later change is noticed: `checksums.json`, and the hash of
//! the manifest. All readers check by these functions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::error::StoreError;
use super::{RunFolder, digest, layout, read_json};
use crate::schema::{Manifest, RunKey, SCHEMA};

/// The files that hold what a run found: without one of them it is not what it was.
const FOUND: [&str; 5] =
    [layout::RECORDS, layout::TEACHING, layout::STUDENT, layout::FRONTIER, layout::SHADOW];

/// SHA-256, in hex, of schema, run and config: a manifest's hash. Versions are not part of it: they are
/// recorded, not compared.
pub fn manifest_hash(run: &RunKey, config: &Value) -> String {
    let text = json!({ "schema": SCHEMA, "run": run, "config": config }).to_string();
    digest::sha256(text.as_bytes())
}

/// Whether `hash` is that of `manifest`, or was before the run was trained on with a larger budget.
pub fn is_hash_of(hash: &str, manifest: &Manifest) -> bool {
    let before = |&steps: &u64| {
        let mut config = manifest.config.clone();
        if let Some(budget) = config.pointer_mut("/budget/steps") {
            *budget = steps.into();
        }
        hash == manifest_hash(&manifest.run, &config)
    };
    hash == manifest.hash || manifest.earlier_budgets.iter().any(before)
}

/// Content of `checksums.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checksums {
    /// Hash of the run's manifest.
    run: String,
    /// SHA-256 of each file, in hex, by name.
    sha256: BTreeMap<String, String>,
}

impl Checksums {
    /// Those that the ended run in `folder` noted.
    ///
    /// # Errors
    /// [`StoreError::Altered`] if they are missing, any other if they cannot be read.
    pub fn noted(folder: &RunFolder) -> Result<Self, StoreError> {
        let noted = read_json(&folder.file(layout::CHECKSUMS))?;
        noted.ok_or_else(|| altered(folder, layout::CHECKSUMS, "is missing, though the run has ended"))
    }

    /// The checksums of the run in `folder`, whose manifest has the hash `run`; of the files that are there.
    ///
    /// # Errors
    /// [`StoreError::Io`] if a file cannot be read.
    pub fn of(folder: &RunFolder, run: &str) -> Result<Self, StoreError> {
        let mut sha256 = BTreeMap::new();
        for name in FOUND.into_iter().chain([layout::TIMING, layout::OUTCOME]) {
            if folder.has(name)? {
                sha256.insert(name.to_owned(), folder.sha256(name)?);
            }
        }
        Ok(Self { run: run.to_owned(), sha256 })
    }

    /// The same without the files of these names, which nobody misses from then on.
    pub fn without(mut self, names: &[&str]) -> Self {
        self.sha256.retain(|name, _| !names.contains(&name.as_str()));
        self
    }

    /// The same with an outcome of `bytes`, which is written after them.
    pub fn with_outcome(mut self, bytes: &[u8]) -> Self {
        self.sha256.insert(layout::OUTCOME.to_owned(), digest::sha256(bytes));
        self
    }

    /// Checks one file of which old versions noted no checksum: without one it passes.
    fn check_if_noted(&self, folder: &RunFolder, name: &str) -> Result<(), StoreError> {
        if self.sha256.contains_key(name) { self.check(folder, name) } else { Ok(()) }
    }

    /// Checks one file.
    fn check(&self, folder: &RunFolder, name: &str) -> Result<(), StoreError> {
        if self.sha256.get(name) == Some(&folder.sha256(name)?) {
            return Ok(());
        }
        Err(altered(folder, name, "was cut off or altered after the run ended"))
    }
}

/// Checks that `manifest`, read in `folder`, was not altered.
///
/// # Errors
/// [`StoreError::Altered`].
pub fn check_manifest(folder: &RunFolder, manifest: &Manifest) -> Result<(), StoreError> {
    if manifest_hash(&manifest.run, &manifest.config) == manifest.hash {
        return Ok(());
    }
    let reason = "its hash does not fit its config: it was altered after it was written";
    Err(altered(folder, layout::MANIFEST, reason))
}

/// Checks that the ended run of `manifest` in `folder` still has the files that it ended with.
///
/// # Errors
/// [`StoreError::Altered`] naming the file that is missing, cut off, altered, or of another run; any other
/// [`StoreError`] if one cannot be read.
pub(super) fn check_files(folder: &RunFolder, manifest: &Manifest) -> Result<(), StoreError> {
    let noted = Checksums::noted(folder)?;
    if !is_hash_of(&noted.run, manifest) {
        return Err(altered(folder, layout::CHECKSUMS, "belongs to a run with another config"));
    }
    for name in FOUND {
        // Old versions did not record what teachers did, nor how students learned; measures of the frontier
        // are made on request, as shadows are.
        let never_was = !noted.sha256.contains_key(name) && name != layout::RECORDS && !folder.has(name)?;
        if !never_was {
            noted.check(folder, name)?;
        }
    }
    noted.check_if_noted(folder, layout::OUTCOME)
}

/// Checks that an ended run in `folder` still has the timings that it ended with. What it found holds without
/// them: whoever shows times checks this, and goes on without the times.
///
/// # Errors
/// As `check_files`. Old versions noted no checksum of timings: those pass.
pub fn check_timings(folder: &RunFolder) -> Result<(), StoreError> {
    Checksums::noted(folder)?.check_if_noted(folder, layout::TIMING)
}

fn altered(folder: &RunFolder, name: &str, reason: &'static str) -> StoreError {
    StoreError::Altered { path: folder.file(name), reason: reason.to_owned() }
}
