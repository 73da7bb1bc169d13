//! `goalbench profile`: what is measured adds up, and wrong input is refused.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use serde_json::Value;
use support::{goalbench, stderr, stdout};

const TOY: &[&str] = &[
    "profile",
    "--env",
    "Point",
    "--curriculum",
    "teach",
    "--cycles",
    "3",
    "--set",
    "student.batch=32",
    "--set",
    "student.width=16",
    "--set",
    "student.updates_per_cycle=5",
    "--set",
    "pool.size=20",
];

fn json(more: &[&str]) -> Value {
    let output = goalbench(&[TOY, more, &["--json"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn parts_add_up_to_the_speed_of_a_whole_run() {
    let profile = json(&["--set", "evaluation.every=200", "--set", "evaluation.episodes=25"]);
    let size = &profile["measured"];
    // 3 cycles of 2 episodes of 20 steps, 5 gradient steps each.
    assert_eq!((size["cycles"].as_u64(), size["steps"].as_u64()), (Some(3), Some(120)));
    assert_eq!((size["updates"].as_u64(), size["evaluation_every"].as_u64()), (Some(15), Some(200)));
    let parts = profile["seconds_per_step"].as_object().expect("a table");
    assert_eq!(parts.len(), 11);
    for (name, seconds) in parts {
        // The rest of the updates comes by subtraction, so that it may be anything where networks are tiny.
        assert!(name == "beside_products" || seconds.as_f64() > Some(0.0), "{name}: {seconds}");
    }
    let total: f64 = parts.values().filter_map(Value::as_f64).sum();
    let number = |key: &str| profile[key].as_f64().expect(key);
    assert!((number("steps_per_second") * total - 1.0).abs() < 1e-9, "{profile}");
    let floor = parts["physics"].as_f64().expect("seconds") + parts["products"].as_f64().expect("seconds");
    assert!((number("limit_steps_per_second") * floor - 1.0).abs() < 1e-9, "{profile}");
    assert!((number("share_of_limit") - floor / total).abs() < 1e-9, "{profile}");
    let shares: f64 =
        profile["shares"].as_object().expect("a table").values().filter_map(Value::as_f64).sum();
    assert!((shares - 1.0).abs() < 1e-9, "{profile}");
}

#[test]
fn the_table_is_for_people() {
    let output = goalbench(TOY);
    let text = stdout(&output);
    assert!(output.status.success(), "{}", stderr(&output));
    for part in ["physics", "acting", "products", "sampling", "teacher", "evaluation", "checkpoint"] {
        assert!(text.lines().any(|line| line.starts_with(part)), "{part} in\n{text}");
    }
}

#[test]
fn runs_beside_each_other_are_compared_with_one_alone() {
    let found = json(&["--beside", "2", "--rounds", "1"]);
    for key in ["alone_steps_per_second", "together_steps_per_second"] {
        let rates: Vec<f64> = found[key].as_array().expect(key).iter().filter_map(Value::as_f64).collect();
        assert!(rates.len() == 1 && rates.iter().all(|rate| *rate > 0.0), "{found}");
    }
    assert!(found["gain"].as_f64() > Some(0.0), "{found}");
}

#[test]
fn a_cohort_is_compared_with_a_run_alone() {
    let found = json(&["--lanes", "3", "--rounds", "2"]);
    assert_eq!((found["lanes"].as_u64(), found["cycles"].as_u64()), (Some(3), Some(3)));
    for side in ["alone", "lockstep"] {
        let parts = found[side]["clock_seconds_per_step"].as_object().expect("a table");
        assert_eq!(parts.len(), 7);
        for (name, seconds) in parts {
            // What is left may be anything where networks are tiny.
            assert!(name == "rest" || seconds.as_f64() > Some(0.0), "{side}, {name}: {seconds}");
        }
        let shares = found[side]["shares"].as_object().expect("a table");
        let sum: f64 = shares.values().filter_map(Value::as_f64).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{found}");
        let speeds = found[side]["steps_per_second"].as_array().expect("a list");
        assert!(speeds.len() == 2 && speeds.iter().all(|speed| speed.as_f64() > Some(0.0)), "{found}");
    }
    assert!(found["gain"].as_f64() > Some(0.0), "{found}");
    let text = stdout(&goalbench(&[TOY, &["--lanes", "2", "--rounds", "1"]].concat()));
    for part in ["physics", "drawing", "learning", "teachers", "evaluating", "2 runs in lockstep are"] {
        assert!(text.lines().any(|line| line.starts_with(part)), "{part} in\n{text}");
    }
}

#[test]
fn wrong_input_is_refused_with_what_is_accepted() {
    for (more, expected) in [
        (["--env", "point"], "--env: unknown environment `point`; did you mean `Point`?"),
        (["--curriculum", "tech"], "--curriculum: unknown curriculum `tech`; did you mean `teach`?"),
        (["--set", "budget.steps=9"], "--cycles says how long"),
        (["--set", "student.bach=9"], "did you mean `batch`?"),
        (["--cycles", "0"], "--cycles"),
        (["--beside", "1"], "--beside"),
        (["--rounds", "2"], "--beside"),
        (["--lanes", "0"], "a whole number from 2 to 1000"),
        (["--lanes", "auto"], "a whole number from 2 to 1000"),
        (["--env", "Point,MazeA"], "--env: `Point,MazeA` names several"),
        (["--curriculum", "teach,vds"], "--curriculum: `teach,vds` names several"),
    ] {
        let output = goalbench(&[TOY, &more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(stderr(&output).contains(expected), "{more:?}: {}", stderr(&output));
    }
    let both = goalbench(&[TOY, &["--lanes", "2", "--beside", "2"]].concat());
    assert!(both.status.code() == Some(2) && stderr(&both).contains("--beside"), "{}", stderr(&both));
}
