//! Killed at any moment, a run ends with the same bytes as one never killed.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use reports::store::layout;
use rustix::process::Signal;
use support::children::{results, signal, start, workers};
use support::{goalbench, stderr, toy, toy_args};

/// Long enough to be killed in: about three seconds. All teachers have much to remember; SPaCE's set has
/// grown before long, and SFL's rollouts, 40 episodes for 10 of training, are nearly always pending.
const LONGER: [&str; 18] = [
    "--curriculum",
    "teach,space,sfl",
    "--set",
    "curriculum.sfl.interval=10",
    "--set",
    "curriculum.sfl.candidates=10",
    "--set",
    "curriculum.sfl.kept=3",
    "--set",
    "curriculum.space.update_steps=40",
    "--steps",
    "4000",
    "--set",
    "evaluation.every=200",
    "--set",
    "student.updates_per_cycle=12",
    "--seeds",
    "0",
];

/// The run of TEACH in `folder`.
fn teach(folder: &Path) -> PathBuf {
    folder.join("runs/Point/teach/default/seed-0")
}

/// Waits until the run of TEACH has saved a checkpoint later than `after` (bytes of its records then).
fn wait_for_checkpoint(folder: &Path, after: u64) -> u64 {
    let begun = Instant::now();
    loop {
        let recorded = fs::metadata(teach(folder).join(layout::RECORDS)).map_or(0, |file| file.len());
        if recorded > after && teach(folder).join("checkpoint.bin").exists() {
            return recorded;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "no checkpoint within a minute");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Moments from a fixed sequence that looks random: every test run tries the same ones.
fn moments() -> impl Iterator<Item = Duration> {
    let mut state = 0x9e37_79b9_u32;
    std::iter::from_fn(move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        Some(Duration::from_millis(u64::from(state >> 16) % 600))
    })
}

fn undisturbed() -> BTreeMap<PathBuf, Vec<u8>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &LONGER);
    results(folder.path())
}

#[test]
fn kills_of_workers_and_parents_at_any_moment_change_no_byte() {
    let expected = undisturbed();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = toy_args(folder.path(), &LONGER);
    let mut came_further = 0;
    for (round, moment) in moments().take(14).enumerate() {
        let recorded =
            || fs::metadata(teach(folder.path()).join(layout::RECORDS)).map_or(0, |file| file.len());
        let before = recorded();
        let mut parent = start(&args);
        std::thread::sleep(moment);
        // In every other round, kill in the moment in which an evaluation is recorded and its checkpoint
        // begun.
        let begun = Instant::now();
        while round % 2 == 1 && recorded() <= before && begun.elapsed() < Duration::from_secs(5) {
            std::thread::sleep(Duration::from_micros(200));
        }
        came_further += u32::from(recorded() > before);
        if round % 2 == 0 {
            for worker in workers(parent.id()) {
                signal(worker, Signal::KILL);
            }
            std::thread::sleep(moment / 2);
        }
        signal(parent.id(), Signal::KILL);
        parent.wait().expect("it was started here");
    }
    assert!(came_further >= 3, "kills fell into {came_further} rounds in which something was recorded");
    toy(folder.path(), &LONGER);
    assert_eq!(results(folder.path()), expected);
}

#[test]
fn a_signal_saves_a_checkpoint_and_the_same_command_goes_on() {
    let expected = undisturbed();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = toy_args(folder.path(), &LONGER);
    let mut recorded = 0;
    for (kind, more) in [(Signal::INT, Some("--tensorboard")), (Signal::TERM, None)] {
        let mut parent = start(&[&args[..], more.as_slice()].concat());
        wait_for_checkpoint(folder.path(), recorded);
        signal(parent.id(), kind);
        let status = parent.wait().expect("it was started here");
        assert_eq!(status.code(), Some(3), "stopped, not failed");
        recorded = fs::metadata(teach(folder.path()).join(layout::RECORDS)).expect("records").len();
    }
    toy(folder.path(), &LONGER);
    assert_eq!(results(folder.path()), expected);
    // An event file, once begun, goes on with the run: the version of its format, then every evaluation once.
    let records = fs::read_to_string(teach(folder.path()).join(layout::RECORDS)).expect("records");
    let events = teach(folder.path()).join(goalbench::tracking::EVENTS);
    assert_eq!(support::tfrecords(&events), 1 + records.lines().count());
}

#[test]
fn a_crashed_worker_is_tried_again_and_noted() {
    let expected = undisturbed();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut parent = start(&toy_args(folder.path(), &LONGER));
    wait_for_checkpoint(folder.path(), 0);
    for worker in workers(parent.id()) {
        signal(worker, Signal::KILL);
    }
    assert!(parent.wait().expect("it was started here").success());
    assert_eq!(results(folder.path()), expected);
    let crashes = fs::read_to_string(teach(folder.path()).join(layout::CRASHES));
    assert!(crashes.expect("the crash is noted").contains("memory runs out (signal: 9"));
}

#[test]
fn altered_checkpoints_and_records_are_named_and_left_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = toy_args(folder.path(), &LONGER);
    let mut parent = start(&args);
    wait_for_checkpoint(folder.path(), 0);
    signal(parent.id(), Signal::TERM);
    parent.wait().expect("it was started here");
    let run = teach(folder.path());
    for name in ["checkpoint.bin", layout::RECORDS] {
        let path = run.join(name);
        let good = fs::read(&path).expect(name);
        let mut bad = good.clone();
        bad[20] ^= 1;
        fs::write(&path, &bad).expect(name);
        let output = goalbench(&args);
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert!(stderr(&output).contains(name), "{name}: {}", stderr(&output));
        assert_eq!(fs::read(&path).expect(name), bad, "{name} is left alone");
        fs::write(&path, &good).expect(name);
    }
    toy(folder.path(), &LONGER);
    assert_eq!(results(folder.path()), undisturbed());
}

#[test]
fn the_death_of_its_parent_makes_a_worker_save_a_checkpoint() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // No evaluation but the first, hence no checkpoint of its own accord, for a long time.
    let long =
        ["--steps", "1000000", "--set", "evaluation.every=1000000", "--seeds", "0", "--curriculum", "teach"];
    let mut parent = start(&toy_args(folder.path(), &long));
    let records = teach(folder.path()).join(layout::RECORDS);
    let begun = Instant::now();
    let soon = |what: &str| assert!(begun.elapsed() < Duration::from_secs(60), "waited a minute for {what}");
    while fs::metadata(&records).map_or(0, |file| file.len()) == 0 {
        soon("the first evaluation");
        std::thread::sleep(Duration::from_millis(5));
    }
    signal(parent.id(), Signal::KILL);
    parent.wait().expect("it was started here");
    while !teach(folder.path()).join("checkpoint.bin").exists() {
        soon("the checkpoint");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_worker_that_finds_its_run_ended_says_so_and_changes_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0"]);
    let before = results(folder.path());
    let output = goalbench(&["worker", teach(folder.path()).to_str().expect("a test path is UTF-8")]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("finished"));
    assert_eq!(results(folder.path()), before);
}
