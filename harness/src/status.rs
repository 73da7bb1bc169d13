//! How far the runs of a results folder are: read from their folders alone, whoever carries them out.

use std::path::Path;

use rayon::prelude::*;
use reports::schema::{Manifest, Outcome, Record, RunKey};
use reports::store::problem::StoreProblem;
use reports::store::{Results, RunFolder, StoreError, Survey, checksums, layout};
use serde::Serialize;

use crate::config::RunConfig;
use crate::error::{HarnessError, chain};
use crate::pace;
use crate::run::folder::{self, Sound};
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
    /// Its last worker crashed, or too many did, and no evaluation was recorded since; it can go on.
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

/// What a results folder holds.
#[derive(Clone, Debug)]
pub struct Overview {
    /// The state of every run, in the order of their folders.
    pub runs: Vec<RunStatus>,
    /// What else lies where runs belong, such as a copied folder `seed-0 (copy)`.
    pub strays: Vec<StoreProblem>,
    /// The trials of a search, which lie in a results folder of their own.
    pub trials: Option<TrialsOverview>,
}

/// How far a search is.
#[derive(Clone, Debug)]
pub struct TrialsOverview {
    /// The state of its runs.
    pub runs: Vec<RunStatus>,
    /// What else lies where they belong.
    pub strays: Vec<StoreProblem>,
    /// Whether settings have been chosen by them.
    pub has_chosen: bool,
}

/// The state of every run in `results`. All of them are checked as they are before they go on, but for those
/// that a worker is on.
///
/// # Errors
/// [`HarnessError`] if it is no results folder. A damaged run is no error: that is its state.
pub fn status(results: &Path) -> Result<Overview, HarnessError> {
    let folder = layout::tuning_dir(results);
    let trials = if layout::runs_dir(&folder).is_dir() {
        let (runs, mut strays) = of_folder(&folder)?;
        let (chosen, problems) = reports::store::tuning(results);
        strays.extend(problems);
        Some(TrialsOverview { runs, strays, has_chosen: chosen.is_some() })
    } else {
        None
    };
    let (runs, strays) = match of_folder(results) {
        Err(HarnessError::Store(StoreError::OnlyTrials { .. })) => Default::default(),
        found => found?,
    };
    Ok(Overview { runs, strays, trials })
}

/// The state of every run in one results folder, and what else lies there.
fn of_folder(results: &Path) -> Result<(Vec<RunStatus>, Vec<StoreProblem>), HarnessError> {
    let state = |(key, folder): (RunKey, &RunFolder)| {
        run_status(folder).unwrap_or_else(|error| RunStatus {
            reason: Some(chain(&error)),
            ..RunStatus::new(key, Activity::Damaged)
        })
    };
    let Survey { mut runs, lost, strays } = Results::new(results).survey()?;
    runs.extend(lost);
    runs.sort();
    let folders: Vec<_> = runs.iter().filter_map(|folder| Some((folder.key()?, folder))).collect();
    Ok((folders.into_par_iter().map(state).collect(), strays))
}

/// The run in `folder`, checked unless a worker is on it.
fn checked(folder: &RunFolder) -> Result<(Manifest, RunConfig, Option<Outcome>), HarnessError> {
    let unchecked = || {
        let (manifest, config) = folder::read_manifest(folder.path())?;
        folder.check_place(&manifest)?;
        Ok((manifest, config, None))
    };
    if is_locked(folder.path())? {
        return unchecked();
    }
    match folder::check(folder.path()) {
        Ok(Sound { manifest, config, outcome, .. }) => Ok((manifest, config, outcome)),
        // Its worker began in between and changed files while they were read.
        Err(_) if is_locked(folder.path())? => unchecked(),
        Err(error) => Err(error),
    }
}

fn run_status(folder: &RunFolder) -> Result<RunStatus, HarnessError> {
    let (manifest, config, outcome) = checked(folder)?;
    let steps = config.budget.steps;
    let record: Option<Record> = folder.last();
    // A run is what it found, with or without its times.
    let untimed = outcome.as_ref().and_then(|_| checksums::check_timings(folder).err());
    let speed = if untimed.is_none() { pace::recorded(folder) } else { None };
    let (activity, reason) = match outcome {
        Some(Outcome::Finished { .. }) => (Activity::Finished, untimed.map(|error| chain(&error))),
        Some(Outcome::Failed { reason, .. }) => (Activity::Failed, Some(reason)),
        None if is_locked(folder.path())? => (Activity::Running, None),
        None => match folder.last_crash() {
            Some(crash) => (Activity::Crashed, Some(crash.reason)),
            None if record.is_some() => (Activity::Stopped, None),
            None => (Activity::Waiting, None),
        },
    };
    let step = record.as_ref().map_or(0, |record| record.step);

    let unfinished = !matches!(activity, Activity::Finished | Activity::Failed);
    Ok(RunStatus {
        step,
        steps,
        success_rate: record.map(|record| record.success_rate),
        steps_per_s: speed,
        left_s: speed.filter(|_| unfinished).map(|speed| steps.saturating_sub(step) as f64 / speed),
        reason,
        // A damaged line among them is no reason to call the run damaged.
        crashes: folder.crashes().map_or(0, |crashes| crashes.len()),
        ..RunStatus::new(manifest.run, activity)
    })
}
