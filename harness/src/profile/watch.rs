//! The watcher of a profiled run.

use std::path::Path;
use std::time::{Duration, Instant};

use agents::Products;
use reports::schema::{Record, Teaching};

use super::costs::{Costs, Size};
use super::timed::Clock;
use crate::run::checkpoint::{self, Checkpoint};
use crate::run::folder::Extent;
use crate::run::train::{Phase, TrainerState, Watcher, Wish};

/// Adds up what the loop tells, runs the bare products after every cycle, and saves one checkpoint at the end.
pub(super) struct Watch<'a> {
    folder: &'a Path,
    products: Products,
    products_per_cycle: usize,
    teacher: Duration,
    learning: Duration,
    evaluation: Duration,
    evaluations: u32,
    bare_products: Duration,
    checkpoint: Duration,
    /// All of the cycles, their evaluations apart.
    training: Duration,
    /// When the running cycle began, and how much had been evaluated by then.
    cycle_begun: (Instant, Duration),
}

impl<'a> Watch<'a> {
    /// Saves its checkpoint in `folder`.
    pub(super) fn new(folder: &'a Path, products: Products, products_per_cycle: usize) -> Self {
        Self {
            folder,
            products,
            products_per_cycle,
            teacher: Duration::ZERO,
            learning: Duration::ZERO,
            evaluation: Duration::ZERO,
            evaluations: 0,
            bare_products: Duration::ZERO,
            checkpoint: Duration::ZERO,
            training: Duration::ZERO,
            cycle_begun: (Instant::now(), Duration::ZERO),
        }
    }

    /// Seconds per training step of a run of this kind.
    pub(super) fn costs(&self, clock: &Clock, size: Size) -> Costs {
        let per_step = |seconds: f64| seconds / size.steps as f64;
        let at_evaluations = |seconds: f64| seconds / size.evaluation_every as f64;
        let [sampling, learning] = [clock.sampling.seconds(), self.learning.as_secs_f64()];
        let products = self.bare_products.as_secs_f64();
        let teacher = self.teacher.as_secs_f64();
        let [physics, resets, acting, storing] =
            [&clock.stepping, &clock.resetting, &clock.acting, &clock.storing].map(|sum| sum.seconds());
        let told_apart = physics + resets + acting + storing + learning + teacher;
        Costs {
            physics: per_step(physics),
            resets: per_step(resets),
            acting: per_step(acting),
            storing: per_step(storing),
            products: per_step(products),
            beside_products: per_step(learning - sampling - products),
            sampling: per_step(sampling),
            teacher: per_step(teacher),
            evaluation: at_evaluations(self.evaluation.as_secs_f64() / f64::from(self.evaluations)),
            checkpoint: at_evaluations(self.checkpoint.as_secs_f64()),
            rest: per_step(self.training.as_secs_f64() - told_apart),
        }
    }
}

impl Watcher for Watch<'_> {
    fn spent(&mut self, phase: Phase, time: Duration) {
        match phase {
            Phase::Teacher => self.teacher += time,
            Phase::Learning => self.learning += time,
            Phase::Evaluation => self.evaluation += time,
        }
    }

    fn record(&mut self, record: &Record, _: &Teaching) -> std::io::Result<()> {
        self.evaluations += 1;
        if record.eval_index == 0 {
            // The first evaluation comes before the first cycle.
            self.cycle_begun = (Instant::now(), self.evaluation);
        }
        Ok(())
    }

    fn cycle(&mut self, _: u64, evaluated: bool) -> std::io::Result<Wish> {
        let (begun, evaluation) = self.cycle_begun;
        self.training += begun.elapsed() - (self.evaluation - evaluation);
        let begun = Instant::now();
        for _ in 0..self.products_per_cycle {
            self.products.run().map_err(std::io::Error::other)?;
        }
        self.cycle_begun = (Instant::now(), self.evaluation);
        self.bare_products += self.cycle_begun.0 - begun;
        Ok(if evaluated { Wish::Save } else { Wish::GoOn })
    }

    fn replay_folder(&self) -> &Path {
        self.folder
    }

    fn save(&mut self, trainer: TrainerState) -> std::io::Result<()> {
        let checkpoint = Checkpoint { run: String::new(), trainer, progress: Extent::default() };
        checkpoint::write(self.folder, &checkpoint).map_err(std::io::Error::other)?;
        // The loop asked for its parts right after the last cycle.
        self.checkpoint = self.cycle_begun.0.elapsed();
        Ok(())
    }
}
