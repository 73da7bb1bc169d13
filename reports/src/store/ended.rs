//! Whether an ended run is what it was when it ended: for readers that build on it.

use super::error::StoreError;
use super::load::Loader;
use super::problem::StoreProblem;
use super::{Results, RunFolder, check, checksums, layout};
use crate::schema::{Manifest, Outcome};

/// Checks that the run of `manifest` in `folder` has the files that it ended with, that they hold nothing
/// which no run records, and that it can have ended as `outcome` says.
///
/// # Errors
/// [`StoreError::Altered`] naming the file and what is wrong with it; any other [`StoreError`] if a file
/// cannot be read.
pub fn check_ended(folder: &RunFolder, manifest: &Manifest, outcome: &Outcome) -> Result<(), StoreError> {
    checksums::check_files(folder, manifest)?;
    let here = Results::new("");
    let mut loader = Loader::new(&here, folder);
    let records = check::records(&mut loader, manifest);
    if let Some(StoreProblem { path, line, fault }) = loader.into_problems().into_iter().next() {
        let line = line.map_or_else(String::new, |line| format!("line {line}: "));
        return Err(StoreError::Altered { path, reason: format!("{line}{}", fault.what()) });
    }
    let misfit = check::misfit(outcome, manifest, &records);
    misfit.map_or(Ok(()), |reason| Err(StoreError::Altered { path: folder.file(layout::OUTCOME), reason }))
}
