//! How far the runs of a results folder are: read from their folders alone, whoever carries them out.

use std::fs;
use std::path::{Path, PathBuf};

use reports::schema::{Crash, Outcome, Record, RunKey, Timing};
use reports::store::layout;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{HarnessError, chain};
use crate::run::folder;
use crate::run::lock::is_locked;

/// What a run is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Activity {
    /// Its budget is used up.
    Finished,
    /// It ended early, for the reason in its outcome.
    Failed,
    /// A worker is on it now.
    Running,
    /// It has begun and nobody is on it.
    Stopped,
    /// Its workers went away too often, or the last one did and nobody began another; it can go on.
    Crashed,
    /// Its files are not what they were.
    Damaged,
    /// It has not begun.
    Waiting,
}

/// The state of one run.
#[derive(Clone, Debug, Serialize)]
pub struct RunStatus {
    /// Which run.
    pub run: RunKey,
    /// What it is doing.
    pub activity: Activity,
    /// Training steps at its last evaluation.
    pub step: u64,
    /// Training steps it will take.
    pub steps: u64,
    /// Success rate of its last evaluation.
    pub success_rate: Option<f64>,
    /// Training steps per second up to its last evaluation.
    pub steps_per_s: Option<f64>,
    /// Seconds that it still needs at that speed.
    pub left_s: Option<f64>,
    /// Why it failed, crashed or counts as damaged.
    pub reason: Option<String>,
    /// Crashes of its workers.
    pub crashes: usize,
}

impl RunStatus {
    /// A run of which nothing else is known.
    fn new(run: RunKey, activity: Activity) -> Self {
        Self {
            run,
            activity,
            step: 0,
            steps: 0,
            success_rate: None,
            steps_per_s: None,
            left_s: None,
            reason: None,
            crashes: 0,
        }
    }
}

/// The state of every run in `results`, in the order of their folders.
///
/// # Errors
/// [`HarnessError`] if it is no results folder. A damaged run is no error: that is its state.
pub fn status(results: &Path) -> Result<Vec<RunStatus>, HarnessError> {
    let mut folders = find_runs(results)?;
    folders.sort();
    let state = |folder: &PathBuf| {
        run_status(folder).unwrap_or_else(|error| RunStatus {
            reason: Some(chain(&error)),
            ..RunStatus::new(key_of(folder), Activity::Damaged)
        })
    };
    Ok(folders.iter().map(state).collect())
}

/// The folders of `results` that hold a manifest.
///
/// # Errors
/// [`HarnessError::Io`] if a folder cannot be read.
pub fn find_runs(results: &Path) -> Result<Vec<PathBuf>, HarnessError> {
    /// Folders from `runs` to a run: environment, curriculum, variant, seed.
    const DEPTH: usize = 4;
    let mut found = Vec::new();
    let mut folders = vec![(layout::runs_dir(results), 0)];
    while let Some((folder, depth)) = folders.pop() {
        let unreadable = || HarnessError::io(&folder, "read this folder");
        for entry in fs::read_dir(&folder).map_err(unreadable())? {
            let path = entry.map_err(unreadable())?.path();
            if path.join(layout::MANIFEST).exists() {
                found.push(path);
            } else if depth + 1 < DEPTH && path.is_dir() {
                folders.push((path, depth + 1));
            }
        }
    }
    Ok(found)
}

/// The run whose place in a results folder `folder` is.
fn key_of(folder: &Path) -> RunKey {
    let mut names = folder.iter().rev().map(|name| name.to_string_lossy().into_owned());
    let seed = names.next().and_then(|name| name.strip_prefix("seed-")?.parse().ok());
    let [variant, curriculum, environment] = [(); 3].map(|()| names.next().unwrap_or_default());
    RunKey { environment, curriculum, variant, seed: seed.unwrap_or_default() }
}

fn run_status(folder: &Path) -> Result<RunStatus, HarnessError> {
    let (manifest, config) = folder::read_manifest(folder)?;
    let steps = config.budget.steps;
    let record: Option<Record> = last_line(&folder.join(layout::RECORDS));
    let timing: Option<Timing> = last_line(&folder.join(layout::TIMING));
    let (activity, reason) = match folder::outcome(folder, &manifest)? {
        Some(Outcome::Finished { .. }) => (Activity::Finished, None),
        Some(Outcome::Failed { reason, .. }) => (Activity::Failed, Some(reason)),
        None if is_locked(folder) => (Activity::Running, None),
        None => match last_crash(folder) {
            Some(reason) => (Activity::Crashed, Some(reason)),
            None if record.is_some() => (Activity::Stopped, None),
            None => (Activity::Waiting, None),
        },
    };
    let step = record.as_ref().map_or(0, |record| record.step);
    let speed = timing
        .filter(|timing| timing.step > 0 && timing.wall_s > 0.0)
        .map(|timing| timing.step as f64 / timing.wall_s);
    let unfinished = !matches!(activity, Activity::Finished | Activity::Failed);
    Ok(RunStatus {
        step,
        steps,
        success_rate: record.map(|record| record.success_rate),
        steps_per_s: speed,
        left_s: speed.filter(|_| unfinished).map(|speed| steps.saturating_sub(step) as f64 / speed),
        reason,
        crashes: fs::read_to_string(folder.join(layout::CRASHES)).map_or(0, |text| text.lines().count()),
        ..RunStatus::new(manifest.run, activity)
    })
}

/// The reason of a run's last crash, if nothing was recorded since.
fn last_crash(folder: &Path) -> Option<String> {
    let path = folder.join(layout::CRASHES);
    let changed = |path: &Path| fs::metadata(path).and_then(|file| file.modified()).ok();
    let crashed = changed(&path)?;
    let recorded = changed(&folder.join(layout::TIMING));
    let crash: Crash = last_line(&path)?;
    recorded.is_none_or(|recorded| recorded <= crashed).then_some(crash.reason)
}

/// The last complete line of a file; a line that is being written does not count yet.
fn last_line<T: DeserializeOwned>(path: &Path) -> Option<T> {
    let text = fs::read_to_string(path).ok()?;
    let complete = &text[..text.rfind('\n')?];
    serde_json::from_str(complete.lines().next_back()?).ok()
}
