//! The regression gate from the command line.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::LazyLock;

use reports::store::layout;
use serde_json::Value;
use support::{goalbench, seal, stderr, stdout};

/// A protocol of six runs of a fraction of a second.
const PROTOCOL: &str = r#"
name = "toy"
environments = ["Point"]
curricula = ["her-iid"]
seeds = "0..6"
budget = { steps = 200 }
evaluation = { every = 100, episodes = 5 }
student = { batch = 16, width = 8, updates_per_cycle = 2 }
"#;

/// A folder with the protocol, its runs, and a baseline that checks compare three seeds with.
struct Home(tempfile::TempDir);

/// The files of such a folder, which every test changes in its own way.
static RECORDED: LazyLock<Vec<(PathBuf, Vec<u8>)>> = LazyLock::new(|| {
    let home = Home(tempfile::tempdir().expect("a temporary folder"));
    fs::write(home.path("protocol.toml"), PROTOCOL).expect("the protocol can be written");
    let output = home.run(
        "record --protocol P --seeds 0..6 --check-seeds 0..3 --alpha 0.05 --window 1 --keep R --out B --jobs 2",
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let mut files = Vec::new();
    read_all(home.0.path(), Path::new(""), &mut files);
    files
});

/// The files in the folder `below` of `root`, by their paths in `root`.
fn read_all(root: &Path, below: &Path, files: &mut Vec<(PathBuf, Vec<u8>)>) {
    for entry in fs::read_dir(root.join(below)).expect("a folder") {
        let path = below.join(entry.expect("an entry").file_name());
        if root.join(&path).is_dir() {
            read_all(root, &path, files);
        } else {
            files.push((path.clone(), fs::read(root.join(&path)).expect("a file")));
        }
    }
}

impl Home {
    fn new() -> Self {
        let home = Self(tempfile::tempdir().expect("a temporary folder"));
        for (path, bytes) in RECORDED.iter() {
            let path = home.0.path().join(path);
            fs::create_dir_all(path.parent().expect("a file lies in a folder")).expect("a folder");
            fs::write(path, bytes).expect("a file");
        }
        home
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs `goalbench regress` with `words`, of which single capitals stand for files.
    fn run(&self, words: &str) -> Output {
        let word = |word: &str| match word {
            "P" => self.path("protocol.toml").display().to_string(),
            "R" => self.path("runs").display().to_string(),
            "B" => self.path("baseline.json").display().to_string(),
            "O" => self.path("out").display().to_string(),
            other => other.to_owned(),
        };
        let words: Vec<String> = words.split(' ').map(word).collect();
        let arguments: Vec<&str> =
            std::iter::once("regress").chain(words.iter().map(String::as_str)).collect();
        goalbench(&arguments)
    }

    /// Changes the baseline's JSON.
    fn edit(&self, change: impl FnOnce(&mut Value)) {
        let path = self.path("baseline.json");
        let mut value: Value =
            serde_json::from_str(&fs::read_to_string(&path).expect("recorded")).expect("JSON");
        change(&mut value);
        fs::write(&path, value.to_string()).expect("the baseline can be written");
    }
}

/// Makes every episode after the untrained evaluation a success, as if the baseline's student had learned
/// all.
fn perfect(baseline: &mut Value) {
    let curves = &mut baseline["cells"]["Point/her-iid/default"]["curves"];
    for curve in curves.as_object_mut().expect("curves by seed").values_mut() {
        for count in curve["successes"].as_array_mut().expect("a number per evaluation").iter_mut().skip(1) {
            *count = 5.into();
        }
        curve["records"] = "of another student".into();
    }
}

#[test]
fn unchanged_code_is_identical_on_the_same_machine() {
    let home = Home::new();
    let output = home.run("check --baseline B --exact --out O --jobs 2");
    assert_eq!(output.status.code(), Some(0), "{}{}", stdout(&output), stderr(&output));
    assert!(
        stdout(&output).contains("all 3 runs are identical to the baseline's, byte for byte"),
        "{}",
        stdout(&output)
    );
    let junit = fs::read_to_string(home.path("out/junit.xml")).expect("written");
    assert!(
        junit.contains("failures=\"0\"") && junit.contains("classname=\"Point/her-iid/default\""),
        "{junit}"
    );
    for name in ["summary.md", "regression.json", "regression.svg", "regression.png"] {
        assert!(home.path("out").join(name).is_file(), "{name}");
    }
}

#[test]
fn a_fall_ends_with_code_one_and_says_what_fell_by_how_much() {
    let home = Home::new();
    home.edit(perfect);
    let output = home.run("check --baseline B --results R --out O");
    assert_eq!(output.status.code(), Some(1), "{}{}", stdout(&output), stderr(&output));
    let text = stdout(&output);
    assert!(text.contains("FAILED: 2 of 2 tests failed; 0 of 3 runs"), "{text}");
    assert!(text.contains("final success") && text.contains("1.000"), "{text}");
    let junit = fs::read_to_string(home.path("out/junit.xml")).expect("written");
    assert!(junit.contains("failures=\"2\"") && junit.contains("<failure message=\"1.000 before"), "{junit}");
    let summary = fs::read_to_string(home.path("out/summary.md")).expect("written");
    assert!(
        summary.contains("What fell:") && summary.contains("exact one-sided permutation test"),
        "{summary}"
    );
    let json = home.run("check --baseline B --results R --json");
    let json: Value = serde_json::from_str(&stdout(&json)).expect("JSON");
    assert_eq!((&json["passed"], &json["tests"][0]["failed"]), (&false.into(), &true.into()), "{json:#}");
}

#[test]
fn a_difference_that_is_no_fall_fails_only_where_exactness_is_asked_for() {
    let home = Home::new();
    home.edit(|baseline| {
        baseline["cells"]["Point/her-iid/default"]["curves"]["1"]["records"] = "other bytes".into();
    });
    assert_eq!(home.run("check --baseline B --results R").status.code(), Some(0));
    let exact = home.run("check --baseline B --results R --exact");
    assert_eq!(exact.status.code(), Some(1));
    assert!(
        stdout(&exact).contains("cells with runs that differ: Point/her-iid/default"),
        "{}",
        stdout(&exact)
    );
}

#[test]
fn a_run_that_broke_down_fails_the_check() {
    let home = Home::new();
    let run = home.path("runs/runs/Point/her-iid/default/seed-1");
    let outcome = r#"{"status":"failed","step":200,"reason":"the critic's loss is not finite"}"#;
    fs::write(run.join(layout::OUTCOME), outcome).expect("written");
    seal(&run);
    let output = home.run("check --baseline B --results R");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stdout(&output).contains("seed-1: failed at step 200: the critic's loss"), "{}", stdout(&output));
    let record = home.run("record --protocol P --results R --out O");
    assert_eq!(record.status.code(), Some(2));
    assert!(stderr(&record).contains("a baseline needs runs that come to their end"), "{}", stderr(&record));
}

#[test]
fn baselines_of_another_config_or_schema_are_refused_with_how_to_renew_them() {
    let home = Home::new();
    home.edit(|baseline| baseline["protocol"]["student"]["batch"] = 32.into());
    let refused = |what: &[&str]| {
        let output = home.run("check --baseline B");
        assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
        let message = stderr(&output);
        for part in what.iter().chain(&["renew it with `goalbench regress record --protocol"]) {
            assert!(message.contains(part), "{part}: {message}");
        }
    };
    refused(&["Point/her-iid/default: student.batch: 16 there, 32 now", "protocol.toml"]);
    home.edit(|baseline| baseline["config"]["student.batch"] = 32.into());
    refused(&["its hash does not fit its config"]);
    home.edit(|baseline| baseline["schema"] = 2.into());
    refused(&["has schema 2, this program reads 1"]);
    fs::write(home.path("baseline.json"), "{}").expect("written");
    refused(&["is no baseline"]);
}

#[test]
fn wrong_options_are_refused_before_anything_is_run() {
    let home = Home::new();
    let refused = |words: &str, part: &str| {
        let output = home.run(words);
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(stderr(&output).contains(part), "{words}: {}", stderr(&output));
    };
    refused("check --baseline B --seeds 0", "no fall can be significant");
    refused("check --baseline B --env MazeA", "the baseline has no MazeA; it has Point");
    refused("check --baseline B --alpha 1.5", "--alpha");
    refused("check --baseline B --smallest-effect=2", "--smallest-effect");
    refused("check --baseline B --keep R", "exists already");
    refused("check --baseline B --results R --seeds 3..9", "has not ended");
    refused("check --baseline B --set student.batsh=16", "student.batsh");
    refused("check --baseline B --set budget.steps=400", "stay the baseline's");
    refused("check --baseline B --set student.batch=8 --exact", "cannot be used with");
    refused("false-alarms --baseline B --now 3 --before 4", "the baseline has 6");
}

/// A student that learns nothing any more falls from a perfect baseline; the baseline's own config is what it
/// was.
#[test]
fn a_changed_setting_is_compared_with_the_baseline_that_did_without() {
    let home = Home::new();
    home.edit(perfect);
    let output = home.run("check --baseline B --set student.actor_lr=1e-9 --keep O --jobs 2");
    assert_eq!(output.status.code(), Some(1), "{}{}", stdout(&output), stderr(&output));
    let text = stdout(&output);
    assert!(text.contains("the baseline was recorded without --set student.actor_lr=1e-9"), "{text}");
    let manifest = home.path("out/runs/Point/her-iid/default/seed-0").join(layout::MANIFEST);
    let manifest = fs::read_to_string(manifest).expect("a run was kept");
    assert!(manifest.contains("\"actor_lr\": 1e-9") || manifest.contains("\"actor_lr\":1e-9"), "{manifest}");
}

#[test]
fn false_alarms_are_counted_the_same_way_every_time() {
    let home = Home::new();
    let count = || home.run("false-alarms --baseline B --now 3 --before 3 --draws 200 --alpha 0.2");
    let first = count();
    assert_eq!(first.status.code(), Some(0), "{}{}", stdout(&first), stderr(&first));
    assert!(
        stdout(&first).contains("of 200 checks of 3 seeds against 3 others failed"),
        "{}",
        stdout(&first)
    );
    assert_eq!(stdout(&first), stdout(&count()));
}

#[test]
fn the_committed_baselines_are_taken_by_this_program_and_hold_every_curriculum() {
    let registry = goalbench::Registry::builtin();
    let mut checked = Vec::new();
    for (name, environments) in
        [("gate", &["MazeA", "MazeB", "MazeC", "FetchReach"][..]), ("gate-methods", &["MazeA", "FetchReach"])]
    {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("baselines/{name}.json"));
        let baseline = reports::gate::Baseline::read(&path).expect("a baseline");
        let protocol = goalbench::regress::protocol(&baseline, &path, &registry).expect("a protocol");
        let plan = goalbench::protocol::plan::Plan::new(&protocol, &registry).expect("a plan");
        let cells = baseline.cells_of(&goalbench::regress::expected(&plan), &path).expect("the same config");
        assert_eq!(cells.len(), environments.len() * protocol.curricula.len());
        for environment in environments {
            assert!(cells.iter().any(|cell| cell.environment == *environment), "{name}: {environment}");
        }
        checked.extend(protocol.curricula);
        // The protocol beside it is the one that was recorded.
        let text = std::fs::read_to_string(path.with_extension("toml")).expect("a protocol");
        let written: toml::Table = text.parse().expect("TOML");
        assert_eq!(serde_json::to_value(written).expect("plain data"), baseline.protocol);
    }
    for curriculum in registry.curricula().iter().filter(|entry| entry.needs.is_none()) {
        assert!(checked.iter().any(|id| id == curriculum.id), "{}", curriculum.id);
    }
}
