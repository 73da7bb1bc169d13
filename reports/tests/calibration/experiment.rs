//! A simulated experiment: the runs of a method, its baselines and its variants, as if read from a folder.

use std::collections::BTreeMap;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use reports::Catalogue;
use reports::schema::{Manifest, Outcome, Record, RunKey, SCHEMA};
use reports::store::{Run, Store};
use reports::synthetic::catalogue;
use serde_json::{Map, Value, json};

use super::curve::{self, Deviations, EPISODES, EVALUATIONS};
use super::truth::{Design, Outlook, World};

/// Other values of the setting that is claimed to make no difference; the method's own is 10.
const VALUES: [u64; 2] = [3, 20];
/// Training steps between evaluations.
const INTERVAL: u64 = 1_000;

/// The made-up paper with so many baselines, of whose claims two are judged: that the method ends above each
/// of them, and that the window makes no difference.
pub(crate) fn paper(baselines: usize) -> Catalogue {
    let mut catalogue = catalogue();
    let paper = &mut catalogue.paper;
    paper.baselines.extend((paper.baselines.len()..baselines).map(|index| format!("baseline-{index}")));
    paper.claims.retain(|claim| ["final", "window"].contains(&claim.id));
    catalogue
}

/// What the runs of one method have in common.
struct Arm<'a> {
    curriculum: &'a str,
    variant: String,
    config: Value,
    /// Its place among the baselines or the values; `None` for the method itself.
    index: Option<usize>,
}

fn arms(catalogue: &Catalogue) -> Vec<Arm<'_>> {
    let method = &catalogue.paper.method;
    let own = |window: u64| json!({"curriculum": {method: {"window": window, "interplay": 1, "confidence": "online"}}});
    let arm = |curriculum, variant: &str, config, index| Arm {
        curriculum,
        variant: variant.to_owned(),
        config,
        index,
    };
    let mut arms = vec![arm(method, "default", own(10), None)];
    for (index, id) in catalogue.paper.baselines.iter().enumerate() {
        arms.push(arm(id, "default", json!({"curriculum": {id: {}}}), Some(index)));
    }
    for (index, value) in VALUES.into_iter().enumerate() {
        arms.push(arm(method, &format!("n={value}"), own(value), Some(index)));
    }
    arms
}

/// An experiment of `design` in `world`. Each `repetition` has a random stream of its own.
pub(crate) fn simulate(
    world: &World,
    design: Design,
    catalogue: &Catalogue,
    (seed, repetition): (u64, u64),
) -> Store {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(repetition);
    let arms = arms(catalogue);
    let mut runs = Vec::new();
    for (place, ids) in catalogue.paper.tasks.iter().take(design.environments).enumerate() {
        for run_seed in 0..design.seeds {
            let shared = Deviations::draw(&mut rng);
            for arm in &arms {
                let outlook = match arm.index {
                    None => world.method(place),
                    Some(index) => world.other(index, place),
                };
                let key = RunKey {
                    environment: ids[0].clone(),
                    curriculum: arm.curriculum.to_owned(),
                    variant: arm.variant.clone(),
                    seed: run_seed,
                };
                runs.push(run(key, arm.config.clone(), &rates(outlook, shared, &mut rng)));
            }
        }
    }
    Store::of(runs)
}

fn rates(outlook: Outlook, shared: Deviations, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let collapses = rng.random_bool(outlook.collapse);
    let rates = curve::rates(outlook.ceiling, shared, rng);
    if collapses { vec![0.0; EVALUATIONS] } else { rates }
}

/// A finished run with these success rates.
pub(crate) fn run(key: RunKey, config: Value, rates: &[f64]) -> Run {
    let record = |(index, &success_rate): (u64, &f64)| Record {
        environment: key.environment.clone(),
        curriculum: key.curriculum.clone(),
        variant: key.variant.clone(),
        seed: key.seed,
        step: INTERVAL * index,
        eval_index: index,
        episodes: EPISODES,
        success_rate,
        any_success_rate: None,
        mean_return: -50.0,
        gradient_steps: 400 * index,
        probe_steps: 0,
        uncharged_steps: 0,
        teacher: Map::new(),
    };
    let records: Vec<Record> = (0..).zip(rates).map(record).collect();
    let step = records.last().map_or(0, |record| record.step);
    Run {
        manifest: Manifest {
            schema: SCHEMA,
            run: key,
            config,
            hash: "none".into(),
            versions: BTreeMap::new(),
            earlier_budgets: Vec::new(),
        },
        records,
        timings: Vec::new(),
        outcome: Some(Outcome::Finished { step }),
    }
}
