//! The worker: one process, one cohort of runs. `goalbench worker FOLDER...` carries out the runs whose
//! manifests lie in the folders, in lockstep; mostly that is one.
//!
//! Every run goes on from its folder's checkpoint if there is one. SIGTERM and SIGINT make all of them save a
//! checkpoint at the end of the running cycle and stop; so does the death of the worker's parent. A run that
//! cannot be carried out is left out, and one that ends early leaves: the others go on.

mod lane;
mod observers;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use rustix::process::{Signal, set_parent_process_death_signal};

use super::event::{Event, Told};
use super::exit::ExitCode;
use crate::Registry;
use crate::error::{HarnessError, chain};
use crate::run::cohort::{self, Means};
use crate::run::folder;
use lane::{Opened, WorkerLane};

/// How long to wait for other workers that are about to end: longer than a cycle and a checkpoint take.
const LOCK_PATIENCE: Duration = Duration::from_secs(20);

/// How a worker carries out its runs. None of it changes what they record on a CPU.
#[derive(Clone, Copy, Debug)]
pub struct Keeping {
    /// Whether it keeps TensorBoard event files.
    pub tensorboard: bool,
    /// Whether it removes the replay buffer of a run once that has finished.
    pub discard_replay: bool,
    /// Threads for all runs together.
    pub threads: usize,
    /// Lanes that a GPU's products are made for, however many runs there are.
    pub width: usize,
    /// Whether two halves of the cohort take turns between cores and device.
    pub overlap: bool,
}

/// What a worker came to.
#[derive(Debug, Default)]
pub struct Worked {
    codes: Vec<ExitCode>,
    /// What kept runs from being carried out, for standard error.
    pub errors: Vec<HarnessError>,
}

impl Worked {
    /// The worst of all runs': a failure that another attempt may mend, wrong input, a stop, a run that
    /// another process has.
    pub fn code(&self) -> ExitCode {
        let worst = [ExitCode::Failed, ExitCode::WrongInput, ExitCode::Stopped, ExitCode::Taken];
        worst.into_iter().find(|code| self.codes.contains(code)).unwrap_or(ExitCode::Success)
    }

    /// Takes in what became of the run of lane `lane` and tells the parent of it, unless that has been done.
    fn note(&mut self, lane: usize, folder: &std::path::Path, result: Result<ExitCode, HarnessError>) {
        // If the parent is gone nobody hears it; the exit code stays the same.
        let tell = |event: Event| drop(Told::of(lane, event).send());
        let error = match result {
            Ok(code) => return self.codes.push(code),
            Err(HarnessError::Locked { .. }) => {
                tell(Event::Taken);
                return self.codes.push(ExitCode::Taken);
            }
            Err(error) => error,
        };
        let text = chain(&error);
        // Whoever shows the reason names the run.
        let run = folder::read_manifest(folder).map(|(manifest, _)| format!("{}: ", manifest.run));
        let reason = run.ok().and_then(|run| text.strip_prefix(&run)).unwrap_or(&text).to_owned();
        if error.is_transient() {
            tell(Event::Broken { reason });
            self.codes.push(ExitCode::Failed);
        } else {
            tell(Event::Refused { reason });
            self.codes.push(ExitCode::WrongInput);
        }
        self.errors.push(error);
    }
}

/// Carries out the runs of `folders` in lockstep and records how each ended. A run that breaks down is no
/// failure of the worker: that is its outcome.
///
/// The parent gets everything, errors included, as events.
pub fn work(registry: &Registry, folders: &[PathBuf], keeping: Keeping) -> Worked {
    tell_panics();
    let mut worked = Worked::default();
    if let Err(error) = carry_out(registry, folders, keeping, &mut worked) {
        // It concerns the whole worker, so every run is told the same.
        let reason = chain(&error);
        drop(Told::of_all(Event::Broken { reason }).send());
        worked.codes.push(ExitCode::Failed);
        worked.errors.push(error);
    }
    worked
}

/// Makes a panic, whatever thread it is on, an event as well as a text on standard error.
fn tell_panics() {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        print(panic);
        let message = panic.payload_as_str().and_then(|text| text.lines().next());
        let reason = message.unwrap_or("it panicked").to_owned();
        drop(Told::of_all(Event::Broken { reason }).send());
    }));
}

fn carry_out(
    registry: &Registry,
    folders: &[PathBuf],
    keeping: Keeping,
    worked: &mut Worked,
) -> Result<(), HarnessError> {
    // Whoever started this worker is waiting for it. If they die, save checkpoints and stop, like on SIGTERM.
    set_parent_process_death_signal(Some(Signal::TERM))
        .map_err(HarnessError::system("listen for the parent's death"))?;
    agents::prepare_thread();
    let pool = pool(keeping.threads)?;
    let stop = stop_flag().map_err(HarnessError::system("listen for signals"))?;
    let patience = Instant::now() + LOCK_PATIENCE;
    let mut lanes = Vec::new();
    for (index, folder) in folders.iter().enumerate() {
        match WorkerLane::open(registry, index, folder, keeping, &stop, patience) {
            Ok(Opened::Ended) => worked.note(index, folder, Ok(ExitCode::Success)),
            Ok(Opened::Open(lane)) => lanes.push(*lane),
            Err(error) => worked.note(index, folder, Err(error)),
        }
    }
    let on_gpu = lanes.first().is_some_and(WorkerLane::is_on_gpu);
    let ended = |lane: WorkerLane, result| {
        let (index, folder) = lane.place();
        worked.note(index, &folder, lane.close(result));
    };
    if keeping.overlap {
        // Batches for a GPU that waits must not queue behind the other half's episodes. A CPU has no more
        // cores for two pools than for one.
        let other = on_gpu.then(|| self::pool(keeping.threads)).transpose()?;
        let pools = [&pool, other.as_ref().unwrap_or(&pool)];
        cohort::train_in_turns(lanes, pools, keeping.width, ended);
    } else {
        let means = Means { pool: Some(&pool), width: keeping.width, turns: None };
        cohort::train(lanes, means, ended);
    }
    Ok(())
}

/// So many threads for what lanes do.
fn pool(threads: usize) -> Result<rayon::ThreadPool, HarnessError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .start_handler(|_| agents::prepare_thread())
        .build()
        .map_err(HarnessError::system("start the threads of a worker"))
}

/// A flag that SIGTERM and SIGINT set.
fn stop_flag() -> std::io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        signal_hook::flag::register(signal, Arc::clone(&flag))?;
    }
    Ok(flag)
}
