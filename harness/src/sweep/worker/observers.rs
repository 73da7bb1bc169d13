//! Who hears of a worker's run: one records it, one tells the parent.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use reports::schema::{Frontier, Learning, Outcome, Record, Shadowing, Teaching};

use crate::run::checkpoint::{self, Checkpoint, REPLAY};
use crate::run::folder::{Extent, Recorder};
use crate::run::observer::{Checkpointer, Observer, Stage, Wish};
use crate::run::state::TrainerState;
use crate::sweep::event::{Event, Told};

/// At most one [`Event::Step`] in this time.
const STEP_INTERVAL: Duration = Duration::from_millis(500);

/// Records a run, then tells the parent of it: only of what is recorded.
pub(super) struct LaneObserver {
    recording: RecordObserver,
    telling: EventObserver,
}

impl LaneObserver {
    /// For the run with manifest hash `hash` in `folder`, which is lane `lane` of the worker: goes on after
    /// `progress` until `stop` is set.
    pub(super) fn open(
        lane: usize,
        folder: &Path,
        hash: &str,
        progress: &Extent,
        tensorboard: bool,
        stop: Arc<AtomicBool>,
    ) -> std::io::Result<Self> {
        let recording = RecordObserver::open(folder, hash, progress, tensorboard, Arc::clone(&stop))?;
        Ok(Self { recording, telling: EventObserver::new(lane, stop) })
    }

    /// Tells the parent of `event`.
    pub(super) fn tell(&self, event: Event) -> std::io::Result<()> {
        self.telling.tell(event)
    }

    /// Records how the run ended.
    pub(super) fn end(self, outcome: &Outcome) -> std::io::Result<()> {
        self.recording.end(outcome)
    }
}

impl Observer for LaneObserver {
    fn spent(&mut self, stage: Stage, time: Duration) {
        self.recording.spent(stage, time);
    }

    fn record(&mut self, record: &Record, teaching: &Teaching, learning: &Learning) -> std::io::Result<()> {
        self.recording.record(record, teaching, learning)?;
        self.telling.record(record, teaching, learning)
    }

    fn measured(&mut self, frontier: &Frontier) -> std::io::Result<()> {
        self.recording.measured(frontier)
    }

    fn shadowed(&mut self, shadowing: &Shadowing) -> std::io::Result<()> {
        self.recording.shadowed(shadowing)
    }

    fn cycle(&mut self, step: u64) -> std::io::Result<()> {
        self.telling.cycle(step)
    }

    fn checkpointer(&mut self) -> Option<&mut dyn Checkpointer> {
        self.recording.checkpointer()
    }
}

/// Records, and saves a checkpoint after every evaluation and before stopping.
struct RecordObserver {
    folder: PathBuf,
    replay: PathBuf,
    hash: String,
    recorder: Recorder,
    stop: Arc<AtomicBool>,
}

impl RecordObserver {
    /// Goes on after `progress` with the run with manifest hash `hash` in `folder`, until `stop` is set.
    fn open(
        folder: &Path,
        hash: &str,
        progress: &Extent,
        tensorboard: bool,
        stop: Arc<AtomicBool>,
    ) -> std::io::Result<Self> {
        Ok(Self {
            folder: folder.to_owned(),
            replay: folder.join(REPLAY),
            hash: hash.to_owned(),
            recorder: Recorder::open(folder, progress, tensorboard)?,
            stop,
        })
    }

    /// Records how the run ended.
    fn end(self, outcome: &Outcome) -> std::io::Result<()> {
        self.recorder.end(&self.hash, outcome)
    }
}

impl Observer for RecordObserver {
    fn spent(&mut self, stage: Stage, time: Duration) {
        self.recorder.spent(stage, time);
    }

    fn record(&mut self, record: &Record, teaching: &Teaching, learning: &Learning) -> std::io::Result<()> {
        self.recorder.record(record, teaching, learning)
    }

    fn measured(&mut self, frontier: &Frontier) -> std::io::Result<()> {
        self.recorder.measured(frontier)
    }

    fn shadowed(&mut self, shadowing: &Shadowing) -> std::io::Result<()> {
        self.recorder.shadowed(shadowing)
    }

    fn checkpointer(&mut self) -> Option<&mut dyn Checkpointer> {
        Some(self)
    }
}

impl Checkpointer for RecordObserver {
    fn wish(&mut self, evaluated: bool) -> Wish {
        match (self.stop.load(Ordering::Relaxed), evaluated) {
            (true, _) => Wish::SaveAndStop,
            (false, true) => Wish::Save,
            (false, false) => Wish::GoOn,
        }
    }

    fn replay_folder(&self) -> &Path {
        &self.replay
    }

    fn save(&mut self, trainer: TrainerState) -> std::io::Result<()> {
        let progress = self.recorder.extent()?;
        let checkpoint = Checkpoint { run: self.hash.clone(), trainer, progress };
        checkpoint::write(&self.folder, &checkpoint).map_err(std::io::Error::other)
    }
}

/// Tells the parent. Once the parent is gone, which closes the pipe, the run saves and stops.
struct EventObserver {
    lane: usize,
    last_step: Instant,
    stop: Arc<AtomicBool>,
}

impl EventObserver {
    fn new(lane: usize, stop: Arc<AtomicBool>) -> Self {
        Self { lane, last_step: Instant::now(), stop }
    }

    fn tell(&self, event: Event) -> std::io::Result<()> {
        match Told::of(self.lane, event).send() {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => {
                self.stop.store(true, Ordering::Relaxed);
                Ok(())
            }
            result => result,
        }
    }
}

impl Observer for EventObserver {
    fn record(&mut self, record: &Record, _: &Teaching, _: &Learning) -> std::io::Result<()> {
        self.tell(Event::Evaluated { step: record.step, success_rate: record.success_rate })
    }

    fn cycle(&mut self, step: u64) -> std::io::Result<()> {
        if self.last_step.elapsed() < STEP_INTERVAL {
            return Ok(());
        }
        self.last_step = Instant::now();
        self.tell(Event::Step { step })
    }
}
