//! A run of a worker's cohort, from taking its folder to recording how it ended.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use reports::schema::{Manifest, Outcome, RunKey};
use reports::store::RunFolder;
use reports::store::layout::Lives;

use super::Keeping;
use super::observers::LaneObserver;
use crate::Registry;
use crate::config::RunConfig;
use crate::error::{HarnessError, chain};
use crate::run::checkpoint::{self, Checkpoint, CheckpointError, REPLAY};
use crate::run::cohort::Lane;
use crate::run::error::RunError;
use crate::run::folder::{self, Extent};
use crate::run::lock::Lock;
use crate::run::observer::Observer;
use crate::run::train::{End, Trainer};
use crate::sweep::event::{Event, Told};
use crate::sweep::exit::ExitCode;

/// Time between two looks at a lock.
const LOCK_PAUSE: Duration = Duration::from_millis(50);

/// A run that this worker trains.
pub(super) struct WorkerLane {
    index: usize,
    folder: PathBuf,
    manifest: Manifest,
    discard_replay: bool,
    trainer: Trainer,
    observer: LaneObserver,
    lock: Lock,
}

/// What opening a run's folder came to.
pub(super) enum Opened {
    /// It is to be trained.
    Open(Box<WorkerLane>),
    /// Another worker ended this run since it was planned, or was killed before it could say so; the parent
    /// knows now.
    Ended,
}

impl WorkerLane {
    /// Takes the folder of lane `index`, and the run in it as of its checkpoint. Whoever else has it is
    /// waited for until `patience` ends.
    pub(super) fn open(
        registry: &Registry,
        index: usize,
        folder: &Path,
        keeping: Keeping,
        stop: &Arc<AtomicBool>,
        patience: Instant,
    ) -> Result<Opened, HarnessError> {
        let (manifest, config) = folder::read_manifest(folder)?;
        registry.check(&manifest.run)?;
        let lock = take_lock(folder, patience)?;
        guard::fresh::sweep(folder);
        if let Some(outcome) = folder::outcome(folder, &manifest)? {
            end(index, folder, keeping.discard_replay, outcome, lock)?;
            return Ok(Opened::Ended);
        }
        let checkpoint = checkpoint::read(folder, &manifest).map_err(|error| match error {
            error @ CheckpointError::Io { .. } => error.into(),
            damaged => HarnessError::impossible(&manifest.run, "go on")(damaged),
        })?;
        let (hash, tensorboard) = (&manifest.hash, keeping.tensorboard);
        let observer = |progress: &Extent| {
            LaneObserver::open(index, folder, hash, progress, tensorboard, Arc::clone(stop))
                .map_err(unwritable(folder))
        };
        // A kill kept the end of this run from being recorded, and nothing else: it needs no student, nor the
        // replay buffer, which may be gone.
        if let Some(Checkpoint { trainer, progress, .. }) = &checkpoint
            && trainer.step() >= config.budget.steps
        {
            let outcome = Outcome::Finished { step: trainer.step() };
            observer(progress)?.end(&outcome).map_err(unwritable(folder))?;
            end(index, folder, keeping.discard_replay, outcome, lock)?;
            return Ok(Opened::Ended);
        }
        let (trainer, progress) = begin(registry, folder, &manifest, config, checkpoint)?;
        let observer = observer(&progress)?;
        observer.tell(Event::Step { step: trainer.step() }).map_err(unwritable(folder))?;
        Ok(Opened::Open(Box::new(Self {
            index,
            folder: folder.to_owned(),
            manifest,
            discard_replay: keeping.discard_replay,
            trainer,
            observer,
            lock,
        })))
    }

    /// Which lane it is, and its folder.
    pub(super) fn place(&self) -> (usize, PathBuf) {
        (self.index, self.folder.clone())
    }

    /// Whether its student learns on a GPU.
    pub(super) fn is_on_gpu(&self) -> bool {
        self.trainer.device() == agents::Device::Cuda
    }

    /// Records how the run ended, or tells that a signal stopped it: it can go on later.
    pub(super) fn close(self, result: Result<End, RunError>) -> Result<ExitCode, HarnessError> {
        let Self { index, folder, manifest, discard_replay, trainer, observer, lock } = self;
        let step = trainer.step();
        let outcome = match result {
            Ok(End::Finished) => Outcome::Finished { step },
            Ok(End::Stopped) => {
                observer.tell(Event::Stopped { step }).map_err(unwritable(&folder))?;
                return Ok(ExitCode::Stopped);
            }
            Err(RunError::Unrecorded(source)) => return Err(unwritable(&folder)(source)),
            Err(error) if error.is_libtorch() || matches!(error, RunError::Unsaved(_)) => {
                return Err(machine(&manifest.run, error));
            }
            Err(error) => Outcome::Failed { step, reason: chain(&error) },
        };
        observer.end(&outcome).map_err(unwritable(&folder))?;
        end(index, &folder, discard_replay, outcome, lock)
    }
}

impl Lane for WorkerLane {
    fn parts(&mut self) -> (&mut Trainer, &mut (dyn Observer + Send)) {
        (&mut self.trainer, &mut self.observer)
    }
}

/// Tells the parent how the run came out whose outcome is recorded, and lets its folder go.
fn end(
    index: usize,
    folder: &Path,
    discard_replay: bool,
    outcome: Outcome,
    lock: Lock,
) -> Result<ExitCode, HarnessError> {
    // A failed run keeps its replay buffer: it may be asked to try again.
    if discard_replay && matches!(outcome, Outcome::Finished { .. }) {
        RunFolder::new(folder).remove(Lives::UntilDiscarded)?;
    }
    drop(lock);
    Told::of(index, Event::Ended { outcome }).send().map_err(unwritable(folder))?;
    Ok(ExitCode::Success)
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
            error if error.is_libtorch() => machine(run, error),
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

fn machine(run: &RunKey, error: RunError) -> HarnessError {
    HarnessError::Machine { run: run.clone(), source: error.into() }
}

fn unwritable(folder: &Path) -> impl FnOnce(std::io::Error) -> HarnessError {
    HarnessError::io(folder, "record in this folder")
}

/// Takes the run's folder. A worker whose sweep was killed still saves its checkpoint: wait for it a little.
fn take_lock(folder: &Path, patience: Instant) -> Result<Lock, HarnessError> {
    loop {
        match Lock::take(folder) {
            Err(HarnessError::Locked { .. }) if Instant::now() < patience => std::thread::sleep(LOCK_PAUSE),
            result => return result,
        }
    }
}
