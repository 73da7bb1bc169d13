//! Trying out whether runs can begin on this machine, before anything is written for them.
//!
//! A process of its own builds each of them (environment, student, teacher) and throws it away. That shows
//! what keeps a run from beginning, and whatever happens to that process harms nothing. What only the machine
//! lacks is no reason to refuse a plan: such a run fails alone.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use agents::Device;
use reports::schema::{Manifest, Outcome};
use reports::store::RunFolder;
use reports::store::layout;
use serde::{Deserialize, Serialize};

use super::errand::{self, Errand};
use super::exit::ExitCode;
use super::job::Job;
use crate::Registry;
use crate::error::{HarnessError, chain};
use crate::run::checkpoint::{self, REPLAY};
use crate::run::folder::{self, State};
use crate::run::lock::Lock;
use crate::run::manifest;
use crate::run::train::Trainer;

/// Something to try, a JSON line on the process' standard input.
#[derive(Serialize, Deserialize)]
enum Trial {
    /// To begin the run of a manifest, with its student on the CPU whatever its device.
    Begin { manifest: Box<Manifest>, on_cpu: bool },
    /// To go on with the finished run in this folder (its path's bytes), as it is.
    GoOn(Vec<u8>),
}

/// How a trial came out, a JSON line each on its standard output.
#[derive(Serialize, Deserialize)]
struct Answer {
    /// Why it cannot be done.
    refusal: Option<String>,
}

/// Tries out one new run of every cell among `jobs`, and every finished run that is to be trained on. On
/// another machine's behalf, students live on the CPU.
///
/// # Errors
/// [`HarnessError::Trial`] naming the first run that cannot begin or go on, and why.
pub(super) fn check(jobs: &[Job], elsewhere: bool) -> Result<(), HarnessError> {
    let mut cells = BTreeSet::new();
    let mut tried = Vec::new();
    for job in jobs {
        if is_to_be_tried(job, &mut cells)? {
            tried.push(job);
        }
    }
    if tried.is_empty() {
        return Ok(());
    }
    let trials: Vec<Trial> = tried
        .iter()
        .map(|job| match job.state {
            State::Shorter(_) => Trial::GoOn(job.folder.as_os_str().as_bytes().to_vec()),
            _ => Trial::Begin { manifest: Box::new(job.manifest.clone()), on_cpu: elsewhere },
        })
        .collect();
    let Errand { answers, end } = errand::ask::<Answer>(&["try-runs".to_owned()], &trials, Duration::MAX)?;
    if let Some(reason) = answers.iter().find_map(|answer| answer.refusal.clone()) {
        return Err(HarnessError::Trial { reason });
    }
    match (tried.get(answers.len()), end) {
        // Killed, as the system does when memory runs out: that is the machine's doing as well. A finished
        // run is touched only once it is known that it can go on.
        (Some(job), Some(end)) if end.signal().is_none() || job.state != State::New => {
            let reason = format!("{}: it was tried out and the program ended ({end})", job.run());
            Err(HarnessError::Trial { reason })
        }
        _ => Ok(()),
    }
}

/// Whether a job is to be tried: the first new one of its cell, or a finished one that is trained on.
fn is_to_be_tried<'a>(job: &'a Job, cells: &mut BTreeSet<Option<&'a Path>>) -> Result<bool, HarnessError> {
    Ok(match job.state {
        State::New => cells.insert(job.folder.parent()),
        State::Shorter(_) => RunFolder::new(&job.folder).has(layout::OUTCOME)?,
        State::Begun | State::Ended(_) => false,
    })
}

/// What `goalbench try-runs` does: tries what its standard input says and tells how that came out.
///
/// # Errors
/// [`HarnessError::System`] if nobody asks or listens.
pub fn try_runs(registry: &Registry) -> Result<ExitCode, HarnessError> {
    // A run's lock must go with whoever asked.
    errand::end_with_asker()?;
    agents::prepare_thread();
    for trial in errand::questions() {
        let result = match trial? {
            Trial::Begin { manifest, on_cpu } => begin(registry, *manifest, on_cpu),
            Trial::GoOn(folder) => go_on(registry, &PathBuf::from(OsString::from_vec(folder))),
        };
        errand::answer(&Answer { refusal: result.err().map(|error| chain(&error)) })?;
    }
    Ok(ExitCode::Success)
}

fn begin(registry: &Registry, manifest: Manifest, on_cpu: bool) -> Result<(), HarnessError> {
    let run = manifest.run.clone();
    let mut config = manifest::config(&manifest).map_err(HarnessError::impossible(&run, "begin"))?;
    // One instance of the environment shows what twenty would.
    config.evaluation.episodes = 1;
    if on_cpu {
        config.student = config.student.on(Device::Cpu);
    }
    match Trainer::new(registry, run.clone(), config) {
        // This machine has no memory for it, or lost a device: the run fails alone, and may go better
        // elsewhere.
        Err(error) if error.is_libtorch() => Ok(()),
        result => result.map(drop).map_err(HarnessError::impossible(&run, "begin")),
    }
}

/// The folder is held meanwhile: reading a replay buffer cuts off what lies behind the checkpoint.
fn go_on(registry: &Registry, folder: &Path) -> Result<(), HarnessError> {
    let _lock = Lock::take(folder)?;
    let (manifest, config) = folder::read_manifest(folder)?;
    registry.check(&manifest.run)?;
    if !matches!(folder::outcome(folder, &manifest)?, Some(Outcome::Finished { .. })) {
        return Ok(());
    }
    let missing = |name: &str, reason: &str| HarnessError::Missing {
        path: folder.join(name),
        reason: reason.to_owned(),
    };
    let run = &manifest.run;
    let cannot = "be trained on";
    let found = checkpoint::read(folder, &manifest).map_err(HarnessError::impossible(run, cannot))?;
    let found = found
        .ok_or_else(|| missing(checkpoint::CHECKPOINT, "is missing, so this run cannot be trained on"))?;
    let replay = folder.join(REPLAY);
    if !RunFolder::new(folder).has(REPLAY)? {
        let reason = "is missing, so this run cannot be trained on: it finished with --discard-replay, or under a \
                      version that always removed it";
        return Err(missing(REPLAY, reason));
    }
    let mut trainer =
        Trainer::new(registry, run.clone(), config).map_err(HarnessError::impossible(run, cannot))?;
    trainer.resume(&found.trainer, &replay).map_err(HarnessError::impossible(run, cannot))
}
