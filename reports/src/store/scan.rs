//! Finding and loading the folders of runs.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::{Run, check, lines};
use crate::error::ReportError;
use crate::schema::{Crash, Manifest, Outcome, Record, SCHEMA, Timing};
use crate::store::layout;
use crate::store::problem::{Fault, Problem};

/// Folders between `runs/` and the files of a run: environment, curriculum, variant, seed.
const DEPTH: usize = 4;
const BELOW_RUNS: &str = "folders ENVIRONMENT/CURRICULUM/VARIANT/seed-N";

/// The folders of all runs, sorted, and what else lies about under `runs/`.
pub(super) fn run_folders(results: &Path) -> Result<(Vec<PathBuf>, Vec<Problem>), ReportError> {
    if !results.is_dir() {
        return Err(ReportError::NotFound { path: results.to_owned() });
    }
    let runs = layout::runs_dir(results);
    if !runs.is_dir() {
        return Err(ReportError::NotResults { path: results.to_owned() });
    }
    let mut problems = Vec::new();
    let mut level = children(&runs).map_err(ReportError::io(&runs, "list this folder"))?;
    for depth in 1..=DEPTH {
        let mut below = Vec::new();
        for path in level {
            if !path.is_dir() {
                problems.push(problem(results, &path, Fault::Stray { expected: BELOW_RUNS }));
            } else if depth == DEPTH {
                below.push(path);
            } else {
                match children(&path) {
                    Ok(found) => below.extend(found),
                    Err(error) => problems.push(problem(results, &path, unreadable(&error))),
                }
            }
        }
        level = below;
    }
    if level.is_empty() && problems.is_empty() {
        return Err(ReportError::NotResults { path: results.to_owned() });
    }
    Ok((level, problems))
}

/// Loads the run in `folder`. There is no run without a manifest of this folder and of this schema.
pub(super) fn load(results: &Path, folder: &Path) -> (Option<Run>, Vec<Problem>) {
    let mut problems = Vec::new();
    let Some(manifest) = load_manifest(results, folder, &mut problems) else {
        return (None, problems);
    };
    let records_path = folder.join(layout::RECORDS);
    let records: Vec<(usize, Record)> = load_lines(results, &records_path, "evaluation", &mut problems);
    let timings_path = folder.join(layout::TIMING);
    let timings: Vec<(usize, Timing)> = load_lines(results, &timings_path, "timing", &mut problems);
    let outcome_path = folder.join(layout::OUTCOME);
    let outcome: Option<Outcome> = load_json(results, &outcome_path, "outcome", &mut problems);

    let records = check::records(records, &manifest.run, relative(results, &records_path), &mut problems);
    let timings = check::timings(timings, relative(results, &timings_path), &mut problems);
    let last_step = records.last().map(|record| record.step);
    check::outcome(outcome.as_ref(), last_step, relative(results, &outcome_path), &mut problems);
    if outcome.is_none() {
        let path = folder.join(layout::CRASHES);
        let crashes: Vec<(usize, Crash)> = load_lines(results, &path, "crash", &mut problems);
        problems.extend(crashes.into_iter().map(|(line, Crash { attempt, reason })| Problem {
            path: relative(results, &path).to_owned(),
            line: Some(line),
            fault: Fault::Crashed { attempt, reason },
        }));
    }
    (Some(Run { manifest, records, timings, outcome }), problems)
}

fn load_manifest(results: &Path, folder: &Path, problems: &mut Vec<Problem>) -> Option<Manifest> {
    let path = folder.join(layout::MANIFEST);
    if !path.is_file() {
        problems.push(problem(results, folder, Fault::NoManifest));
        return None;
    }
    let manifest: Manifest = load_json(results, &path, "manifest", problems)?;
    if manifest.schema != SCHEMA {
        let fault = Fault::Schema { found: manifest.schema, expected: SCHEMA };
        problems.push(problem(results, &path, fault));
        return None;
    }
    if layout::run_dir(results, &manifest.run) != folder {
        problems.push(problem(results, &path, Fault::Misplaced { found: manifest.run }));
        return None;
    }
    Some(manifest)
}

/// Reads a file that a run writes later or not at all.
fn read_optional(results: &Path, path: &Path, problems: &mut Vec<Problem>) -> Option<Vec<u8>> {
    match fs::read(path) {
        Ok(bytes) => Some(bytes),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => {
            problems.push(problem(results, path, unreadable(&error)));
            None
        }
    }
}

fn load_json<T: DeserializeOwned>(
    results: &Path,
    path: &Path,
    expected: &'static str,
    problems: &mut Vec<Problem>,
) -> Option<T> {
    let bytes = read_optional(results, path, problems)?;
    match serde_json::from_slice(&bytes) {
        Ok(value) => Some(value),
        Err(error) => {
            let fault = Fault::Malformed { expected, reason: error.to_string() };
            problems.push(problem(results, path, fault));
            None
        }
    }
}

pub(super) fn load_lines<T: DeserializeOwned>(
    results: &Path,
    path: &Path,
    expected: &'static str,
    problems: &mut Vec<Problem>,
) -> Vec<(usize, T)> {
    match read_optional(results, path, problems) {
        Some(bytes) => lines::parse(&bytes, relative(results, path), expected, problems),
        None => Vec::new(),
    }
}

/// The entries of a folder, sorted by name; hidden ones (of editors and file managers) are left out.
fn children(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if !entry.file_name().as_encoded_bytes().starts_with(b".") {
            found.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}

fn unreadable(error: &std::io::Error) -> Fault {
    Fault::Unreadable { reason: error.to_string() }
}

fn problem(results: &Path, path: &Path, fault: Fault) -> Problem {
    Problem { path: relative(results, path).to_owned(), line: None, fault }
}

pub(super) fn relative<'a>(results: &Path, path: &'a Path) -> &'a Path {
    path.strip_prefix(results).unwrap_or(path)
}
