//! Same config, same bytes.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::Path;

use reports::schema::{Learning, Record, RunKey};
use reports::store::layout;
use support::{stderr, toy, toy_args};

fn records(results: &Path, curriculum: &str, seed: u64) -> Vec<u8> {
    read(results, curriculum, seed, layout::RECORDS)
}

fn diagnoses(results: &Path, curriculum: &str, seed: u64) -> Vec<u8> {
    read(results, curriculum, seed, layout::STUDENT)
}

fn read(results: &Path, curriculum: &str, seed: u64, file: &str) -> Vec<u8> {
    let run = RunKey {
        environment: "Point".into(),
        curriculum: curriculum.into(),
        variant: "default".into(),
        seed,
    };
    fs::read(layout::run_dir(results, &run).join(file)).expect("the run recorded")
}

fn parsed(bytes: &[u8]) -> Vec<Record> {
    let text = std::str::from_utf8(bytes).expect("JSON is UTF-8");
    text.lines().map(|line| serde_json::from_str(line).expect("a record")).collect()
}

#[test]
fn the_same_config_gives_the_same_bytes_whatever_the_number_of_jobs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    toy(&one, &["--jobs", "1"]);
    toy(&two, &["--jobs", "3"]);
    for curriculum in ["teach", "her-iid"] {
        for seed in [0, 1] {
            let bytes = records(&one, curriculum, seed);
            assert_eq!(bytes, records(&two, curriculum, seed), "{curriculum} {seed}");
            assert_eq!(diagnoses(&one, curriculum, seed), diagnoses(&two, curriculum, seed));
            let steps: Vec<u64> = parsed(&bytes).iter().map(|record| record.step).collect();
            assert_eq!(
                steps,
                [0, 120, 200, 320, 400],
                "an evaluation at the first cycle's end past each 100 steps"
            );
        }
    }
    assert_ne!(records(&one, "teach", 0), records(&one, "teach", 1), "the seed matters");
}

/// What a student remembers and how its learning stands, at evaluations after 6, 10, 16 and 20 episodes of 20
/// steps.
#[test]
fn every_evaluation_has_a_diagnosis_of_the_student() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0"]);
    let text = String::from_utf8(diagnoses(folder.path(), "her-iid", 0)).expect("JSON is UTF-8");
    let lines: Vec<Learning> =
        text.lines().map(|line| serde_json::from_str(line).expect("a diagnosis")).collect();
    let sizes: Vec<_> =
        lines.iter().map(|line| (line.step, line.replay_episodes, line.replay_transitions)).collect();
    assert_eq!(sizes, [(0, 0, 0), (120, 6, 120), (200, 10, 200), (320, 16, 320), (400, 20, 400)]);
    let untrained = Learning::default();
    assert_eq!(lines[0], untrained, "nothing to learn from yet");
    for line in &lines[1..] {
        assert!(line.numbers().iter().all(|(_, number)| number.is_some()), "{line:?}");
        assert!(line.critic_gradient_norm > Some(0.0) && line.actor_gradient_norm > Some(0.0), "{line:?}");
        assert!(line.critic_loss > Some(0.0) && line.mean_q < Some(1.0), "{line:?}");
    }
    assert_ne!(lines[1].mean_q, lines[2].mean_q);
}

#[test]
fn curricula_of_one_seed_start_from_the_same_student_and_evaluation() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "3"]);
    let first = |curriculum| parsed(&records(folder.path(), curriculum, 3)).remove(0);
    let (teach, iid) = (first("teach"), first("her-iid"));
    assert_eq!((teach.success_rate, teach.mean_return), (iid.success_rate, iid.mean_return));
}

#[test]
fn finished_runs_are_kept_and_an_unfinished_one_ends_with_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &[]);
    let (kept, redone) = (records(folder.path(), "her-iid", 0), records(folder.path(), "teach", 1));
    let run = |seed| folder.path().join(format!("runs/Point/teach/default/seed-{seed}"));
    // As after a kill before the first checkpoint: one record and a half, no outcome.
    fs::remove_file(run(1).join(goalbench::run::checkpoint::CHECKPOINT)).expect("the run saved checkpoints");
    fs::remove_file(run(1).join(layout::OUTCOME)).expect("the run ended");
    fs::write(run(1).join(layout::RECORDS), &redone[..redone.len() * 3 / 10])
        .expect("the records can be cut");
    let output = support::goalbench(&toy_args(folder.path(), &[]));
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("kept from before").count(), 3, "{}", stderr(&output));
    assert_eq!(records(folder.path(), "her-iid", 0), kept);
    assert_eq!(records(folder.path(), "teach", 1), redone);
}

#[test]
fn progress_can_be_read_by_scripts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = support::goalbench(&support::toy_args(folder.path(), &["--json", "--seeds", "0"]));
    let lines: Vec<serde_json::Value> = support::stdout(&output)
        .lines()
        .map(|line| serde_json::from_str(line).expect("every line is JSON"))
        .collect();
    for curriculum in ["teach", "her-iid"] {
        let events: Vec<_> = lines.iter().filter(|line| line["run"]["curriculum"] == curriculum).collect();
        assert_eq!(events.first().expect("events")["event"], "started");
        let last = events.last().expect("events");
        assert_eq!((&last["event"], &last["steps"]), (&"ended".into(), &400.into()), "{last}");
        assert_eq!(last["outcome"]["step"], 400, "{last}");
        let evaluated = events.iter().filter(|event| event["event"] == "evaluated").count();
        assert_eq!(evaluated, parsed(&records(folder.path(), curriculum, 0)).len());
    }
}

#[test]
fn records_hold_nothing_of_the_clock_and_timings_are_apart() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0", "--curriculum", "teach"]);
    let run = folder.path().join("runs/Point/teach/default/seed-0");
    let lines = |name: &str| fs::read_to_string(run.join(name)).expect(name).lines().count();
    assert_eq!(lines(layout::RECORDS), lines(layout::TIMING));
    let text = String::from_utf8(records(folder.path(), "teach", 0)).expect("UTF-8");
    assert!(!text.contains("wall"), "{text}");
    assert!(
        parsed(text.as_bytes()).iter().all(|record| !record.teacher.is_empty()),
        "the teacher's numbers are recorded"
    );
}

#[test]
fn networks_and_physics_of_real_size_give_the_same_bytes_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = |out: &str, jobs: &str| {
        let out = folder.path().join(out);
        let output = support::goalbench(&[
            "run",
            "--env",
            "FetchReach,MazeA",
            "--curriculum",
            "teach",
            "--steps",
            "300",
            "--jobs",
            jobs,
            "--set",
            "evaluation.every=100",
            "--set",
            "evaluation.episodes=2",
            "--out",
            out.to_str().expect("a test path is UTF-8"),
        ]);
        assert!(output.status.success(), "{}", stderr(&output));
        ["FetchReach", "MazeA"].map(|environment| {
            let run = out.join("runs").join(environment).join("teach/default/seed-0");
            [layout::RECORDS, layout::TEACHING]
                .map(|name| fs::read(run.join(name)).expect("the run recorded"))
        })
    };
    assert!(run("one", "1") == run("two", "2"), "batch 1024, width 256, MuJoCo");
}
