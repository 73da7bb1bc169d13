//! The example program: all of goalbench with a curriculum from outside.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use envs::rng::{Purpose, stream};
use envs::{EnvOptions, Goals, draw_pool};
use reports::schema::{Manifest, Record, Teaching};
use rustix::process::{Pid, Signal, kill_process};
use serde::de::DeserializeOwned;

/// The example itself: its own tests run here, as `cargo test` runs none of examples.
#[path = "../examples/own_curriculum.rs"]
#[expect(dead_code, reason = "its `main` is the program's")]
mod example;

fn run(args: &[&str]) -> Output {
    support::run_example("own_curriculum", args)
}

/// Goals in the pool of the toy task.
const POOL: usize = 50;

/// Arguments for the toy task in 40 episodes with two evaluations on the way, into `out`. Later settings
/// override.
fn toy_args<'a>(out: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
    let out = out.to_str().expect("a test path is UTF-8");
    let mut args = vec!["run", "--env", "Point", "--curriculum", "nearest", "--out", out];
    for set in ["budget.steps=800", "evaluation.every=400", "student.batch=64", "student.width=32"] {
        args.extend(["--set", set]);
    }
    args.extend(["--set", "pool.size=50"]);
    more.iter().for_each(|set| args.extend(["--set", set]));
    args
}

/// Runs the toy task into `out`.
fn toy(out: &Path, more: &[&str]) -> Output {
    run(&toy_args(out, more))
}

/// The toy run's folder within `out`.
fn run_folder(out: &Path) -> PathBuf {
    out.join("runs/Point/nearest/default/seed-0")
}

/// The lines of a file of the run in `out`.
fn lines<T: DeserializeOwned>(out: &Path, file: &str) -> Vec<T> {
    let text = std::fs::read_to_string(run_folder(out).join(file)).expect("the run recorded");
    text.lines().map(|line| serde_json::from_str(line).expect("a line of this kind")).collect()
}

/// The toy run's pool, drawn once more.
fn pool() -> Goals {
    let mut env = envs::make("Point", &EnvOptions::default()).expect("an environment");
    draw_pool(&mut *env, POOL, &mut stream(0, Purpose::Pool)).expect("a pool")
}

/// Where the first `episodes` episodes of the toy run start, drawn once more.
fn starts(episodes: usize) -> Vec<Vec<f64>> {
    let mut env = envs::make("Point", &EnvOptions::default()).expect("an environment");
    let mut rng = stream(0, Purpose::Environment);
    let mut start = || {
        env.reset(&mut rng).expect("a start");
        env.observation().achieved.clone()
    };
    (0..episodes).map(|_| start()).collect()
}

/// The `n` goals of `pool` that are nearest to `start`, by index.
fn nearest(pool: &Goals, start: &[f64], n: usize) -> Vec<usize> {
    let distance = |goal: usize| (pool.row(goal)[0] - start[0]).hypot(pool.row(goal)[1] - start[1]);
    let mut goals: Vec<usize> = (0..pool.len()).collect();
    goals.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    goals.truncate(n);
    goals.sort_unstable();
    goals
}

#[test]
fn it_is_listed_configured_run_and_recorded_like_a_built_in_one() {
    let listed = run(&["list", "curricula"]);
    assert!(String::from_utf8_lossy(&listed.stdout).contains("Nearest first"));

    let folder = tempfile::tempdir().expect("a temporary folder");
    let own = ["curriculum.nearest.threshold=0.0", "curriculum.nearest.episodes=10"];
    let done = toy(folder.path(), &own);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    // With threshold 0 the share grows by 0.05 every 10 of the 40 episodes. The last of them was drawn before
    // it grew for the fourth time: from a quarter of the 50 goals, rounded.
    let records: Vec<Record> = lines(folder.path(), "records.jsonl");
    let last = &records.last().expect("evaluations").teacher;
    assert!((last["share"].as_f64().expect("a number") - 0.3).abs() < 1e-12, "{last:?}");
    assert!((last["effective_goals"].as_f64().expect("a number") - 13.0).abs() < 1e-9, "{last:?}");
    let teaching: Vec<Teaching> = lines(folder.path(), "teaching.jsonl");
    let weights = teaching.last().and_then(|line| line.weights.as_ref()).expect("a teacher of the pool");
    assert_eq!((weights.len(), weights.iter().filter(|&&p| p > 0.0).count()), (POOL, 13));
}

#[test]
fn it_draws_the_goals_that_are_nearest_to_the_start() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Evaluated after every cycle of two episodes. The circle never grows: a tenth of the pool, that is 5
    // goals.
    let own = ["evaluation.every=40", "evaluation.episodes=1", "curriculum.nearest.growth=0"];
    let done = toy(folder.path(), &own);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let teaching: Vec<Teaching> = lines(folder.path(), "teaching.jsonl");
    let (pool, starts) = (pool(), starts(40));
    let circles: Vec<Vec<usize>> = starts.iter().map(|start| nearest(&pool, start, 5)).collect();
    assert!(circles.iter().any(|circle| *circle != circles[0]), "it moves with the start");

    let goals: Vec<&Vec<f32>> = teaching.iter().flat_map(|line| &line.goals).collect();
    assert_eq!(goals.len(), circles.len());
    for (goal, circle) in goals.iter().zip(&circles) {
        let is = |&index: &usize| pool.row(index).iter().map(|&x| x as f32).eq(goal.iter().copied());
        assert!(circle.iter().any(is), "{goal:?} is none of {circle:?}");
    }
    assert!(goals.iter().any(|goal| *goal != goals[0]), "one of several");

    // The first line tells of the untrained student; then every line has the circle of its second episode.
    assert_eq!(teaching.len(), 1 + 20);
    for (line, circle) in teaching[1..].iter().zip(circles.iter().skip(1).step_by(2)) {
        let weights = line.weights.as_ref().expect("a teacher of the pool");
        let within: Vec<usize> = (0..POOL).filter(|&goal| weights[goal] > 0.0).collect();
        assert_eq!(&within, circle);
        assert!(within.iter().all(|&goal| weights[goal] == 0.2), "{weights:?}");
    }
}

#[test]
fn it_looks_back_on_the_last_episodes_since_its_circle_grew() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let own = ["budget.steps=3000", "evaluation.every=40", "evaluation.episodes=1"];
    let rule = ["curriculum.nearest.threshold=0.75", "curriculum.nearest.episodes=4"];
    let done = toy(folder.path(), &[own.as_slice(), &rule].concat());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let records: Vec<Record> = lines(folder.path(), "records.jsonl");
    let teaching: Vec<Teaching> = lines(folder.path(), "teaching.jsonl");
    assert_eq!((records.len(), teaching.len()), (1 + 75, 1 + 75));

    let mut share = 0.1f64;
    // Outcomes since the circle grew, all of them, and how many there were whenever it did.
    let (mut outcomes, mut waits) = (Vec::new(), Vec::new());
    for (record, line) in records.iter().zip(&teaching) {
        for &success in &line.successes {
            outcomes.push(success);
            if outcomes.len() >= 4 && outcomes.iter().rev().take(4).filter(|&&success| success).count() >= 3 {
                share = (share + 0.05).min(1.0);
                waits.push(outcomes.len());
                outcomes.clear();
            }
        }
        assert_eq!(record.teacher["share"], share, "at step {}", record.step);
    }
    // Windows that do not overlap would grow after multiples of 4 alone, the shortest wait is 4.
    assert!(waits.contains(&4) && waits.iter().any(|wait| !wait.is_multiple_of(4)), "{waits:?}");
}

#[test]
fn stopped_and_resumed_it_teaches_as_if_it_had_not_been() {
    let longer = ["budget.steps=4000", "evaluation.every=200", "curriculum.nearest.episodes=7"];
    let undisturbed = tempfile::tempdir().expect("a temporary folder");
    assert!(toy(undisturbed.path(), &longer).status.success());

    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut child = Command::new(support::example("own_curriculum"))
        .args(toy_args(folder.path(), &longer))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the example program, which cargo builds with the tests");
    let begun = Instant::now();
    while !run_folder(folder.path()).join("checkpoint.bin").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no checkpoint within a minute");
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = i32::try_from(child.id()).ok().and_then(Pid::from_raw).expect("a process id");
    kill_process(id, Signal::TERM).expect("it runs");
    assert_eq!(child.wait().expect("it was started here").code(), Some(3), "stopped before its end");
    assert!(toy(folder.path(), &longer).status.success());

    for file in ["records.jsonl", "teaching.jsonl"] {
        let read = |out: &Path| std::fs::read(run_folder(out).join(file)).expect("the run recorded");
        assert!(read(folder.path()) == read(undisturbed.path()), "{file} differs");
    }
    let records: Vec<Record> = lines(folder.path(), "records.jsonl");
    let shares: Vec<f64> = records.iter().filter_map(|record| record.teacher["share"].as_f64()).collect();
    assert!(shares.first() < shares.last(), "there was something to remember: {shares:?}");
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

/// Changes the manifest of the toy run with `seed` in `out` as if another version of `name` had written it.
fn made_by(out: &Path, seed: u64, name: &str, version: &str) {
    let path = out.join(format!("runs/Point/nearest/default/seed-{seed}/manifest.json"));
    let text = std::fs::read_to_string(&path).expect("a manifest");
    let mut manifest: serde_json::Value = serde_json::from_str(&text).expect("a manifest");
    assert!(manifest["versions"][name].is_string(), "{text}");
    manifest["versions"][name] = version.into();
    std::fs::write(&path, format!("{manifest:#}\n")).expect("it can be written");
}

#[test]
fn its_manifest_names_program_executable_and_the_version_of_the_curriculum() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    assert!(toy(folder.path(), &[]).status.success());
    let text = std::fs::read_to_string(run_folder(folder.path()).join("manifest.json")).expect("a manifest");
    let manifest: Manifest = serde_json::from_str(&text).expect("a manifest");
    assert_eq!(manifest.versions["program"], format!("own_curriculum {}", env!("CARGO_PKG_VERSION")));
    assert_eq!(manifest.versions["curriculum"], "1");
    let executable = std::fs::read(support::example("own_curriculum")).expect("the example program");
    assert_eq!(manifest.versions["executable"], reports::store::digest::sha256(&executable));
    assert_eq!(manifest.hash, reports::store::checksums::manifest_hash(&manifest.run, &manifest.config));
}

#[test]
fn runs_of_another_version_of_the_curriculum_are_not_taken_for_its_own() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    assert!(toy(folder.path(), &[]).status.success());
    made_by(folder.path(), 0, "curriculum", "0");
    let refused = toy(folder.path(), &[]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("versions.curriculum: \"0\" there, \"1\" now"), "{said}");
    // A program that was built again, or an older manifest that does not tell, is no other version.
    made_by(folder.path(), 0, "curriculum", "1");
    made_by(folder.path(), 0, "executable", "0123456789abcdef");
    made_by(folder.path(), 0, "program", "own_curriculum 0.0.1");
    assert!(toy(folder.path(), &[]).status.success(), "a finished run is kept");
}

#[test]
fn what_another_program_began_does_not_go_on_and_another_build_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    assert!(toy(folder.path(), &[]).status.success());
    // Unfinished again: what was recorded is there, and its end is not.
    for name in ["outcome.json", "checksums.json"] {
        std::fs::remove_file(run_folder(folder.path()).join(name)).expect("it was there");
    }
    made_by(folder.path(), 0, "program", "own_curriculum 0.0.1");
    let refused = toy(folder.path(), &[]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("versions.program: \"own_curriculum 0.0.1\" there"), "{said}");

    made_by(folder.path(), 0, "program", concat!("own_curriculum ", env!("CARGO_PKG_VERSION")));
    made_by(folder.path(), 0, "executable", "0123456789abcdef");
    let told = toy(folder.path(), &[]);
    let said = String::from_utf8_lossy(&told.stderr);
    assert!(said.contains("begun by another build of this version (SHA-256 0123456789ab"), "{said}");
}

#[test]
fn a_report_names_runs_of_a_cell_that_other_versions_made() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().to_str().expect("a test path is UTF-8");
    let args: Vec<&str> = toy_args(folder.path(), &[]).into_iter().chain(["--seeds", "0,1"]).collect();
    assert!(run(&args).status.success());
    assert!(run(&["report", out]).status.success());
    made_by(folder.path(), 1, "curriculum", "2");
    let named = run(&["report", out]);
    let said = String::from_utf8_lossy(&named.stderr);
    assert_eq!(named.status.code(), Some(1), "{said}");
    let expected =
        "seed-1/manifest.json: versions.curriculum is `2`, that of Point/nearest/default/seed-0 is `1`";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn the_page_that_walks_through_it_quotes_it() {
    let (page, example) =
        (include_str!("../docs/curricula.md"), include_str!("../examples/own_curriculum.rs"));
    support::assert_quotes(page, "### The example, step by step", example);
}
