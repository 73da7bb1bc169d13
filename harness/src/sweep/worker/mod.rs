//! The worker: one process, one run. `goalbench worker FOLDER` carries out the run whose manifest lies in
//! FOLDER.
//!
//! It goes on from the folder's checkpoint if there is one. SIGTERM and SIGINT make it save a checkpoint at
//! the end of the running cycle and stop; so does the death of its parent.

mod observers;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use agents::AgentError;
use curricula::CurriculumError;
use reports::schema::{Manifest, Outcome, RunKey};
use reports::store::RunFolder;
use reports::store::layout::Lives;
use rustix::process::{Signal, set_parent_process_death_signal};

use super::event::Event;
use super::exit::ExitCode;
use crate::Registry;
use crate::config::RunConfig;
use crate::error::{HarnessError, chain};
use crate::run::checkpoint::{self, Checkpoint, CheckpointError, REPLAY};
use crate::run::error::RunError;
use crate::run::folder::{self, Extent};
use crate::run::lock::Lock;
use crate::run::observer::Observer;
use crate::run::train::{End, Trainer};
use observers::{EventObserver, RecordObserver};

/// How long to wait for another worker that is about to end: longer than a cycle and a checkpoint take.
const LOCK_PATIENCE: Duration = Duration::from_secs(20);
/// Time between two looks at the lock.
const LOCK_PAUSE: Duration = Duration::from_millis(50);

/// What a worker keeps beside the records.
#[derive(Clone, Copy, Debug)]
pub struct Keeping {
    /// Whether it keeps a TensorBoard event file.
    pub tensorboard: bool,
    /// Whether it removes the replay buffer once the run has finished.
    pub discard_replay: bool,
}

/// Carries out the run of `folder` and records how it ended. A run that breaks down is no failure of the
/// worker: that is its outcome.
///
/// The parent gets everything, errors included, as events. An error is returned as well, for standard error:
/// with [`ExitCode::WrongInput`] or, if another attempt may succeed, [`ExitCode::Failed`].
///
/// # Errors
/// The exit code and why.
pub fn work(
    registry: &Registry,
    folder: &Path,
    keeping: Keeping,
) -> Result<ExitCode, (ExitCode, Box<HarnessError>)> {
    tell_panics();
    // If the parent is gone nobody hears it; the exit code stays the same.
    let tell = |event: Event| drop(event.send());
    match carry_out(registry, folder, keeping) {
        Ok(code) => Ok(code),
        Err(HarnessError::Locked { .. }) => {
            tell(Event::Taken);
            Ok(ExitCode::Taken)
        }
        Err(error) => {
            let text = chain(&error);
            // Whoever shows the reason names the run.
            let run = folder::read_manifest(folder).map(|(manifest, _)| format!("{}: ", manifest.run));
            let reason = run.ok().and_then(|run| text.strip_prefix(&run)).unwrap_or(&text).to_owned();
            if error.is_transient() {
                tell(Event::Broken { reason });
                Err((ExitCode::Failed, error.into()))
            } else {
                tell(Event::Refused { reason });
                Err((ExitCode::WrongInput, error.into()))
            }
        }
    }
}

/// Makes a panic, whatever thread it is on, an event as well as a text on standard error.
fn tell_panics() {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        print(panic);
        let message = panic.payload_as_str().and_then(|text| text.lines().next());
        drop(Event::Broken { reason: message.unwrap_or("it panicked").to_owned() }.send());
    }));
}

fn carry_out(registry: &Registry, folder: &Path, keeping: Keeping) -> Result<ExitCode, HarnessError> {
    let (manifest, config) = folder::read_manifest(folder)?;
    registry.check(&manifest.run)?;

    // Whoever started this worker is waiting for it. If they die, save a checkpoint and stop, like on
    // SIGTERM.
    set_parent_process_death_signal(Some(Signal::TERM))
        .map_err(HarnessError::system("listen for the parent's death"))?;
    let _lock = take_lock(folder)?;
    guard::fresh::sweep(folder);
    let outcome = match folder::outcome(folder, &manifest)? {
        // Another worker ended this run since it was planned, or was killed before it could say so.
        Some(outcome) => outcome,
        None => match train(registry, folder, &manifest, config, keeping.tensorboard)? {
            Some(outcome) => outcome,
            None => return Ok(ExitCode::Stopped),
        },
    };
    let unwritable = HarnessError::io(folder, "record in this folder");
    // A failed run keeps its replay buffer: it may be asked to try again.
    if keeping.discard_replay && matches!(outcome, Outcome::Finished { .. }) {
        RunFolder::new(folder).remove(Lives::UntilDiscarded)?;
    }
    Event::Ended { outcome }.send().map_err(unwritable)?;
    Ok(ExitCode::Success)
}

/// Trains to the end and records the outcome; `None` if a signal stopped the run, which can go on later.
fn train(
    registry: &Registry,
    folder: &Path,
    manifest: &Manifest,
    config: RunConfig,
    tensorboard: bool,
) -> Result<Option<Outcome>, HarnessError> {
    let unwritable = || HarnessError::io(folder, "record in this folder");
    agents::prepare_thread();
    let checkpoint = checkpoint::read(folder, manifest).map_err(|error| match error {
        error @ CheckpointError::Io { .. } => error.into(),
        damaged => HarnessError::impossible(&manifest.run, "go on")(damaged),
    })?;
    let stop = stop_flag().map_err(HarnessError::system("listen for signals"))?;
    let record = |progress: &Extent| {
        RecordObserver::open(folder, &manifest.hash, progress, tensorboard, Arc::clone(&stop))
            .map_err(unwritable())
    };
    // A kill kept the end of this run from being recorded, and nothing else: it needs no student, nor the
    // replay buffer, which may be gone.
    if let Some(Checkpoint { trainer, progress, .. }) = &checkpoint
        && trainer.step() >= config.budget.steps
    {
        let outcome = Outcome::Finished { step: trainer.step() };
        record(progress)?.end(&outcome).map_err(unwritable())?;
        return Ok(Some(outcome));
    }
    let (mut trainer, progress) = begin(registry, folder, manifest, config, checkpoint)?;
    let mut recording = record(&progress)?;
    let mut telling = EventObserver::new(stop);
    telling.tell(&Event::Step { step: trainer.step() }).map_err(unwritable())?;
    // Recording comes first: the parent is told only of what is recorded.
    let mut observers: Vec<&mut dyn Observer> = vec![&mut recording, &mut telling];
    let outcome = match trainer.run(&mut observers) {
        Ok(End::Finished) => Outcome::Finished { step: trainer.step() },
        Ok(End::Stopped) => {
            telling.tell(&Event::Stopped { step: trainer.step() }).map_err(unwritable())?;
            return Ok(None);
        }
        Err(RunError::Unrecorded(source)) => return Err(unwritable()(source)),
        Err(error) if is_libtorch(&error) || matches!(error, RunError::Unsaved(_)) => {
            return Err(machine(&manifest.run, error));
        }
        Err(error) => Outcome::Failed { step: trainer.step(), reason: chain(&error) },
    };
    recording.end(&outcome).map_err(unwritable())?;
    Ok(Some(outcome))
}

/// The run as of its `checkpoint`, or from its beginning if it has none, and how far its records had come.
fn begin(
    registry: &Registry,
    folder: &Path,
    manifest: &Manifest,
    config: RunConfig,
    checkpoint: Option<Checkpoint>,
) -> Result<(Trainer, Extent), HarnessError> {
    let run = &manifest.run;
    let cannot = |action| {
        move |error: RunError| match error {
            error if is_libtorch(&error) => machine(run, error),
            error => HarnessError::impossible(run, action)(error),
        }
    };
    let mut trainer = Trainer::new(registry, run.clone(), config).map_err(cannot("begin"))?;
    let Some(checkpoint) = checkpoint else {
        folder::check_beginning(folder)?;
        return Ok((trainer, Extent::default()));
    };
    trainer.resume(&checkpoint.trainer, &folder.join(REPLAY)).map_err(cannot("go on"))?;
    Ok((trainer, checkpoint.progress))
}

/// Whether libtorch failed, in the student or in a teacher. Shapes were checked before, so the machine is to
/// blame: there is no memory, or a device went away.
pub(super) fn is_libtorch(error: &RunError) -> bool {
    matches!(
        error,
        RunError::Student(AgentError::Torch(_))
            | RunError::Teacher(CurriculumError::Student(AgentError::Torch(_)))
    )
}

fn machine(run: &RunKey, error: RunError) -> HarnessError {
    HarnessError::Machine { run: run.clone(), source: error.into() }
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
