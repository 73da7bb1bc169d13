//! What a training step costs, part by part, and the least that it could cost.

use std::fmt::Write as _;

use agents::{Precision, ProductRates};
use reports::schema::RunKey;
use reports::wording::{counted, counted_u64};
use serde::Serialize;
use serde_json::{Value, json};

/// How much was done, and what a whole run does beside it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Size {
    /// Cycles.
    pub cycles: u64,
    /// Training steps.
    pub steps: u64,
    /// Gradient steps.
    pub updates: u64,
    /// Training steps between two evaluations of a whole run, each with a checkpoint.
    pub evaluation_every: u64,
}

/// Seconds per training step of a whole run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Costs {
    /// The environment's steps.
    pub physics: f64,
    /// Its resets.
    pub resets: f64,
    /// Exploring actions.
    pub acting: f64,
    /// Taking in episodes: into the replay buffer and the normalisers.
    pub storing: f64,
    /// The matrix products of the gradient steps, run alone.
    pub products: f64,
    /// The rest of the gradient steps: what lies between the products, Adam, Polyak.
    pub beside_products: f64,
    /// Drawing batches from the replay buffer, with relabelling.
    pub sampling: f64,
    /// The teacher.
    pub teacher: f64,
    /// Evaluations.
    pub evaluation: f64,
    /// Checkpoints.
    pub checkpoint: f64,
    /// Everything else in the loop.
    pub rest: f64,
}

/// A part of the costs.
pub struct CostPart {
    /// Its key in JSON.
    pub name: &'static str,
    /// For people.
    pub about: &'static str,
    /// Seconds per training step.
    pub seconds: f64,
}

impl Costs {
    /// The parts in the order in which they are shown.
    pub fn parts(&self) -> [CostPart; 11] {
        let part = |name, about, seconds| CostPart { name, about, seconds };
        [
            part("physics", "steps of the environment", self.physics),
            part("resets", "resets of the environment", self.resets),
            part("acting", "exploring actions, one at a time", self.acting),
            part("storing", "episodes into replay and normalisers", self.storing),
            part("products", "matrix products of the updates, run alone", self.products),
            part(
                "beside_products",
                "rest of the updates: between products, Adam, Polyak",
                self.beside_products,
            ),
            part("sampling", "batches from replay, relabelled", self.sampling),
            part("teacher", "proposing, observing, learning", self.teacher),
            part("evaluation", "greedy episodes, in lockstep", self.evaluation),
            part("checkpoint", "student, teacher and new episodes to disk", self.checkpoint),
            part("rest", "everything else in the loop", self.rest),
        ]
    }

    /// Seconds per training step, all in all.
    pub fn total(&self) -> f64 {
        self.parts().iter().map(|part| part.seconds).sum()
    }

    /// 1/(physics + products): training steps per second if nothing else took time.
    pub fn limit(&self) -> f64 {
        1.0 / (self.physics + self.products)
    }

    /// Training steps per second of a whole run as a share of [`Costs::limit`].
    pub fn share_of_limit(&self) -> f64 {
        1.0 / (self.total() * self.limit())
    }

    /// Time of the gradient steps as a multiple of their bare products, with or without the drawing of
    /// batches.
    fn over_products(&self, sampling: bool) -> f64 {
        let drawing = if sampling { self.sampling } else { 0.0 };
        (self.products + self.beside_products + drawing) / self.products
    }
}

/// Bytes of memory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Memory {
    /// The most that the process has held, its few episodes of experience included.
    pub peak: u64,
    /// The same once the replay buffer is full.
    pub peak_with_full_replay: u64,
    /// The full replay buffer's share of that.
    pub full_replay: u64,
}

/// The profile of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunProfile {
    /// Which run.
    pub run: RunKey,
    /// Transitions per gradient step.
    pub batch: usize,
    /// Hidden layers.
    pub layers: usize,
    /// What was done.
    pub size: Size,
    /// What it cost.
    pub costs: Costs,
    /// Operations in the matrix products of a gradient step, in units of 10⁹.
    pub gflop: f64,
    /// How fast this machine computes these products, in this precision and in the other.
    pub rates: ProductRates,
    /// The memory that it took.
    pub memory: Memory,
}

impl RunProfile {
    /// Gradient steps per training step.
    fn updates_per_step(&self) -> f64 {
        self.size.updates as f64 / self.size.steps as f64
    }

    /// Training steps per second of a whole run.
    pub fn steps_per_second(&self) -> f64 {
        1.0 / self.costs.total()
    }

    /// Seconds that the bare products of a gradient step take.
    fn products_per_update(&self) -> f64 {
        self.costs.products / self.updates_per_step()
    }

    fn rates_by_name(&self) -> impl Iterator<Item = (String, Value)> {
        Precision::ALL
            .into_iter()
            .zip(self.rates.gflop_per_second)
            .map(|(p, rate)| (p.name().into(), json!(rate)))
    }

    /// All numbers; times in seconds, memory in bytes.
    pub fn as_json(&self) -> Value {
        let shares =
            self.costs.parts().map(|part| (part.name.to_owned(), json!(part.seconds / self.costs.total())));
        json!({
            "run": self.run,
            "batch": self.batch,
            "layers": self.layers,
            "measured": self.size,
            "seconds_per_step": self.costs,
            "shares": Value::Object(shares.into_iter().collect()),
            "steps_per_second": self.steps_per_second(),
            "updates_per_second": self.steps_per_second() * self.updates_per_step(),
            "limit_steps_per_second": self.costs.limit(),
            "share_of_limit": self.costs.share_of_limit(),
            "products_s_per_update": self.products_per_update(),
            "products_gflop_per_s": self.gflop / self.products_per_update(),
            "best_gflop_per_s": self.rates_by_name().collect::<serde_json::Map<_, _>>(),
            "update_to_products": self.costs.over_products(false),
            "update_and_sampling_to_products": self.costs.over_products(true),
            "memory_bytes": self.memory,
        })
    }

    /// A table for people.
    pub fn as_text(&self) -> String {
        let Self { run, batch, layers, size, costs, memory, .. } = self;
        let mut text = format!(
            "{run}: {}, {}, {} of batch {batch}, {}\n\n",
            counted_u64(size.cycles, "cycle"),
            counted_u64(size.steps, "training step"),
            counted_u64(size.updates, "update"),
            counted(*layers, "hidden layer")
        );
        let mut line = |name: &str, seconds: f64, about: &str| {
            let share = 100.0 * seconds / costs.total();
            let _ = writeln!(text, "{name:<16} {:>12.2} {share:>6.1} %  {about}", 1e6 * seconds);
        };
        for CostPart { name, about, seconds } in costs.parts() {
            line(&name.replace('_', " "), seconds, about);
        }
        line("all", costs.total(), "µs per training step");
        let every = size.evaluation_every;
        let megabytes = |bytes: u64| bytes as f64 / 1e6;
        let _ = write!(
            text,
            "\nOne evaluation and one checkpoint, with this profile's episodes, are counted for every {every} steps.\n\
             {:.1} training steps/s, {:.1} updates/s; at the limit 1/(physics + products) {:.1} steps/s: {:.3} of it\n\
             an update takes {:.2} ms for its bare products ({:.0} GFLOP/s) and {:.3} times that in all ({:.3} with its batch)\n\
             these products at their fastest, without the rest: {:.0} GFLOP/s in f32, {:.0} in bf16\n\
             at most {:.0} MB of memory; {:.0} MB once the replay buffer is full, {:.0} MB of them its own\n",
            self.steps_per_second(),
            self.steps_per_second() * self.updates_per_step(),
            costs.limit(),
            costs.share_of_limit(),
            1e3 * self.products_per_update(),
            self.gflop / self.products_per_update(),
            costs.over_products(false),
            costs.over_products(true),
            self.rates.gflop_per_second[0],
            self.rates.gflop_per_second[1],
            megabytes(memory.peak),
            megabytes(memory.peak_with_full_replay),
            megabytes(memory.full_replay),
        );
        text
    }
}

#[cfg(test)]
mod tests {
    use agents::ProductRates;
    use reports::schema::RunKey;

    use super::{Costs, Memory, RunProfile, Size};

    /// 10 ms per step, of which physics takes 1 and products 4.
    fn profile() -> RunProfile {
        let costs = Costs {
            physics: 1e-3,
            resets: 0.25e-3,
            acting: 0.5e-3,
            storing: 0.25e-3,
            products: 4e-3,
            beside_products: 1e-3,
            sampling: 0.5e-3,
            teacher: 1e-3,
            evaluation: 0.75e-3,
            checkpoint: 0.25e-3,
            rest: 0.5e-3,
        };
        let run = RunKey {
            environment: "FetchPush".into(),
            curriculum: "teach".into(),
            variant: "default".into(),
            seed: 0,
        };
        let size = Size { cycles: 2, steps: 200, updates: 80, evaluation_every: 10_000 };
        let memory =
            Memory { peak: 150_000_000, peak_with_full_replay: 280_000_000, full_replay: 131_000_000 };
        let rates = ProductRates { gflop_per_second: [160.0, 640.0] };
        RunProfile { run, batch: 1024, layers: 2, size, costs, gflop: 1.5, rates, memory }
    }

    #[test]
    fn rates_and_limit_by_hand() {
        let profile = profile();
        let near = |got: f64, expected: f64| assert!((got - expected).abs() < 1e-9 * expected, "{got}");
        near(profile.costs.total(), 10e-3);
        near(profile.steps_per_second(), 100.0);
        near(profile.costs.limit(), 200.0);
        near(profile.costs.share_of_limit(), 0.5);
        let json = profile.as_json();
        let number = |key: &str| json[key].as_f64().expect(key);
        near(number("updates_per_second"), 40.0);
        near(number("products_s_per_update"), 10e-3);
        near(number("products_gflop_per_s"), 150.0);
        near(json["best_gflop_per_s"]["bf16"].as_f64().expect("a rate"), 640.0);
        near(number("update_to_products"), 1.25);
        near(number("update_and_sampling_to_products"), 1.375);
        near(json["shares"]["teacher"].as_f64().expect("a share"), 0.1);
    }

    #[test]
    fn the_table_names_every_part_with_its_share() {
        let text = profile().as_text();
        for part in profile().costs.parts() {
            let share = format!("{:.1} %", 100.0 * part.seconds / 10e-3);
            let line = text.lines().find(|line| line.ends_with(part.about)).expect(part.name);
            assert!(line.starts_with(&part.name.replace('_', " ")) && line.contains(&share), "{line}");
        }
        assert!(text.contains("100.0 training steps/s"), "{text}");
    }
}
