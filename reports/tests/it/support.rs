//! Results folders by hand, for tests of what is read and reported.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use reports::layout;
use reports::record::{Manifest, Outcome, Record, RunKey, SCHEMA, Timing};
use serde::Serialize;
use serde_json::{Map, Value, json};

pub(crate) fn key(environment: &str, curriculum: &str, variant: &str, seed: u64) -> RunKey {
    RunKey { environment: environment.into(), curriculum: curriculum.into(), variant: variant.into(), seed }
}

/// A finished run with an evaluation of 20 episodes every 1,000 steps, `rates` their success rates. Gives the
/// folder of the run.
pub(crate) fn write_run(results: &Path, run: &RunKey, rates: &[f64]) -> PathBuf {
    write_configured(results, run, rates, json!({"agent": {"width": 256}}))
}

/// As [`write_run`], with a config.
pub(crate) fn write_configured(results: &Path, run: &RunKey, rates: &[f64], config: Value) -> PathBuf {
    let folder = layout::run_dir(results, run);
    fs::create_dir_all(&folder).unwrap();
    let manifest =
        Manifest { schema: SCHEMA, run: run.clone(), config, hash: "none".into(), versions: BTreeMap::new() };
    let records: Vec<Record> = (0..).zip(rates).map(|(index, &rate)| record(run, index, rate)).collect();
    let timing = |record: &Record| Timing {
        eval_index: record.eval_index,
        step: record.step,
        wall_s: 1.8 * record.step as f64,
        evaluation_s: 0.0,
        teacher_s: Some(0.36 * record.step as f64),
        learning_s: Some(0.9 * record.step as f64),
    };
    let outcome = Outcome::Finished { step: records.last().map_or(0, |record| record.step) };
    fs::write(folder.join(layout::MANIFEST), line(&manifest)).unwrap();
    fs::write(folder.join(layout::RECORDS), records.iter().map(line).collect::<String>()).unwrap();
    fs::write(folder.join(layout::TIMING), records.iter().map(|r| line(&timing(r))).collect::<String>())
        .unwrap();
    fs::write(folder.join(layout::OUTCOME), line(&outcome)).unwrap();
    folder
}

pub(crate) fn record(run: &RunKey, eval_index: u64, success_rate: f64) -> Record {
    Record {
        environment: run.environment.clone(),
        curriculum: run.curriculum.clone(),
        variant: run.variant.clone(),
        seed: run.seed,
        step: 1_000 * eval_index,
        eval_index,
        episodes: 20,
        success_rate,
        mean_return: -50.0,
        gradient_steps: 400 * eval_index,
        teacher: Map::from_iter([
            ("entropy".to_owned(), json!(eval_index)),
            ("undefined".to_owned(), json!(null)),
        ]),
    }
}

/// A line of JSON, newline included.
pub(crate) fn line<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).unwrap() + "\n"
}
