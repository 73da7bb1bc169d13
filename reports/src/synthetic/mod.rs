//! Made-up results: seeded learning curves in the form that runs leave on disk, for tests and speed
//! measurements.
//!
//! Their manifests say so (`config.synthetic`), so that they never pass for measured ones.

mod catalogue;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use serde_json::{Map, Value, json};

pub use catalogue::catalogue;

use crate::error::ReportError;
use crate::schema::{Learning, Manifest, Outcome, Record, RunKey, SCHEMA, Teaching, Timing};
use crate::store::checksums::{self, Checksums};
use crate::store::{RunFolder, layout};

/// Goals in the pool.
const POOL: u32 = 1_000;

/// Which results to make up. Every combination of environment, curriculum and variant gets `seeds` runs.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Environment ids.
    pub environments: Vec<String>,
    /// Curriculum ids.
    pub curricula: Vec<String>,
    /// Variant labels.
    pub variants: Vec<String>,
    /// Number of run seeds: 0, 1, ...
    pub seeds: u64,
    /// Evaluations per run, that of the untrained student included.
    pub evaluations: u64,
    /// Training steps from one evaluation to the next.
    pub interval: u64,
    /// Episodes per evaluation.
    pub episodes: u64,
    /// Seed of everything made up.
    pub seed: u64,
    /// Whether runs tell what their teacher did, as in a maze: goals in [-1, 1]².
    pub teaching: bool,
}

impl Default for Experiment {
    /// The size of one environment of a comparison: 1 environment, the 6 methods of the made-up
    /// [`catalogue`()], 7 seeds, 101 evaluations.
    fn default() -> Self {
        Self {
            environments: owned(&["ArmReach"]),
            curricula: catalogue().methods().iter().map(|method| method.id.clone()).collect(),
            variants: owned(&["default"]),
            seeds: 7,
            evaluations: 101,
            interval: 10_000,
            episodes: 20,
            seed: 0,
            teaching: false,
        }
    }
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

impl Experiment {
    /// The size of the whole made-up paper: 462 runs of 101 evaluations on 11 environments, 168 runs of
    /// ablations in rooms, and 98 of readings of the paper in two of them.
    pub fn paper() -> Vec<Self> {
        let tasks = catalogue().paper.tasks;
        let tasks = tasks.iter().filter_map(|ids| ids.first().cloned());
        let (rooms, others): (Vec<String>, Vec<String>) = tasks.partition(|id| id.starts_with("Room"));
        let two = rooms[..2].to_vec();
        let windows = ["n=3", "n=3,confidence=target-critic", "n=5", "n=20"];
        let interplays = ["delta=2", "delta=5", "delta=10", "delta=50"];
        let readings =
            ["selection=argmax", "states=replay", "selection=argmax,goals=pool", "states=replay,goals=pool"];
        let main = Self::default();
        let in_rooms = Self { environments: rooms, interval: 4_000, teaching: true, ..main.clone() };
        let of_nova = Self { curricula: owned(&["nova"]), ..in_rooms.clone() };
        let pool = Self { variants: owned(&["goals=pool"]), environments: two.clone(), ..in_rooms.clone() };
        vec![
            Self { environments: others, ..main },
            Self { seed: 1, ..in_rooms },
            Self { seed: 2, variants: owned(&[windows, interplays].concat()), ..of_nova.clone() },
            Self { seed: 3, environments: two, variants: owned(&readings), ..of_nova },
            Self { seed: 4, curricula: owned(&["nova", "dull", "dull-pool"]), ..pool },
        ]
    }

    /// Writes all runs into the results folder `results`.
    ///
    /// # Errors
    /// [`ReportError::Io`] if a file cannot be written.
    pub fn write(&self, results: &Path) -> Result<(), ReportError> {
        let mut stream = 0;
        for environment in &self.environments {
            for curriculum in &self.curricula {
                for variant in &self.variants {
                    let trend = Trend::draw(&mut self.rng(&mut stream));
                    for seed in 0..self.seeds {
                        let run = RunKey {
                            environment: environment.clone(),
                            curriculum: curriculum.clone(),
                            variant: variant.clone(),
                            seed,
                        };
                        self.write_run(results, &run, trend, &mut self.rng(&mut stream))?;
                    }
                }
            }
        }
        Ok(())
    }

    fn rng(&self, stream: &mut u64) -> ChaCha8Rng {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(*stream);
        *stream += 1;
        rng
    }

    fn config(&self, run: &RunKey) -> Value {
        let teacher = if run.curriculum == "nova" { settings(&run.variant) } else { json!({}) };
        let goals = setting(&run.variant, "goals").unwrap_or("environment");
        json!({
            "synthetic": true,
            "evaluation": { "every": self.interval, "episodes": self.episodes, "goals": goals },
            "curriculum": { run.curriculum.as_str(): teacher },
        })
    }

    /// What a teacher might do before an evaluation: its goals move away from a corner while the student
    /// improves.
    fn teach(&self, eval_index: u64, trend: Trend, rng: &mut ChaCha8Rng) -> Teaching {
        let share = eval_index as f64 / self.evaluations.max(1) as f64;
        let reach = (0.3 + 1.4 * share) as f32;
        let episodes = (self.interval / 50).max(1);
        let mut line = Teaching { eval_index, step: eval_index * self.interval, ..Teaching::default() };
        line.picks = Some((0..episodes).map(|_| Some(rng.random_range(0..POOL))).collect());
        for _ in 0..episodes {
            let coordinate = |rng: &mut ChaCha8Rng| (-0.9 + reach * rng.random::<f32>()).min(0.9);
            line.goals.push(vec![coordinate(rng), coordinate(rng)]);
            line.successes.push(rng.random_bool(trend.at(share)));
        }
        line
    }

    /// How a student's learning might stand at an evaluation: its values rise and its gradients fall with its
    /// success.
    fn learn(&self, eval_index: u64, trend: Trend, rng: &mut ChaCha8Rng) -> Learning {
        let step = eval_index * self.interval;
        let rate = trend.at(eval_index as f64 / self.evaluations.max(1) as f64);
        let empty = Learning { eval_index, step, ..Learning::default() };
        if eval_index == 0 {
            return empty;
        }
        let mut around = |value: f64| Some(value * rng.random_range(0.8..1.2));
        let mean_q = around(-25.0 * (1.0 - rate));
        Learning {
            critic_loss: around(0.05 + 2.0 * rate),
            actor_loss: mean_q.map(|q| 0.1 - q),
            mean_q,
            critic_gradient_norm: around(1.5),
            actor_gradient_norm: around(0.3 * (1.0 - 0.8 * rate)),
            replay_episodes: step / 50,
            replay_transitions: step / 50 * 50,
            ..empty
        }
    }

    fn write_run(
        &self,
        results: &Path,
        run: &RunKey,
        trend: Trend,
        rng: &mut ChaCha8Rng,
    ) -> Result<(), ReportError> {
        let trend = trend.vary(rng);
        let (mut records, mut timings) = (Vec::new(), Vec::new());
        for eval_index in 0..self.evaluations {
            let step = eval_index * self.interval;
            let rate = trend.at(eval_index as f64 / self.evaluations.max(1) as f64);
            let successes = (0..self.episodes).filter(|_| rng.random_bool(rate)).count() as f64;
            let success_rate = successes / self.episodes as f64;
            // Some leave their goal again.
            let left = rng.random_range(0..=self.episodes - successes as u64) / 4;
            records.push(Record {
                environment: run.environment.clone(),
                curriculum: run.curriculum.clone(),
                variant: run.variant.clone(),
                seed: run.seed,
                step,
                eval_index,
                episodes: self.episodes,
                success_rate,
                any_success_rate: Some((successes + left as f64) / self.episodes as f64),
                mean_return: -50.0 * (1.0 - 0.8 * success_rate),
                gradient_steps: step * 2 / 5,
                probe_steps: 0,
                uncharged_steps: 0,
                teacher: numbers(&run.curriculum, eval_index, rng),
            });
            timings.push(timing(&run.curriculum, eval_index, step));
        }
        let config = self.config(run);
        let manifest = Manifest {
            schema: SCHEMA,
            run: run.clone(),
            hash: checksums::manifest_hash(run, &config),
            config,
            versions: BTreeMap::from([("goalbench".to_owned(), env!("CARGO_PKG_VERSION").to_owned())]),
            earlier_budgets: Vec::new(),
        };
        let end = self.evaluations.saturating_sub(1) * self.interval;
        let folder = layout::run_dir(results, run);
        fs::create_dir_all(&folder).map_err(ReportError::io(&folder, "create this folder"))?;
        let file = |name: &str, text: String| {
            let path = folder.join(name);
            fs::write(&path, text).map_err(ReportError::io(&path, "write this file"))
        };
        file(layout::MANIFEST, json_line(&manifest))?;
        file(layout::RECORDS, records.iter().map(json_line).collect())?;
        if self.teaching {
            file(
                layout::TEACHING,
                (1..self.evaluations).map(|index| json_line(&self.teach(index, trend, rng))).collect(),
            )?;
            let student = (0..self.evaluations).map(|index| self.learn(index, trend, rng));
            file(layout::STUDENT, student.map(|line| json_line(&line)).collect())?;
        }
        file(layout::TIMING, timings.iter().map(json_line).collect())?;
        let sums = Checksums::of(&RunFolder::new(&folder), &manifest.hash);
        let sums = sums.map_err(|error| ReportError::io(&folder, "read this folder")(error.into()))?;
        let outcome = json_line(&Outcome::Finished { step: end });
        file(layout::CHECKSUMS, json_line(&sums.with_outcome(outcome.as_bytes())))?;
        file(layout::OUTCOME, outcome)
    }
}

/// The time taken by `step`: 100 steps a second without a teacher, of which one with networks of its own
/// leaves 40.
fn timing(curriculum: &str, eval_index: u64, step: u64) -> Timing {
    let student_s = step as f64 / 100.0;
    let teacher_s = match curriculum {
        "wren" => 1.5 * student_s,
        "dull" | "dull-pool" => 0.0,
        _ => 0.1 * student_s,
    };
    Timing {
        eval_index,
        step,
        wall_s: student_s + teacher_s,
        evaluation_s: 0.1 * student_s,
        teacher_s: Some(teacher_s),
        learning_s: Some(0.6 * student_s),
        shadow_s: None,
    }
}

/// The value of `name` in a variant's label: `n=3,confidence=target-critic`, `delta=5`,
/// `states=replay,goals=pool`.
fn setting<'a>(variant: &'a str, name: &str) -> Option<&'a str> {
    let pairs = variant.split(',').filter_map(|setting| setting.split_once('='));
    pairs.into_iter().find(|(other, _)| *other == name).map(|(_, value)| value)
}

/// The settings of the paper's own method as a variant's label says; the defaults elsewhere.
fn settings(variant: &str) -> Value {
    let number =
        |name, default: u64| setting(variant, name).and_then(|value| value.parse().ok()).unwrap_or(default);
    let text = |name, default| setting(variant, name).unwrap_or(default);
    json!({
        "window": number("n", 10),
        "interplay": number("delta", 1),
        "confidence": text("confidence", "online"),
        "states": text("states", "reference"),
        "selection": text("selection", "proportional"),
        "record": text("record", "cycle"),
    })
}

/// What a teacher records of an evaluation: nothing is defined before the first episode, and DULL picks
/// nothing.
fn numbers(curriculum: &str, eval_index: u64, rng: &mut ChaCha8Rng) -> Map<String, Value> {
    if curriculum == "dull" {
        return Map::from_iter([(names::PICKED_GOALS.to_owned(), Value::Null)]);
    }
    let effective = rng.random_range(2.0..f64::from(POOL));
    let picked = rng.random_range(1..=80);
    let numbers = [
        (names::ENTROPY, json!(effective.ln())),
        (names::EFFECTIVE_GOALS, json!(effective)),
        (names::PICKED_GOALS, json!(picked)),
        (names::EFFECTIVE_PICKS, json!(f64::from(picked) * rng.random_range(0.5..1.0))),
        (names::PICK_RANK_MEAN, json!((curriculum == "moss").then(|| rng.random_range(0.4..0.6)))),
        (names::SCORE_SUCCESS_CORRELATION, json!(rng.random_range(-0.5..0.5))),
    ];
    let defined = |value| if eval_index == 0 { Value::Null } else { value };
    numbers.into_iter().map(|(name, value)| (name.to_owned(), defined(value))).collect()
}

/// A logistic learning curve.
#[derive(Clone, Copy)]
struct Trend {
    /// Success rate after long training.
    ceiling: f64,
    /// Share of the budget at half of that.
    midpoint: f64,
    /// Slope.
    rate: f64,
}

impl Trend {
    fn draw(rng: &mut ChaCha8Rng) -> Self {
        Self {
            ceiling: rng.random_range(0.3..1.0),
            midpoint: rng.random_range(0.1..0.7),
            rate: rng.random_range(6.0..20.0),
        }
    }

    /// The same trend for another seed.
    fn vary(self, rng: &mut ChaCha8Rng) -> Self {
        Self {
            ceiling: (self.ceiling + rng.random_range(-0.1..0.1)).clamp(0.0, 1.0),
            midpoint: self.midpoint * rng.random_range(0.7..1.3),
            rate: self.rate,
        }
    }

    /// Success rate after a share of the budget.
    fn at(self, share: f64) -> f64 {
        self.ceiling / (1.0 + (-self.rate * (share - self.midpoint)).exp())
    }
}

fn json_line<T: Serialize>(value: &T) -> String {
    // These types hold no map with other keys than strings, which is all that could fail.
    let mut line = serde_json::to_string(value).unwrap_or_default();
    line.push('\n');
    line
}
