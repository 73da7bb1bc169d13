//! The observer of a profiled run.

use std::path::Path;
use std::time::{Duration, Instant};

use agents::Products;
use reports::schema::{Learning, Record, Teaching};

use super::costs::{Costs, Size};
use crate::run::checkpoint::{self, Checkpoint};
use crate::run::folder::Extent;
use crate::run::observer::{Checkpointer, Observer, Stage, StageTimes, Wish};
use crate::run::state::TrainerState;

/// Adds up the times that the loop tells, runs the bare products after every cycle, and saves one checkpoint
/// at the end.
pub(super) struct Watch<'a> {
    folder: &'a Path,
    products: Products,
    products_per_cycle: usize,
    times: StageTimes,
    evaluations: u32,
    bare_products: Duration,
    /// Time of all cycles, without evaluations and checkpoint.
    training: Duration,
    /// When the current cycle began, moved forward by the time of an evaluation after it.
    begun: Instant,
}

impl<'a> Watch<'a> {
    /// Saves its checkpoint in `folder`.
    pub(super) fn new(folder: &'a Path, products: Products, products_per_cycle: usize) -> Self {
        Self {
            folder,
            products,
            products_per_cycle,
            times: StageTimes::default(),
            evaluations: 0,
            bare_products: Duration::ZERO,
            training: Duration::ZERO,
            begun: Instant::now(),
        }
    }

    /// Seconds per training step of a run of this kind.
    pub(super) fn costs(&self, size: Size) -> Costs {
        let seconds = |stage| self.times.seconds(stage);
        let per_step = |seconds: f64| seconds / size.steps as f64;
        let at_evaluations = |seconds: f64| seconds / size.evaluation_every as f64;
        let products = self.bare_products.as_secs_f64();
        let told_apart: f64 = [
            Stage::Stepping,
            Stage::Resetting,
            Stage::Acting,
            Stage::Storing,
            Stage::Learning,
            Stage::Teaching,
            Stage::Probing,
        ]
        .map(seconds)
        .iter()
        .sum();
        Costs {
            physics: per_step(seconds(Stage::Stepping)),
            resets: per_step(seconds(Stage::Resetting)),
            acting: per_step(seconds(Stage::Acting)),
            storing: per_step(seconds(Stage::Storing)),
            products: per_step(products),
            beside_products: per_step(seconds(Stage::Learning) - seconds(Stage::Sampling) - products),
            sampling: per_step(seconds(Stage::Sampling)),
            teacher: per_step(seconds(Stage::Teaching) + seconds(Stage::Probing)),
            evaluation: at_evaluations(seconds(Stage::Evaluating) / f64::from(self.evaluations)),
            checkpoint: at_evaluations(seconds(Stage::Saving)),
            rest: per_step(self.training.as_secs_f64() - told_apart),
        }
    }
}

impl Observer for Watch<'_> {
    fn spent(&mut self, stage: Stage, time: Duration) {
        self.times.spent(stage, time);
        if stage == Stage::Evaluating {
            // An evaluation is no part of the cycle that it follows.
            self.evaluations += 1;
            self.begun += time;
        }
    }

    fn record(&mut self, record: &Record, _: &Teaching, _: &Learning) -> std::io::Result<()> {
        if record.eval_index == 0 {
            // The first evaluation comes before the first cycle.
            self.begun = Instant::now();
        }
        Ok(())
    }

    fn cycle(&mut self, _: u64) -> std::io::Result<()> {
        self.training += self.begun.elapsed();
        let begun = Instant::now();
        for _ in 0..self.products_per_cycle {
            self.products.run().map_err(std::io::Error::other)?;
        }
        self.begun = Instant::now();
        self.bare_products += self.begun - begun;
        Ok(())
    }

    fn checkpointer(&mut self) -> Option<&mut dyn Checkpointer> {
        Some(self)
    }
}

impl Checkpointer for Watch<'_> {
    fn wish(&mut self, evaluated: bool) -> Wish {
        if evaluated { Wish::Save } else { Wish::GoOn }
    }

    fn replay_folder(&self) -> &Path {
        self.folder
    }

    fn save(&mut self, trainer: TrainerState) -> std::io::Result<()> {
        let checkpoint = Checkpoint { run: String::new(), trainer, progress: Extent::default() };
        checkpoint::write(self.folder, &checkpoint).map_err(std::io::Error::other)
    }
}
