//! The worker: one process, one run. `goalbench worker FOLDER` carries out the run whose manifest lies in FOLDER.
//!
//! It goes on from the folder's checkpoint if there is one. SIGTERM and SIGINT make it save a checkpoint at the end of
//! the running cycle and stop; so does the death of its parent.

use std::io::{StdoutLock, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use agents::AgentError;
use curricula::CurriculumError;
use reports::schema::{Outcome, Record, RunKey, Teaching};
use reports::store::layout;
use rustix::process::{Signal, set_parent_process_death_signal};

use super::Lock;
use super::event::Event;
use crate::Registry;
use crate::error::{HarnessError, explain};
use crate::run::checkpoint::{self, Checkpoint, CheckpointError, REPLAY};
use crate::run::folder::{self, Progress, Recorder};
use crate::run::train::{End, Phase, RunError, Trainer, TrainerState, Watcher, Wish};

/// At most one [`Event::Step`] in this time.
const STEP_INTERVAL: Duration = Duration::from_millis(500);

/// How long to wait for another worker that is about to end: longer than a cycle and a checkpoint take.
const LOCK_PATIENCE: Duration = Duration::from_secs(20);
/// Time between two looks at the lock.
const LOCK_PAUSE: Duration = Duration::from_millis(50);

/// Carries out the run of `folder` and records how it ended; `None` if it was stopped by a signal and can go on later.
/// With `tensorboard` it keeps an event file beside the records.
///
/// # Errors
/// [`HarnessError`] if the run could not be begun or recorded. A run that breaks down is no error: that is its outcome.
pub fn work(registry: &Registry, folder: &Path, tensorboard: bool) -> Result<Option<Outcome>, HarnessError> {
    let (manifest, config) = folder::read_manifest(folder)?;
    let key = &manifest.run;
    registry.check(key)?;

    // Whoever started this worker is waiting for it. If they die, save a checkpoint and stop, like on SIGTERM.
    let parent_gone = |error: rustix::io::Errno| recording_error(folder, error.into());
    set_parent_process_death_signal(Some(Signal::TERM)).map_err(parent_gone)?;
    let _lock = take_lock(folder)?;
    let recording = |source| recording_error(folder, source);
    if let Some(outcome) = folder::outcome(folder, &manifest)? {
        // Another worker ended this run since it was planned, or was killed before it could say so.
        tidy(folder, &outcome).map_err(recording)?;
        send(&mut std::io::stdout().lock(), &Event::Ended { outcome: outcome.clone() }).map_err(recording)?;
        return Ok(Some(outcome));
    }
    agents::prepare_thread();
    let cannot_run = |error: RunError| match libtorch(&error) {
        Some(error) => machine_error(key, error),
        None => HarnessError::Run { run: key.to_string(), reason: explain(&error) },
    };
    let found = checkpoint::read(folder, &manifest.hash).map_err(|error| match error {
        CheckpointError::Io { path, source } => {
            HarnessError::Io { path, action: "read this checkpoint", source }
        }
        damaged => HarnessError::Run { run: key.to_string(), reason: damaged.to_string() },
    })?;
    let mut trainer = Trainer::new(registry, key.clone(), config).map_err(cannot_run)?;
    let progress = match &found {
        Some(checkpoint) => {
            trainer.resume(&checkpoint.trainer, &folder.join(REPLAY)).map_err(cannot_run)?;
            checkpoint.progress.clone()
        }
        None => {
            check_beginning(folder)?;
            Progress::default()
        }
    };
    let mut reporter = Reporter {
        folder: folder.to_owned(),
        replay: folder.join(REPLAY),
        hash: manifest.hash.clone(),
        recorder: Recorder::open(folder, &progress, tensorboard).map_err(recording)?,
        out: std::io::stdout().lock(),
        last_step: Instant::now(),
        stop: stop_flag().map_err(recording)?,
    };
    reporter.tell(&Event::Step { step: trainer.step() }).map_err(recording)?;
    let outcome = match trainer.run(&mut reporter) {
        Ok(End::Finished) => Outcome::Finished { step: trainer.step() },
        Ok(End::Stopped) => {
            reporter.tell(&Event::Stopped { step: trainer.step() }).map_err(recording)?;
            return Ok(None);
        }
        Err(RunError::Recording(source)) => return Err(recording(source)),
        Err(error) => match libtorch(&error) {
            Some(error) => return Err(machine_error(key, error)),
            None => Outcome::Failed { step: trainer.step(), reason: explain(&error) },
        },
    };
    let Reporter { recorder, mut out, .. } = reporter;
    recorder.end(&manifest.hash, &outcome).map_err(recording)?;
    tidy(folder, &outcome).map_err(recording)?;
    send(&mut out, &Event::Ended { outcome: outcome.clone() }).map_err(recording)?;
    Ok(Some(outcome))
}

/// Removes what a run that has ended needs no more. A failed one keeps its replay log: it may be asked to try again.
fn tidy(folder: &Path, outcome: &Outcome) -> std::io::Result<()> {
    match outcome {
        Outcome::Finished { .. } => checkpoint::clear_replay(folder),
        Outcome::Failed { .. } => Ok(()),
    }
}

/// Refuses to begin anew over records that a checkpoint must have followed: it was lost, and they would be, too.
fn check_beginning(folder: &Path) -> Result<(), HarnessError> {
    /// Evaluations that are recorded before the first checkpoint is saved.
    const BEFORE_CHECKPOINT: usize = 2;
    let path = folder.join(layout::RECORDS);
    let recorded = match std::fs::read_to_string(&path) {
        Ok(text) => text.lines().count(),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => 0,
        Err(source) => return Err(HarnessError::Io { path, action: "read this file", source }),
    };
    if recorded > BEFORE_CHECKPOINT {
        let reason = format!(
            "is missing, though {recorded} evaluations are recorded; delete this run's folder to train it anew"
        );
        return Err(HarnessError::Damaged { path: folder.join(checkpoint::CHECKPOINT), reason });
    }
    Ok(())
}

/// What libtorch refused to the student, or to a teacher that asked it or has networks of its own. Shapes were checked
/// before, so that what is left is the machine's: no memory, a device that went away.
fn libtorch(error: &RunError) -> Option<&AgentError> {
    match error {
        RunError::Student(error) | RunError::Teacher(CurriculumError::Student(error)) => {
            matches!(error, AgentError::Torch(_)).then_some(error)
        }
        _ => None,
    }
}

fn machine_error(run: &RunKey, error: &AgentError) -> HarnessError {
    HarnessError::Machine { run: run.to_string(), reason: error.to_string() }
}

fn recording_error(folder: &Path, source: std::io::Error) -> HarnessError {
    HarnessError::Io { path: folder.to_owned(), action: "record in this folder", source }
}

/// Takes the run's folder. A worker whose sweep was killed still saves its checkpoint: wait for it a little.
fn take_lock(folder: &Path) -> Result<Lock, HarnessError> {
    let begun = Instant::now();
    loop {
        match Lock::take(folder) {
            Err(HarnessError::Locked { .. }) if begun.elapsed() < LOCK_PATIENCE => {
                std::thread::sleep(LOCK_PAUSE)
            }
            result => return result,
        }
    }
}

/// A flag that SIGTERM and SIGINT set.
fn stop_flag() -> std::io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        signal_hook::flag::register(signal, Arc::clone(&flag))?;
    }
    Ok(flag)
}

/// Records, tells the parent, and decides when to save: after every evaluation, and before stopping.
struct Reporter<'a> {
    folder: PathBuf,
    replay: PathBuf,
    hash: String,
    recorder: Recorder,
    out: StdoutLock<'a>,
    last_step: Instant,
    stop: Arc<AtomicBool>,
}

impl Watcher for Reporter<'_> {
    fn spent(&mut self, phase: Phase, time: Duration) {
        self.recorder.spent(phase, time);
    }

    fn record(&mut self, record: &Record, teaching: &Teaching) -> std::io::Result<()> {
        self.recorder.record(record, teaching)?;
        self.tell(&Event::Evaluated { step: record.step, success_rate: record.success_rate })
    }

    fn cycle(&mut self, step: u64, evaluated: bool) -> std::io::Result<Wish> {
        if self.last_step.elapsed() >= STEP_INTERVAL {
            self.last_step = Instant::now();
            self.tell(&Event::Step { step })?;
        }
        Ok(match (self.stop.load(Ordering::Relaxed), evaluated) {
            (true, _) => Wish::SaveAndStop,
            (false, true) => Wish::Save,
            (false, false) => Wish::GoOn,
        })
    }

    fn replay_folder(&self) -> &Path {
        &self.replay
    }

    fn save(&mut self, trainer: TrainerState) -> std::io::Result<()> {
        let progress = self.recorder.progress()?;
        let checkpoint = Checkpoint { run: self.hash.clone(), trainer, progress };
        checkpoint::write(&self.folder, &checkpoint).map_err(std::io::Error::other)
    }
}

impl Reporter<'_> {
    /// Tells the parent. One that is gone has closed the pipe: then it is time to save and stop.
    fn tell(&mut self, event: &Event) -> std::io::Result<()> {
        match send(&mut self.out, event) {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => {
                self.stop.store(true, Ordering::Relaxed);
                Ok(())
            }
            result => result,
        }
    }
}

fn send(out: &mut StdoutLock<'_>, event: &Event) -> std::io::Result<()> {
    serde_json::to_writer(&mut *out, event)?;
    out.write_all(b"\n")?;
    out.flush()
}
