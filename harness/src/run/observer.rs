//! Who hears of a run while it trains, and who saves it.
//!
//! The training loop computes and tells; everything else is an [`Observer`]: recording, telling the parent
//! process, taking the time. Every method has a default, so that an observer names only what it wants to
//! hear. A list of observers is an observer, too. Saving checkpoints is a role of its own, [`Checkpointer`],
//! which most observers do not have.

use std::path::Path;
use std::time::{Duration, Instant};

use reports::schema::{Frontier, Learning, Record, Shadowing, Teaching};

use super::state::TrainerState;

/// Where a run's time goes. What no stage covers is the bookkeeping of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Resets of the training environment.
    Resetting,
    /// Its steps.
    Stepping,
    /// Exploring actions, one at a time.
    Acting,
    /// The student takes in episodes.
    Storing,
    /// The teacher proposes goals, observes episodes and learns: the price of the curriculum.
    Teaching,
    /// Probe rollouts that the teacher asked for: the rest of that price.
    Probing,
    /// Shadows propose goals, observe episodes, learn and have rollouts of theirs played.
    Shadowing,
    /// The student takes its gradient steps.
    Learning,
    /// The part of [`Learning`](Self::Learning) in which it draws batches, if the student reports it.
    Sampling,
    /// The student is evaluated, diagnosed and measured.
    Evaluating,
    /// A checkpoint is put together and saved.
    Saving,
}

/// Hears of a run's progress.
pub trait Observer {
    /// The run spent `time` in `stage`: per episode or cycle, not per step.
    fn spent(&mut self, _stage: Stage, _time: Duration) {}

    /// An evaluation is over.
    ///
    /// # Errors
    /// If it cannot be recorded; the run then ends.
    fn record(
        &mut self,
        _record: &Record,
        _teaching: &Teaching,
        _learning: &Learning,
    ) -> std::io::Result<()> {
        Ok(())
    }

    /// At the evaluation that was told of last, the student was measured at every goal of the pool.
    ///
    /// # Errors
    /// If it cannot be recorded; the run then ends.
    fn measured(&mut self, _frontier: &Frontier) -> std::io::Result<()> {
        Ok(())
    }

    /// What the shadows did up to the evaluation that was told of last.
    ///
    /// # Errors
    /// If it cannot be recorded; the run then ends.
    fn shadowed(&mut self, _shadowing: &Shadowing) -> std::io::Result<()> {
        Ok(())
    }

    /// A turn is over, a cycle of training or some probe rollouts, with its evaluation if one was due; `step`
    /// steps of the budget are taken.
    ///
    /// # Errors
    /// If the observer cannot go on; the run then ends.
    fn cycle(&mut self, _step: u64) -> std::io::Result<()> {
        Ok(())
    }

    /// Itself, if it saves checkpoints.
    fn checkpointer(&mut self) -> Option<&mut dyn Checkpointer> {
        None
    }
}

/// Hears nothing.
impl Observer for () {}

/// All hear everything, in order. The first that saves checkpoints is the one that does.
impl Observer for Vec<&mut dyn Observer> {
    fn spent(&mut self, stage: Stage, time: Duration) {
        self.iter_mut().for_each(|observer| observer.spent(stage, time));
    }

    fn record(&mut self, record: &Record, teaching: &Teaching, learning: &Learning) -> std::io::Result<()> {
        self.iter_mut().try_for_each(|observer| observer.record(record, teaching, learning))
    }

    fn measured(&mut self, frontier: &Frontier) -> std::io::Result<()> {
        self.iter_mut().try_for_each(|observer| observer.measured(frontier))
    }

    fn shadowed(&mut self, shadowing: &Shadowing) -> std::io::Result<()> {
        self.iter_mut().try_for_each(|observer| observer.shadowed(shadowing))
    }

    fn cycle(&mut self, step: u64) -> std::io::Result<()> {
        self.iter_mut().try_for_each(|observer| observer.cycle(step))
    }

    fn checkpointer(&mut self) -> Option<&mut dyn Checkpointer> {
        self.iter_mut().find_map(|observer| observer.checkpointer())
    }
}

/// What a [`Checkpointer`] wants after a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Train on.
    GoOn,
    /// Save a checkpoint, then train on.
    Save,
    /// Save a checkpoint and stop.
    SaveAndStop,
}

/// Saves a run, and may stop it.
pub trait Checkpointer {
    /// What to do now that a cycle is over, `evaluated` if an evaluation followed it.
    fn wish(&mut self, evaluated: bool) -> Wish;

    /// Where the student's replay log lies.
    fn replay_folder(&self) -> &Path;

    /// Keeps a checkpoint.
    ///
    /// # Errors
    /// If it cannot be written; the run then ends.
    fn save(&mut self, state: TrainerState) -> std::io::Result<()>;
}

/// Adds up the time spent in each stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes([Duration; Stage::Saving as usize + 1]);

impl StageTimes {
    /// Seconds in `stage` so far.
    pub fn seconds(&self, stage: Stage) -> f64 {
        self.0[stage as usize].as_secs_f64()
    }
}

impl Observer for StageTimes {
    fn spent(&mut self, stage: Stage, time: Duration) {
        self.0[stage as usize] += time;
    }
}

/// A watch that is read several times in a row: reading it costs some 50 ns.
pub(super) struct Laps(Instant);

impl Laps {
    pub(super) fn begin() -> Self {
        Self(Instant::now())
    }

    /// Time since the last reading.
    pub(super) fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.0, now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Saves(u32);

    impl Observer for Saves {
        fn checkpointer(&mut self) -> Option<&mut dyn Checkpointer> {
            Some(self)
        }
    }

    impl Checkpointer for Saves {
        fn wish(&mut self, _: bool) -> Wish {
            self.0 += 1;
            Wish::GoOn
        }

        fn replay_folder(&self) -> &Path {
            Path::new("")
        }

        fn save(&mut self, _: TrainerState) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_list_passes_on_what_it_hears_and_saves_once() {
        let (mut one, mut other) = (StageTimes::default(), StageTimes::default());
        let (mut first, mut second) = (Saves(0), Saves(0));
        let mut list: Vec<&mut dyn Observer> = vec![&mut one, &mut first, &mut second, &mut other];
        list.spent(Stage::Saving, Duration::from_secs(2));
        list.checkpointer().expect("there are two").wish(true);
        assert_eq!((one.seconds(Stage::Saving), other.seconds(Stage::Saving)), (2.0, 2.0));
        assert_eq!((one.seconds(Stage::Resetting), first.0, second.0), (0.0, 1, 0));
    }
}
