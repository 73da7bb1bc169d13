//! `checksums.json`: checksums of an ended run's records, so that a later change is noticed.

use std::collections::BTreeMap;

use reports::schema::Manifest;
use reports::store::layout::{self, CHECKSUMS};
use reports::store::{RunFolder, read_json};
use serde::{Deserialize, Serialize};

use crate::error::HarnessError;
use crate::files::write_json;

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
pub(super) fn write(folder: &RunFolder, run: &str) -> std::io::Result<()> {
    let sums = FILES.iter().map(|name| Ok(((*name).to_owned(), folder.sha256(name)?)));
    let sha256 = sums.collect::<std::io::Result<_>>()?;
    write_json(&folder.file(CHECKSUMS), &Checksums { run: run.to_owned(), sha256 })
}

/// Whether the ended run of `manifest` in `folder` still has the records that it ended with.
///
/// # Errors
/// [`HarnessError::Damaged`] naming the file that is missing, cut off, altered, or of another run.
pub(super) fn verify(folder: &RunFolder, manifest: &Manifest) -> Result<(), HarnessError> {
    let damaged = |name: &str, reason: &str| HarnessError::Damaged {
        path: folder.file(name),
        reason: format!("{reason}; delete this run's folder to train it anew"),
    };
    let noted: Checksums = read_json(&folder.file(CHECKSUMS))?
        .ok_or_else(|| damaged(CHECKSUMS, "is missing, though the run has ended"))?;
    if noted.run != manifest.hash {
        return Err(damaged(CHECKSUMS, "belongs to a run with another config"));
    }
    for name in FILES {
        if noted.sha256.get(name) != Some(&folder.sha256(name)?) {
            return Err(damaged(name, "was cut off or altered after the run ended"));
        }
    }
    Ok(())
}
