//! `checksums.json`: what the records of an ended run were when it ended, so that a later change is noticed.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use reports::schema::Manifest;
use reports::store::layout;
use serde::{Deserialize, Serialize};

use super::{read_json, write_json};
use crate::error::HarnessError;
use crate::sha256::hex;

/// Name of the file in a run's folder.
pub const CHECKSUMS: &str = "checksums.json";

/// The files that hold what a run found.
const FILES: [&str; 2] = [layout::RECORDS, layout::TEACHING];

/// The file's content.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Checksums {
    /// Hash of the run's manifest.
    run: String,
    /// SHA-256 of each file, in hex, by name.
    sha256: BTreeMap<String, String>,
}

/// Notes the checksums of the run with manifest hash `run` in `folder`.
///
/// # Errors
/// If a file cannot be read or the checksums cannot be written.
pub(super) fn write(folder: &Path, run: &str) -> std::io::Result<()> {
    let sums = FILES.iter().map(|name| Ok((name.to_string(), hex(&fs::read(folder.join(name))?))));
    let sha256 = sums.collect::<std::io::Result<_>>()?;
    write_json(&folder.join(CHECKSUMS), &Checksums { run: run.to_owned(), sha256 })
}

/// Whether the ended run of `manifest` in `folder` still has the records that it ended with.
///
/// # Errors
/// [`HarnessError::Damaged`] naming the file that is missing, cut off, altered, or of another run.
pub(super) fn verify(folder: &Path, manifest: &Manifest) -> Result<(), HarnessError> {
    let damaged = |name: &str, reason: &str| HarnessError::Damaged {
        path: folder.join(name),
        reason: format!("{reason}; delete this run's folder to train it anew"),
    };
    let noted: Checksums = read_json(&folder.join(CHECKSUMS))?
        .ok_or_else(|| damaged(CHECKSUMS, "is missing, though the run has ended"))?;
    if noted.run != manifest.hash {
        return Err(damaged(CHECKSUMS, "belongs to a run with another config"));
    }
    for name in FILES {
        let bytes =
            fs::read(folder.join(name)).map_err(HarnessError::io(folder.join(name), "read this file"))?;
        if noted.sha256.get(name) != Some(&hex(&bytes)) {
            return Err(damaged(name, "was cut off or altered after the run ended"));
        }
    }
    Ok(())
}
