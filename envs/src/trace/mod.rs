//! Playback of traces recorded from the original environments.
//!
//! A trace file is one gzipped JSON document per environment: `meta` (constants), `resets` (the random draws
//! of a reset in order, and what they lead to), `traces` (a start state, a goal, actions, and what they lead
//! to). [`verify_file`] repeats all of it on this crate's environments and measures the difference.

mod compare;
mod error;
mod format;
mod playback;
mod report;

use std::path::{Path, PathBuf};

pub use error::{Problem, TraceError};
pub use report::{Deviations, Divergence, FileReport, Place};

/// How the name of a trace file ends.
const EXTENSION: &str = ".json.gz";

/// Replays one trace file.
///
/// ```
/// let recording = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/MazeA.json.gz");
/// let report = envs::trace::verify_file(recording.as_ref())?;
/// assert!(report.passed() && report.deviations.observation < 1e-9);
/// # Ok::<(), envs::trace::TraceError>(())
/// ```
///
/// # Errors
/// [`TraceError`] if the file is damaged or does not fit the environment. Differing numbers are no error:
/// the report lists them.
pub fn verify_file(path: &Path) -> Result<FileReport, TraceError> {
    format::read(path)
        .and_then(|recording| playback::play_back(path, &recording))
        .map_err(|problem| at(path, problem))
}

/// Replays every trace file in `folder` and the folders below it, in the order of their names. One damaged
/// file does not keep the others from being verified.
///
/// ```
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
/// let error = envs::trace::verify_dir(folder.as_ref()).unwrap_err();
/// assert_eq!(error.problem.to_string(), "no file ends with .json.gz");
/// ```
///
/// # Errors
/// [`Problem::Read`] if a folder cannot be read, [`Problem::NoFiles`] if there is no trace file.
pub fn verify_dir(folder: &Path) -> Result<Vec<Result<FileReport, TraceError>>, TraceError> {
    let mut files = Vec::new();
    collect(folder, &mut files).map_err(|problem| at(folder, problem))?;
    files.sort();
    Ok(files.iter().map(|file| verify_file(file)).collect())
}

fn at(path: &Path, problem: Box<Problem>) -> TraceError {
    TraceError { file: path.to_owned(), problem }
}

/// The trace files in `root` and below.
fn collect(root: &Path, files: &mut Vec<PathBuf>) -> Result<(), Box<Problem>> {
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).map_err(Problem::Read)? {
            let entry = entry.map_err(Problem::Read)?;
            if entry.file_type().map_err(Problem::Read)?.is_dir() {
                folders.push(entry.path());
            } else if entry.file_name().to_string_lossy().ends_with(EXTENSION) {
                files.push(entry.path());
            }
        }
    }
    if files.is_empty() { Err(Problem::NoFiles.into()) } else { Ok(()) }
}
