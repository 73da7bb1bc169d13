//! `goalbench export`: policies that act elsewhere as they do here.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "says that it was skipped")]

mod support;

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use envs::rng::{Purpose, stream};
use envs::{GoalEnv, Rows};
use goalbench::Registry;
use goalbench::run::policy::Policy;
use rand::Rng as _;
use reports::schema::RunKey;
use reports::store::layout;
use safetensors::SafeTensors;
use serde_json::{Value, json};
use support::{goalbench, refused, stderr, stdout, toy};
use tempfile::TempDir;

/// The player for readers of Python.
const PLAYER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/python/play_policy.py");
/// Observations of each environment.
const OBSERVATIONS: usize = 1000;
/// Largest difference of an action.
const TOLERANCE: f64 = 1e-6;

/// Every environment, with the folder of a short run of it. Trained once for all tests of this file.
fn runs() -> &'static [(String, PathBuf)] {
    static RUNS: OnceLock<(TempDir, Vec<(String, PathBuf)>)> = OnceLock::new();
    let (_, runs) = RUNS.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let ids: Vec<String> = envs::environments().map(|row| row.id().to_owned()).collect();
        let (names, out) = (ids.join(","), text(folder.path()));
        let output = goalbench(&[
            "run",
            "--env",
            &names,
            "--curriculum",
            "her-iid",
            "--steps",
            "200",
            "--out",
            out,
            "--set",
            "evaluation.every=200",
            "--set",
            "evaluation.episodes=1",
            "--set",
            "student.batch=64",
            "--set",
            "student.updates_per_cycle=4",
        ]);
        assert!(output.status.success(), "{}", stderr(&output));
        let place = |environment: String| {
            let names = ["her-iid", "default"].map(str::to_owned);
            let [curriculum, variant] = names;
            let key = RunKey { environment: environment.clone(), curriculum, variant, seed: 0 };
            (environment, layout::run_dir(folder.path(), &key))
        };
        let runs = ids.into_iter().map(place).collect();
        (folder, runs)
    });
    runs
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a test path is UTF-8")
}

/// States and goals of random actions, `[n, S]` and `[n, G]`.
fn observations(env: &mut dyn GoalEnv, n: usize) -> (Rows, Rows) {
    let (mut states, mut goals) = (Rows::new(env.spec().state), Rows::new(env.spec().goal));
    let mut rng = stream(3, Purpose::FinalEvaluation);
    let mut action = vec![0.0; env.spec().action];
    for index in 0..n {
        if index % env.spec().horizon == 0 {
            env.reset(&mut rng).expect("a stable start");
        }
        action.fill_with(|| rng.random_range(-1.0..=1.0));
        env.step(&action).expect("a stable step");
        states.push(&env.observation().state);
        goals.push(env.goal());
    }
    (states, goals)
}

/// What is expected of an exported policy.
struct Expected {
    folder: PathBuf,
    states: Rows,
    goals: Rows,
    actions: Rows,
}

/// Exports the policies of all runs below `folder`, each with the student's own actions.
fn exported(folder: &Path) -> Vec<Expected> {
    let registry = Registry::builtin();
    let of_run = |(environment, run): &(String, PathBuf)| {
        let out = folder.join(environment);
        let output = goalbench(&["export", text(run), "--out", text(&out)]);
        assert!(output.status.success(), "{environment}: {}", stderr(&output));
        let policy = Policy::read(&registry, run).expect("a sound run");
        let mut env = policy.environment(&registry).expect("its environment");
        let mut student = policy.student(env.spec()).expect("its student");
        let (states, goals) = observations(env.as_mut(), OBSERVATIONS);
        let actions = student.policy(&states, &goals, agents::Network::Online).expect("finite actions");
        Expected { folder: out, states, goals, actions }
    };
    runs().iter().map(of_run).collect()
}

fn assert_close(found: &[f64], expected: &[f64], place: &dyn std::fmt::Display) {
    assert_eq!(found.len(), expected.len(), "{place}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= TOLERANCE, "{place}: {found} and not {expected}");
    }
}

/// A policy as both files tell how to compute it.
struct Network {
    /// Bounds before and after, means and scales of each input.
    inputs: Vec<([f32; 2], Vec<f32>, Vec<f32>)>,
    /// Weights, biases and what follows of each layer.
    layers: Vec<(Vec<f32>, Vec<f32>, String)>,
}

impl Network {
    fn read(about: &Value, numbers: &SafeTensors<'_>) -> Self {
        let tensor = |name: &Value| -> Vec<f32> {
            let view = numbers.tensor(name.as_str().expect("a name")).expect("a tensor of this name");
            view.data().chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
        };
        let input = |input: &Value| {
            let bounds =
                ["clip_before", "clip_after"].map(|name| input[name].as_f64().expect("a bound") as f32);
            let (mean, scale) = (tensor(&input["mean"]), tensor(&input["scale"]));
            assert_eq!((&input["width"], mean.len()), (&mean.len().into(), scale.len()));
            (bounds, mean, scale)
        };
        let layer = |layer: &Value| {
            let (weight, bias) = (tensor(&layer["weight"]), tensor(&layer["bias"]));
            let inputs = layer["inputs"].as_u64().expect("a number") as usize;
            assert_eq!((&layer["outputs"], weight.len()), (&bias.len().into(), inputs * bias.len()));
            (weight, bias, layer["activation"].as_str().expect("a name").to_owned())
        };
        Self {
            inputs: about["inputs"].as_array().expect("inputs").iter().map(input).collect(),
            layers: about["layers"].as_array().expect("layers").iter().map(layer).collect(),
        }
    }

    fn act(&self, raw: [&[f64]; 2]) -> Vec<f64> {
        let mut x: Vec<f64> = Vec::new();
        for (([before, after], mean, scale), raw) in self.inputs.iter().zip(raw) {
            assert_eq!(mean.len(), raw.len());
            let scaled = raw.iter().zip(mean.iter().zip(scale)).map(|(&x, (mean, scale))| {
                f64::from((((x as f32).clamp(-before, *before) - mean) * scale).clamp(-after, *after))
            });
            x.extend(scaled);
        }
        for (weight, bias, activation) in &self.layers {
            let sum = |(row, bias): (&[f32], &f32)| {
                row.iter().zip(&x).map(|(&w, x)| f64::from(w) * x).sum::<f64>() + f64::from(*bias)
            };
            let sums = weight.chunks_exact(x.len()).zip(bias).map(sum);
            x = match activation.as_str() {
                "relu" => sums.map(|sum| sum.max(0.0)).collect(),
                "tanh" => sums.map(f64::tanh).collect(),
                other => panic!("{other}"),
            };
        }
        x
    }
}

#[test]
fn both_files_alone_give_the_actions_of_every_environment() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let all = exported(folder.path());
    assert!(all.len() >= 15, "{} environments", all.len());
    for Expected { folder, states, goals, actions } in &all {
        let about = fs::read(folder.join("policy.json")).expect("a file");
        let about: Value = serde_json::from_slice(&about).expect("JSON");
        let bytes = fs::read(folder.join("policy.safetensors")).expect("a file");
        let numbers = SafeTensors::deserialize(&bytes).expect("the safetensors format");
        let network = Network::read(&about, &numbers);
        for index in 0..OBSERVATIONS {
            let found = network.act([states.row(index), goals.row(index)]);
            assert_close(&found, actions.row(index), &folder.display());
        }
        assert_eq!(fs::read_dir(folder).expect("a folder").count(), 2, "and nothing else lies there");
    }
}

/// Prints the player's actions for each line of its input.
const ASKER: &str = r"
import json, sys
sys.path.insert(0, sys.argv[1])
import numpy
from play_policy import Policy
for line in sys.stdin:
    asked = json.loads(line)
    observation = {name: numpy.array(asked[name]) for name in ('observation', 'desired_goal')}
    print(json.dumps(Policy(asked['folder']).act(observation).tolist()))
";

/// The Python that has torch, mujoco and gymnasium-robotics, if there is one.
fn python() -> Option<PathBuf> {
    let python = std::env::var_os("GOALBENCH_POLICY_PYTHON").map(PathBuf::from);
    if python.is_none() {
        println!(
            "skipped: set GOALBENCH_POLICY_PYTHON to a Python that has torch, mujoco and gymnasium-robotics"
        );
    }
    python
}

#[test]
fn the_python_player_acts_as_the_student_does() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let all = exported(folder.path());
    let player = Path::new(PLAYER).parent().expect("a folder");
    let mut process = Command::new(&python)
        .args(["-c", ASKER])
        .arg(player)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python starts");
    let mut asked = process.stdin.take().expect("its input");
    let lines: Vec<String> = all
        .iter()
        .map(|one| {
            let rows = |rows: &Rows| rows.iter().map(<[f64]>::to_vec).collect::<Vec<_>>();
            let (observation, desired_goal) = (rows(&one.states), rows(&one.goals));
            json!({ "folder": one.folder, "observation": observation, "desired_goal": desired_goal })
                .to_string()
        })
        .collect();
    // Beside the reading, since both pipes are short.
    let writer = std::thread::spawn(move || lines.iter().try_for_each(|line| writeln!(asked, "{line}")));
    let output = process.wait_with_output().expect("Python ends");
    writer.join().expect("the writer ends").expect("Python reads");
    assert!(output.status.success());
    let answers = stdout(&output);
    assert_eq!(answers.lines().count(), all.len());
    for (line, expected) in answers.lines().zip(&all) {
        let actions: Vec<Vec<f64>> = serde_json::from_str(line).expect("actions");
        assert_eq!(actions.len(), OBSERVATIONS);
        for (found, expected_action) in actions.iter().zip(expected.actions.iter()) {
            assert_close(found, expected_action, &expected.folder.display());
        }
    }
    // A bit is not what it was.
    let altered = &all[0].folder;
    let numbers = altered.join("policy.safetensors");
    let mut bytes = fs::read(&numbers).expect("a policy");
    *bytes.last_mut().expect("numbers") ^= 1;
    fs::write(&numbers, bytes).expect("it can be written");
    let read =
        "import sys; sys.path.insert(0, sys.argv[1]); from play_policy import Policy; Policy(sys.argv[2])";
    let refused =
        Command::new(&python).args(["-c", read]).arg(player).arg(altered).output().expect("it starts");
    assert!(
        !refused.status.success() && stderr(&refused).contains("does not belong"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn the_python_player_plays_in_the_original_environments() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    for wanted in ["FetchReach", "HandReach", "HandManipulateEgg"] {
        let run = &runs().iter().find(|(environment, _)| environment == wanted).expect("a run").1;
        let out = folder.path().join(wanted);
        assert!(goalbench(&["export", text(run), "--out", text(&out)]).status.success());
        let output = Command::new(&python).args([PLAYER, text(&out), "2"]).output().expect("Python starts");
        assert!(output.status.success(), "{wanted}: {}", stderr(&output));
        let rate: f64 = stdout(&output).trim().parse().expect("a success rate");
        assert!([0.0, 0.5, 1.0].contains(&rate), "{wanted}: {rate}");
    }
}

/// The same policy reaches as many goals there as `evaluate` finds here: intervals of 99.9 % overlap.
#[test]
fn the_python_player_succeeds_as_often_as_an_evaluation_here() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (results, out) = (folder.path().join("results"), folder.path().join("policy"));
    let small = "batch=256 width=64 polyak=0.7 action_l2=0.1 updates_per_cycle=80";
    let settings: Vec<String> = small.split(' ').map(|setting| format!("student.{setting}")).collect();
    let mut train =
        vec!["run", "--env", "FetchReach", "--curriculum", "her-iid", "--seeds", "0", "--steps", "2500"];
    train.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    train.extend(["--set", "evaluation.episodes=1", "--quiet", "--out", text(&results)]);
    let works = |args: &[&str]| {
        let output = goalbench(args);
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    };
    works(&train);
    let run = results.join("runs/FetchReach/her-iid/default/seed-0");
    works(&["export", text(&run), "--out", text(&out)]);
    let here: Value = serde_json::from_str(&works(&["evaluate", text(&run), "--episodes", "100", "--json"]))
        .expect("an object on one line");
    let output = Command::new(&python).args([PLAYER, text(&out), "50"]).output().expect("Python starts");
    assert!(output.status.success(), "{}", stderr(&output));
    let there: f64 = stdout(&output).trim().parse().expect("a success rate");
    let here = here["success_rate"].as_f64().expect("a success rate");
    let interval = |rate: f64, episodes: u64| {
        let successes = (rate * episodes as f64).round() as u64;
        reports::stats::wilson_interval(successes, episodes, 0.999).expect("episodes")
    };
    let (a, b) = (interval(here, 100), interval(there, 50));
    assert!(here > 0.4, "a policy that reaches few goals tells nothing: {here}");
    assert!(a.0 <= b.1 && b.0 <= a.1, "{here} here, {there} there");
}

#[test]
fn the_description_says_what_the_run_was() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (results, out) = (folder.path().join("results"), folder.path().join("new/policy"));
    toy(&results, &["--seeds", "1", "--curriculum", "teach"]);
    let run = results.join("runs/Point/teach/default/seed-1");
    let output = goalbench(&["export", text(&run), "--out", text(&out)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let named = ["policy.safetensors", "policy.json"].map(|name| format!("{}\n", out.join(name).display()));
    assert_eq!(stdout(&output), named.concat());
    let read =
        |path: &Path| -> Value { serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON") };
    let (about, manifest) = (read(&out.join("policy.json")), read(&run.join("manifest.json")));
    assert_eq!((&about["format"], &about["run"]), (&1.into(), &manifest["run"]));
    assert_eq!((&about["config_hash"], &about["versions"]), (&manifest["hash"], &manifest["versions"]));
    assert_eq!((&about["step"], &about["steps"]), (&400.into(), &400.into()));
    let task = json!({ "id": "Point", "family": "toy", "horizon": 20, "native_ccd": false });
    assert_eq!(about["environment"], task);
    assert_eq!(about["action"], json!({ "width": 2, "low": -1.0, "high": 1.0 }));
    let widths: Vec<&Value> =
        about["layers"].as_array().expect("layers").iter().map(|one| &one["outputs"]).collect();
    assert_eq!(widths, [16, 16, 2]);
    // The same policy gives the same bytes.
    let again = folder.path().join("again");
    assert!(goalbench(&["export", text(&run), "--out", text(&again)]).status.success());
    for name in ["policy.safetensors", "policy.json"] {
        assert_eq!(fs::read(out.join(name)).expect("a file"), fs::read(again.join(name)).expect("a file"));
    }
}

#[test]
fn what_cannot_be_exported_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results");
    toy(&results, &["--seeds", "0", "--curriculum", "teach"]);
    let run = results.join("runs/Point/teach/default/seed-0");
    let place = |name: &str| folder.path().join(name);
    fs::write(place("file"), "kept").expect("it can be written");
    std::os::unix::fs::symlink("nowhere", place("link")).expect("a link");
    let export = |run: &Path, out: &Path, expected: &[&str]| {
        refused(&["export", text(run), "--out", text(out)], expected);
    };
    export(&run, &results, &["--out", "exists already"]);
    for inside in ["runs/policy", "runs/Point/teach/default/seed-9", "runs/Point/teach/default/seed-0/policy"]
    {
        export(&run, &results.join(inside), &["--out", "only read"]);
        assert!(!results.join(inside).exists());
    }
    export(&run, &place("link"), &["--out", "exists already"]);
    export(&run, &place("file/policy"), &["--out", "is no folder"]);
    export(Path::new("/nowhere"), &place("policy"), &["/nowhere"]);
    export(&results, &place("policy"), &["is no folder of a run"]);
    let checkpoint = run.join("checkpoint.bin");
    let whole = fs::read(&checkpoint).expect("a checkpoint");
    fs::write(&checkpoint, &whole[..whole.len() - 7]).expect("it can be written");
    export(&run, &place("policy"), &["checkpoint.bin", "checksum"]);
    fs::remove_file(&checkpoint).expect("it can be removed");
    export(&run, &place("policy"), &["checkpoint.bin", "is missing"]);
    let mut left: Vec<_> = fs::read_dir(folder.path())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    left.sort();
    assert_eq!(left, ["file", "link", "results"]);
}
