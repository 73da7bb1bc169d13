//! Evaluations and runs for unit tests.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use crate::schema::{Manifest, Outcome, Record, RunKey, SCHEMA};
use crate::store::Run;

/// The evaluation of the untrained student of `E/c/default/seed-0`: 20 episodes, half of them successful.
pub(crate) fn record() -> Record {
    let [environment, curriculum, variant] = ["E", "c", "default"].map(String::from);
    Record {
        environment,
        curriculum,
        variant,
        seed: 0,
        step: 0,
        eval_index: 0,
        episodes: 20,
        success_rate: 0.5,
        any_success_rate: None,
        mean_return: -1.0,
        gradient_steps: 0,
        probe_steps: 0,
        uncharged_steps: 0,
        teacher: Map::new(),
    }
}

/// One evaluation after the other, with these steps and success rates.
pub(crate) fn records(points: &[(u64, f64)]) -> Vec<Record> {
    let at = |(eval_index, &(step, success_rate)): (u64, &(u64, f64))| Record {
        step,
        eval_index,
        success_rate,
        ..record()
    };
    (0..).zip(points).map(at).collect()
}

/// `E/c/VARIANT/seed-SEED`, with these success rates, 10 steps apart. In each of these intervals it took 4
/// gradient steps, and 2 steps of rollouts that were not charged.
pub(crate) fn run(variant: &str, seed: u64, rates: &[f64], outcome: Outcome) -> Run {
    let [environment, curriculum, variant] = ["E", "c", variant].map(String::from);
    let points: Vec<(u64, f64)> = (0..).map(|index| 10 * index).zip(rates.iter().copied()).collect();
    let counted = |record: Record| Record {
        variant: variant.clone(),
        seed,
        gradient_steps: 4 * record.eval_index,
        uncharged_steps: 2 * record.eval_index,
        ..record
    };
    let records = records(&points).into_iter().map(counted).collect();
    let manifest = Manifest {
        schema: SCHEMA,
        run: RunKey { environment, curriculum, variant, seed },
        config: Value::Null,
        hash: String::new(),
        versions: BTreeMap::new(),
        earlier_budgets: Vec::new(),
    };
    Run { manifest, records, timings: Vec::new(), outcome: Some(outcome) }
}
