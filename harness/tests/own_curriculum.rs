//! The example program: all of goalbench with a curriculum from outside.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use reports::record::{Record, Teaching};
use serde::de::DeserializeOwned;

/// Cargo builds examples with the tests, into a folder beside theirs.
fn program() -> PathBuf {
    let test = std::env::current_exe().expect("a test has a path");
    let profile = test.parent().and_then(|deps| deps.parent()).expect("tests lie in PROFILE/deps");
    profile.join("examples").join("own_curriculum")
}

fn run(args: &[&str]) -> Output {
    Command::new(program())
        .args(args)
        .output()
        .expect("`cargo test` builds examples; with --test alone, `cargo build --release --examples` first")
}

/// The toy task in 40 episodes with two evaluations on the way, into `out`.
fn toy(out: &Path, more: &[&str]) -> Output {
    let mut args = vec!["run", "--env", "Point", "--curriculum", "nearest", "--steps", "800", "--out"];
    args.push(out.to_str().expect("a test path is UTF-8"));
    for set in ["evaluation.every=400", "student.batch=64", "student.width=32", "pool.size=50"] {
        args.extend(["--set", set]);
    }
    more.iter().for_each(|set| args.extend(["--set", set]));
    run(&args)
}

/// The lines of a file of the run in `out`.
fn lines<T: DeserializeOwned>(out: &Path, file: &str) -> Vec<T> {
    let path = out.join("runs/Point/nearest/default/seed-0").join(file);
    let text = std::fs::read_to_string(path).expect("the run recorded");
    text.lines().map(|line| serde_json::from_str(line).expect("a line of this kind")).collect()
}

#[test]
fn it_is_listed_configured_run_and_recorded_like_a_built_in_one() {
    let listed = run(&["list", "curricula"]);
    assert!(String::from_utf8_lossy(&listed.stdout).contains("Nearest first"));

    let folder = tempfile::tempdir().expect("a temporary folder");
    let own = ["curriculum.nearest.threshold=0.0", "curriculum.nearest.episodes=10"];
    let done = toy(folder.path(), &own);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    // With threshold 0 the share grows by 0.05 every 10 of the 40 episodes. The last of them was drawn before it grew
    // for the fourth time: from a quarter of the 50 goals, rounded down.
    let records: Vec<Record> = lines(folder.path(), "records.jsonl");
    let last = &records.last().expect("evaluations").teacher;
    assert!((last["share"].as_f64().expect("a number") - 0.3).abs() < 1e-12, "{last:?}");
    assert!((last["effective_goals"].as_f64().expect("a number") - 12.0).abs() < 1e-9, "{last:?}");
    let teaching: Vec<Teaching> = lines(folder.path(), "teaching.jsonl");
    let weights = teaching.last().and_then(|line| line.weights.as_ref()).expect("a teacher of the pool");
    assert_eq!((weights.len(), weights.iter().filter(|&&p| p > 0.0).count()), (50, 12));
}

#[test]
fn its_circle_stays_small_while_the_student_fails() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Of 30 episodes with exploration noise not all succeed.
    let done = toy(folder.path(), &["curriculum.nearest.threshold=1.0", "curriculum.nearest.episodes=30"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let records: Vec<Record> = lines(folder.path(), "records.jsonl");
    assert!(records.iter().all(|record| record.teacher["share"] == 0.1), "{records:?}");
}

#[test]
fn a_value_out_of_its_range_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused = toy(folder.path(), &["curriculum.nearest.share=0"]);
    assert_eq!(refused.status.code(), Some(2));
    let message = String::from_utf8_lossy(&refused.stderr);
    assert!(message.contains("curriculum.nearest.share") && message.contains("(0, 1]"), "{message}");
}

/// So that the page stays true when the example changes.
#[test]
fn the_page_that_walks_through_it_quotes_it() {
    let (page, example) =
        (include_str!("../docs/curricula.md"), include_str!("../examples/own_curriculum.rs"));
    let (_, rest) = page.split_once("### The example, step by step").expect("the walk");
    let (walk, _) = rest.split_once("\n### ").expect("the next section");
    let quoted: Vec<&str> = walk
        .split("```rust\n")
        .skip(1)
        .flat_map(|rest| rest.split("```").next().unwrap_or_default().lines())
        .map(str::trim)
        .collect();
    assert!(quoted.len() > 15, "{quoted:?}");
    for line in quoted {
        assert!(example.contains(line), "the example has no line `{line}`");
    }
}
