//! Results folders by hand, for tests of what is read and reported.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use reports::ReportOptions;
use reports::analysis::catalogue::{EnvironmentInfo, MazeInfo};
use reports::schema::{Manifest, Outcome, Record, RunKey, SCHEMA, Timing};
use reports::store::checksums::{self, Checksums};
use reports::store::{RunFolder, layout};
use reports::synthetic::{Experiment, catalogue};
use serde::Serialize;
use serde_json::{Map, Value, json};
use tempfile::TempDir;

/// A name that tries to break out of every markup.
pub(crate) const HOSTILE: &str = "<img src=x onerror=alert(1)>&\"'";

pub(crate) fn key(environment: &str, curriculum: &str, variant: &str, seed: u64) -> RunKey {
    RunKey { environment: environment.into(), curriculum: curriculum.into(), variant: variant.into(), seed }
}

/// The usual options, with the made-up catalogue.
pub(crate) fn options() -> ReportOptions {
    ReportOptions { catalogue: catalogue(), ..ReportOptions::default() }
}

/// A finished run with an evaluation of 20 episodes (or 1,000) every 1,000 steps, `rates` their success
/// rates. Gives the folder of the run.
pub(crate) fn write_run(results: &Path, run: &RunKey, rates: &[f64]) -> PathBuf {
    write_configured(results, run, rates, json!({"agent": {"width": 256}}))
}

/// As [`write_run`], with a config.
pub(crate) fn write_configured(results: &Path, run: &RunKey, rates: &[f64], config: Value) -> PathBuf {
    let folder = layout::run_dir(results, run);
    fs::create_dir_all(&folder).unwrap();
    let hash = checksums::manifest_hash(run, &config);
    let manifest = Manifest {
        schema: SCHEMA,
        run: run.clone(),
        config,
        hash,
        versions: BTreeMap::new(),
        earlier_budgets: vec![],
    };
    let records: Vec<Record> = (0..).zip(rates).map(|(index, &rate)| record(run, index, rate)).collect();
    let timing = |record: &Record| Timing {
        eval_index: record.eval_index,
        step: record.step,
        wall_s: 1.8 * record.step as f64,
        evaluation_s: 0.0,
        teacher_s: Some(0.36 * record.step as f64),
        learning_s: Some(0.9 * record.step as f64),
        shadow_s: None,
    };
    let outcome = Outcome::Finished { step: records.last().map_or(0, |record| record.step) };
    fs::write(folder.join(layout::MANIFEST), line(&manifest)).unwrap();
    fs::write(folder.join(layout::RECORDS), records.iter().map(line).collect::<String>()).unwrap();
    fs::write(folder.join(layout::TIMING), records.iter().map(|r| line(&timing(r))).collect::<String>())
        .unwrap();
    fs::write(folder.join(layout::OUTCOME), line(&outcome)).unwrap();
    seal(&folder);
    folder
}

/// Takes what lies in the folder of an ended run for what it ended with: its manifest gets the hash that
/// fits, and it gets checksums.
pub(crate) fn seal(folder: &Path) {
    let path = folder.join(layout::MANIFEST);
    let mut manifest: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let run: RunKey = serde_json::from_value(manifest["run"].clone()).unwrap();
    let hash = checksums::manifest_hash(&run, &manifest["config"]);
    manifest["hash"] = json!(hash);
    fs::write(&path, line(&manifest)).unwrap();
    let sums = Checksums::of(&RunFolder::new(folder), &hash).unwrap();
    fs::write(folder.join(layout::CHECKSUMS), line(&sums)).unwrap();
}

/// Makes a finished run one that failed after its last evaluation.
pub(crate) fn fail(folder: &Path) {
    let step = RunFolder::new(folder).records().unwrap().last().map_or(0, |record| record.step);
    fs::write(folder.join(layout::OUTCOME), line(&Outcome::Failed { step, reason: "NaN".into() })).unwrap();
    seal(folder);
}

/// 20, or 1,000 where 20 episodes cannot have this success rate.
fn episodes(success_rate: f64) -> u64 {
    let successes = 20.0 * success_rate;
    if (successes - successes.round()).abs() < 1e-6 { 20 } else { 1_000 }
}

pub(crate) fn record(run: &RunKey, eval_index: u64, success_rate: f64) -> Record {
    Record {
        environment: run.environment.clone(),
        curriculum: run.curriculum.clone(),
        variant: run.variant.clone(),
        seed: run.seed,
        step: 1_000 * eval_index,
        eval_index,
        episodes: episodes(success_rate),
        success_rate,
        // One of 20 episodes more.
        any_success_rate: Some((success_rate + 0.05).min(1.0)),
        mean_return: -50.0,
        gradient_steps: 400 * eval_index,
        probe_steps: 0,
        uncharged_steps: 0,
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

/// Results of two mazes with names of trouble, and their report with every kind of figure and table.
pub(crate) fn every_kind() -> TempDir {
    let results = TempDir::new().unwrap();
    let environments = ["RoomA", "RoomB"].map(String::from).to_vec();
    for (seed, curricula, variants) in [
        (0, vec!["nova", "wren", "dull"], vec!["default"]),
        (1, vec!["nova"], vec!["n=3", "n=3,confidence=target-critic", "delta=5"]),
        // Readings of the paper, two at each Δ.
        (2, vec!["nova"], vec!["selection=argmax", "delta=5,record=evaluation"]),
    ] {
        let experiment = Experiment {
            environments: environments.clone(),
            curricula: curricula.into_iter().map(String::from).collect(),
            variants: variants.into_iter().map(String::from).collect(),
            seeds: 5,
            evaluations: 6,
            interval: 4_000,
            seed,
            teaching: true,
            ..Experiment::default()
        };
        experiment.write(results.path()).unwrap();
    }
    for environment in &environments {
        write_run(results.path(), &key(environment, HOSTILE, "default", 0), &[0.0, 0.5]);
    }
    write_run(results.path(), &key("RoomA", "nova", "</style><script>", 0), &[0.0, 0.5]);
    let info = |id: &str| EnvironmentInfo {
        id: id.to_owned(),
        state: 2,
        goal: 2,
        action: 2,
        horizon: 50,
        paper_action: None,
        note: HOSTILE.to_owned(),
    };
    let maze = |id: &str| MazeInfo { id: id.to_owned(), grid: ["S.", ".."].map(String::from).to_vec() };
    let mut options = options();
    options.catalogue.environments = ["RoomA", "RoomB"].map(info).to_vec();
    options.catalogue.mazes = ["RoomA", "RoomB"].map(maze).to_vec();
    reports::write(results.path(), &options).unwrap();
    results
}

/// A program that a test needs; `None`, and a word about it, where it is not installed and the variable
/// `required` does not insist.
#[expect(clippy::print_stdout, reason = "says that a test was skipped")]
pub(crate) fn program(name: &str, required: &str) -> Option<PathBuf> {
    let path = std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())
        .map(|folder| folder.join(name))
        .find(|path| path.is_file());
    assert!(path.is_some() || std::env::var_os(required).is_none(), "{name} is not installed");
    if path.is_none() {
        println!("skipped: {name} is not installed");
    }
    path
}
