//! `harness/python/convert_report.py`: the data of a report in the formats of other tools.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "says that it was skipped")]

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};
use support::{goalbench, stderr, toy_args};
use tempfile::TempDir;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/python/convert_report.py");

/// A report on two seeds in one environment, of which another one has the first alone.
fn reported() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let train = |environment: &str, seeds: &str| {
        let args = toy_args(folder.path(), &["--seeds", seeds]);
        let args: Vec<&str> =
            args.into_iter().map(|arg| if arg == "Point" { environment } else { arg }).collect();
        let output = goalbench(&args);
        assert!(output.status.success(), "{}", stderr(&output));
    };
    train("Point", "0,1");
    train("MazeA", "0");
    let output = goalbench(&["report", folder.path().to_str().expect("a test path is UTF-8"), "-q"]);
    assert!(output.status.success(), "{}", stderr(&output));
    folder
}

fn convert(python: &Path, tool: &str, folder: &Path, out: &str) -> Output {
    Command::new(python)
        .args([SCRIPT, tool, "report", out])
        .current_dir(folder)
        .env("MLFLOW_ALLOW_FILE_STORE", "true")
        .env("WANDB_SILENT", "true")
        .output()
        .expect("Python starts")
}

/// The rows of a table of the report, by name of column.
fn rows(folder: &Path, name: &str) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(folder.join("report").join(name)).expect("a table of the report");
    // No field before `versions`, the last one, has a comma.
    let fields = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let mut lines = text.lines();
    let columns = fields(lines.next().expect("a head"));
    lines.map(|line| columns.iter().cloned().zip(fields(line)).collect()).collect()
}

#[test]
fn scores_and_curves_are_those_of_the_report() {
    let folder = reported();
    let python = Path::new("python3");
    let converted = |tool: &str| {
        let output = convert(python, tool, folder.path(), tool);
        assert!(output.status.success(), "{}", stderr(&output));
        let text = fs::read(folder.path().join(format!("{tool}.json"))).expect("it was written");
        (serde_json::from_slice::<Value>(&text).expect("JSON"), stderr(&output))
    };
    let (scores, said) = converted("rliable");
    assert_eq!((&scores["tasks"], &scores["seeds"]["teach"]), (&json!(["MazeA", "Point"]), &json!([0])));
    assert!(said.contains("left out: seed 1 of teach, which lacks ['MazeA']"), "{said}");
    for row in rows(folder.path(), "runs.csv").iter().filter(|row| row["seed"] == "0") {
        let column = usize::from(row["environment"] == "Point");
        for score in ["auc", "final_success"] {
            let expected: f64 = row[score].parse().expect("a finished run has scores");
            assert_eq!(scores[score][&row["curriculum"]][0][column], expected, "{row:?}");
        }
    }

    let (curves, said) = converted("marl-eval");
    assert_eq!(said, "", "every run has a curve");
    let curves: Vec<&Value> = curves.as_object().expect("environments").values().collect();
    for row in rows(folder.path(), "records.csv") {
        let (seed, step) = (format!("seed_{}", row["seed"]), format!("step_{}", row["eval_index"]));
        let of_task = curves.iter().find_map(|set| set.get(&row["environment"])).expect("its environment");
        let point = &of_task[&row["curriculum"]][&seed][&step];
        assert_eq!(point["step_count"], row["step"].parse::<u64>().expect("a step"), "{row:?}");
        assert_eq!(point["success_rate"], json!([row["success_rate"].parse::<f64>().expect("a rate")]));
    }
}

#[test]
fn runs_that_have_not_finished_are_named_and_an_unknown_tool_is_refused() {
    let folder = reported();
    let path = folder.path().join("report/runs.csv");
    let table = fs::read_to_string(&path).expect("a table");
    fs::write(&path, table.replacen(",finished,", ",failed,", 1)).expect("it can be written");
    let output = convert(Path::new("python3"), "marl-eval", folder.path(), "curves");
    let said = stderr(&output);
    assert!(said.contains("left out: MazeA/") && said.contains("/0, which is failed"), "{said}");
    let output = convert(Path::new("python3"), "excel", folder.path(), "table");
    assert!(
        !output.status.success()
            && stderr(&output).contains("rliable")
            && !folder.path().join("table").exists()
    );
}

#[test]
fn trackers_take_every_evaluation() {
    let Some(python) = std::env::var_os("GOALBENCH_TRACKERS_PYTHON") else {
        println!("skipped: set GOALBENCH_TRACKERS_PYTHON to a Python that has mlflow and wandb");
        return;
    };
    let folder = reported();
    for (tool, out) in [("mlflow", "mlruns"), ("wandb", "offline")] {
        let output = convert(Path::new(&python), tool, folder.path(), out);
        assert!(output.status.success(), "{tool}: {}", stderr(&output));
    }
    let entries = |folder: &Path| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).collect::<Vec<_>>()
    };
    let runs = rows(folder.path(), "runs.csv").len();
    let started = |path: &&std::path::PathBuf| path.display().to_string().contains("offline-run-");
    assert_eq!(entries(&folder.path().join("offline/wandb")).iter().filter(started).count(), runs);
    let mut found: Vec<String> = entries(&folder.path().join("mlruns"))
        .iter()
        .flat_map(|experiment| entries(experiment))
        .filter_map(|run| fs::read_to_string(run.join("metrics/success_rate")).ok())
        .flat_map(|text| text.lines().map(str::to_owned).collect::<Vec<_>>())
        .collect();
    // A line is the time, the value and the step.
    let expected = rows(folder.path(), "records.csv");
    let mut expected: Vec<String> =
        expected.iter().map(|row| format!("0 {} {}", row["success_rate"], row["step"])).collect();
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
}
