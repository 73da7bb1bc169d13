//! Measures of the frontier: true, and without a trace in anything else that a run records.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::Path;
use std::time::Duration;

use agents::{Agent, Mode};
use envs::rng::{Purpose, Rng, stream};
use envs::{GoalEnv, draw_pool};
use goalbench::Registry;
use goalbench::run::policy::Policy;
use reports::schema::{Frontier, Manifest};
use reports::store::{RunFolder, layout};
use support::children::{files, kill_again_and_again};
use support::{refused, stderr, toy, toy_args};

/// Long enough to be killed in. A teacher with weights, one whose rollouts lie between evaluations and one
/// that knows no pool.
const LONGER: [&str; 14] = [
    "--curriculum",
    "teach,sfl,her-iid",
    "--set",
    "curriculum.sfl.interval=10",
    "--set",
    "curriculum.sfl.candidates=10",
    "--set",
    "curriculum.sfl.kept=3",
    "--steps",
    "2000",
    "--set",
    "evaluation.every=200",
    "--seeds",
    "0",
];

const MEASURED: [&str; 4] = ["--set", "frontier.every=3", "--set", "frontier.episodes=2"];

fn longer(more: &[&'static str]) -> Vec<&'static str> {
    LONGER.iter().chain(more).copied().collect()
}

const OTHERS: [&str; 4] = [layout::RECORDS, layout::TEACHING, layout::STUDENT, layout::OUTCOME];
const ALL: [&str; 5] =
    [layout::RECORDS, layout::TEACHING, layout::STUDENT, layout::FRONTIER, layout::OUTCOME];

fn run_of(folder: &Path, curriculum: &str) -> RunFolder {
    RunFolder::new(folder.join(format!("runs/Point/{curriculum}/default/seed-0")))
}

fn measures(folder: &Path, curriculum: &str) -> Vec<Frontier> {
    run_of(folder, curriculum).frontier().expect("sound measures")
}

#[test]
fn measures_change_nothing_else_and_come_out_the_same_killed_or_in_lanes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name);
    toy(&place("plain"), &longer(&[]));
    toy(&place("measured"), &longer(&MEASURED));
    assert_eq!(files(&place("measured"), &OTHERS), files(&place("plain"), &OTHERS));
    for curriculum in ["teach", "sfl", "her-iid"] {
        assert!(!run_of(&place("plain"), curriculum).has(layout::FRONTIER).expect("it can be asked"));
    }

    // The untrained student, every third evaluation and the last.
    let teach = measures(&place("measured"), "teach");
    let indices: Vec<u64> = teach.iter().map(|measure| measure.eval_index).collect();
    assert_eq!(indices, [0, 3, 6, 9, 10]);
    for curriculum in ["teach", "sfl", "her-iid"] {
        for measure in measures(&place("measured"), curriculum) {
            assert_eq!((measure.episodes, measure.successes.len()), (2, 20));
            assert_eq!(measure.goals.is_some(), measure.eval_index == 0);
            assert_eq!(measure.weights.is_some(), curriculum == "teach");
        }
    }
    // TEACH has asked nobody before the first episode; after that it tells of every goal.
    for measure in &teach {
        let beliefs =
            measure.beliefs.as_ref().map(|beliefs| (beliefs.success.as_ref(), beliefs.scores.as_ref()));
        let told = beliefs.map(|(success, scores)| (success.map(Vec::len), scores.map(Vec::len)));
        assert_eq!(told, (measure.eval_index > 0).then_some((Some(20), Some(20))));
    }
    for curriculum in ["sfl", "her-iid"] {
        assert!(measures(&place("measured"), curriculum).iter().all(|measure| measure.beliefs.is_none()));
    }
    // All teachers of a seed have the same pool and begin with the same student.
    let iid = measures(&place("measured"), "her-iid");
    assert_eq!((&teach[0].goals, &teach[0].successes), (&iid[0].goals, &iid[0].successes));
    let recorded = run_of(&place("measured"), "teach").teaching().expect("what the teacher did");
    assert_eq!(teach.last().expect("measures").weights, recorded.last().expect("evaluations").weights);

    let expected = files(&place("measured"), &ALL);
    toy(&place("lanes"), &longer(&[&MEASURED[..], &["--lanes", "3", "--jobs", "1"]].concat()));
    assert_eq!(files(&place("lanes"), &ALL), expected, "as lanes of a cohort");

    let killed = place("killed");
    let args = longer(&MEASURED);
    let run = run_of(&killed, "teach");
    let names = [layout::RECORDS, layout::FRONTIER];
    kill_again_and_again(&toy_args(&killed, &args), (&run, &names), 6, Duration::from_millis(17));
    toy(&killed, &longer(&MEASURED));
    assert_eq!(files(&killed, &ALL), expected, "killed and gone on with");
}

/// Plays `episodes` greedy episodes to `goal`, one after the other, an action at a time.
fn count(env: &mut dyn GoalEnv, student: &mut dyn Agent, goal: &[f64], episodes: u64, rng: &mut Rng) -> u64 {
    let mut action = vec![0.0; env.spec().action];
    let mut successes = 0;
    for _ in 0..episodes {
        env.reset(rng).expect("a stable start");
        env.set_goal(goal).expect("a goal of the pool");
        for _ in 0..env.spec().horizon {
            student.act(env.observation(), env.goal(), Mode::Greedy, &mut action).expect("finite actions");
            env.step(&action).expect("a stable step");
        }
        successes += u64::from(env.success(&env.observation().achieved, env.goal()));
    }
    successes
}

#[test]
fn the_last_measure_is_what_an_independent_count_finds() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let sizes = [
        "--env",
        "MazeA",
        "--curriculum",
        "teach",
        "--seeds",
        "0",
        "--steps",
        "6000",
        "--set",
        "evaluation.every=1500",
        "--set",
        "pool.size=150",
        "--set",
        "student.batch=64",
        "--set",
        "student.width=32",
        "--set",
        "student.updates_per_cycle=40",
    ];
    toy(
        folder.path(),
        &[&sizes[..], &["--set", "frontier.every=1", "--set", "frontier.episodes=3"]].concat(),
    );
    let run = RunFolder::new(folder.path().join("runs/MazeA/teach/default/seed-0"));
    let measures = run.frontier().expect("sound measures");
    let last = measures.last().expect("measures");
    let records = run.records().expect("sound records");
    assert_eq!(Some(last.eval_index), records.last().map(|record| record.eval_index));

    let registry = Registry::builtin();
    let policy = Policy::read(&registry, run.path()).expect("the run saved its policy");
    let mut env = policy.environment(&registry).expect("a maze");
    let mut student = policy.student(env.spec()).expect("the trained student");
    let pool = draw_pool(env.as_mut(), 150, &mut stream(0, Purpose::Pool)).expect("a pool");
    let mut rng = stream(0, Purpose::Frontier(last.eval_index));
    let counted: Vec<u64> =
        pool.iter().map(|goal| count(env.as_mut(), student.as_mut(), goal, 3, &mut rng)).collect();
    assert_eq!(last.successes, counted);
    assert!(counted.iter().any(|&n| n > 0) && counted.contains(&0), "all kinds of goals: {counted:?}");
    let narrow = |goal: &[f64]| goal.iter().map(|&x| x as f32).collect::<Vec<f32>>();
    assert_eq!(measures[0].goals, Some(pool.iter().map(narrow).collect()));
}

#[test]
fn runs_without_measures_keep_their_hashes_and_wrong_options_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    toy(&out, &["--curriculum", "her-iid", "--seeds", "0", "--steps", "100"]);
    let manifest =
        |out: &Path| -> Manifest { run_of(out, "her-iid").manifest().expect("sound").expect("a manifest") };
    assert_eq!(manifest(&out).config.get("frontier"), None);
    let measured = folder.path().join("measured");
    let settings = ["--curriculum", "her-iid", "--seeds", "0", "--steps", "100", "--set", "frontier.every=1"];
    toy(&measured, &settings);
    let config = &manifest(&measured).config;
    assert_eq!(config["frontier"], serde_json::json!({ "every": 1, "episodes": 5 }));
    // A run that measures is another run than one that does not.
    refused(&toy_args(&out, &settings), &["frontier"]);
    for (set, expected) in [
        ("frontier.episodes=0", ["frontier.episodes", "1 to 1000000"]),
        ("frontier.every=-1", ["frontier.every", "at least 0"]),
        ("frontier=3", ["frontier", "every"]),
    ] {
        let wrong = folder.path().join("wrong");
        refused(&toy_args(&wrong, &["--set", set]), &expected);
    }
}

#[test]
fn measures_of_a_finished_run_that_were_altered_or_lost_are_noticed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let settings = ["--curriculum", "teach", "--seeds", "0", "--steps", "100", "--set", "frontier.every=1"];
    toy(folder.path(), &settings);
    let path = run_of(folder.path(), "teach").file(layout::FRONTIER);
    let good = fs::read_to_string(&path).expect("measures");
    for bad in [Some(good.replacen("\"episodes\":5", "\"episodes\":6", 1)), None] {
        match bad {
            Some(bad) => fs::write(&path, bad).expect("it can be written"),
            None => fs::remove_file(&path).expect("it can be removed"),
        }
        let output = support::goalbench(&["report", folder.path().to_str().expect("UTF-8")]);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains(layout::FRONTIER), "{}", stderr(&output));
    }
}
