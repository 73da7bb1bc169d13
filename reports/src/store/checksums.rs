//! What an ended run was when it ended, so that a later change is noticed: `checksums.json`, and the hash of
//! the manifest. All readers check by these functions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::error::StoreError;
use super::{RunFolder, digest, layout, read_json};
use crate::schema::{Manifest, RunKey, SCHEMA};

/// The files that hold what a run found.
const FILES: [&str; 2] = [layout::RECORDS, layout::TEACHING];

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
    /// The checksums of the run in `folder`, whose manifest has the hash `run`; of the files that are there.
    ///
    /// # Errors
    /// [`StoreError::Io`] if a file cannot be read.
    pub fn of(folder: &RunFolder, run: &str) -> Result<Self, StoreError> {
        let there = FILES.into_iter().filter(|name| folder.has(name));
        let sums = there.map(|name| Ok((name.to_owned(), folder.sha256(name)?)));
        Ok(Self { run: run.to_owned(), sha256: sums.collect::<Result<_, StoreError>>()? })
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
    Err(StoreError::Altered { path: folder.file(layout::MANIFEST), reason })
}

/// Checks that the ended run of `manifest` in `folder` still has the files that it ended with.
///
/// # Errors
/// [`StoreError::Altered`] naming the file that is missing, cut off, altered, or of another run; any other
/// [`StoreError`] if one cannot be read.
pub fn check_ended(folder: &RunFolder, manifest: &Manifest) -> Result<(), StoreError> {
    let altered = |name: &str, reason| StoreError::Altered { path: folder.file(name), reason };
    let noted: Checksums = read_json(&folder.file(layout::CHECKSUMS))?
        .ok_or_else(|| altered(layout::CHECKSUMS, "is missing, though the run has ended"))?;
    if !is_hash_of(&noted.run, manifest) {
        return Err(altered(layout::CHECKSUMS, "belongs to a run with another config"));
    }
    for name in FILES {
        let sum = noted.sha256.get(name);
        // Old versions did not record what teachers did.
        let never_was = sum.is_none() && name != layout::RECORDS && !folder.has(name);
        if !never_was && sum != Some(&folder.sha256(name)?) {
            return Err(altered(name, "was cut off or altered after the run ended"));
        }
    }
    Ok(())
}
