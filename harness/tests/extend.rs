//! Training on: a run with a larger budget goes on from where the smaller one ended.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use reports::schema::Manifest;
use reports::store::{RunFolder, layout};
use rustix::process::{Pid, Signal, kill_process};
use support::{goalbench, stderr, stdout, toy, toy_args};

const RECORDED: [&str; 2] = [layout::RECORDS, layout::TEACHING];
const SHORT: [&str; 6] = ["--curriculum", "teach,space", "--seeds", "0", "--steps", "400"];
const LONG: [&str; 6] = ["--curriculum", "teach,space", "--seeds", "0", "--steps", "800"];

fn runs(results: &Path) -> [PathBuf; 2] {
    ["teach", "space"].map(|curriculum| results.join("runs/Point").join(curriculum).join("default/seed-0"))
}

fn recorded(results: &Path) -> Vec<Vec<u8>> {
    let files = runs(results).into_iter().flat_map(|run| RECORDED.map(|name| run.join(name)));
    files.map(|file| fs::read(file).expect("every run has ended")).collect()
}

fn manifest(run: &Path) -> Manifest {
    RunFolder::new(run).manifest().expect("a sound manifest").expect("a manifest")
}

fn extend<'a>(results: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
    toy_args(results, &[&LONG[..], &["--extend"], more].concat())
}

#[test]
fn a_finished_run_goes_on_and_becomes_what_the_larger_budget_gives() {
    let [short, long] = [0; 2].map(|_| tempfile::tempdir().expect("a temporary folder"));
    toy(short.path(), &SHORT);
    toy(long.path(), &LONG);
    let before = recorded(short.path());

    // Not unless it is asked for; then told how.
    let refused = goalbench(&toy_args(short.path(), &LONG));
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    for part in ["a budget of 400 training steps, not 800", "--extend"] {
        assert!(stderr(&refused).contains(part), "{}", stderr(&refused));
    }
    assert_eq!(recorded(short.path()), before);

    let output = goalbench(&extend(short.path(), &[]));
    assert!(output.status.success(), "{}", stderr(&output));
    let after = recorded(short.path());
    assert!(
        before.iter().zip(&after).all(|(before, after)| after.starts_with(before)),
        "what was recorded stays"
    );
    // The evaluation at 400 lies on a multiple of evaluation.every, as all runs have one.
    assert_eq!(after, recorded(long.path()));
    for run in runs(short.path()) {
        assert_eq!(manifest(&run).earlier_budgets, [400], "the records say so");
    }
    assert_eq!(manifest(&runs(long.path())[0]).earlier_budgets, [0; 0]);

    // The same command finds nothing to do, a third budget goes on again, and a smaller one is refused.
    let again = goalbench(&extend(short.path(), &[]));
    assert!(again.status.success() && recorded(short.path()) == after, "{}", stderr(&again));
    let third = goalbench(&extend(short.path(), &["--steps", "1000"]));
    assert!(third.status.success(), "{}", stderr(&third));
    assert_eq!(manifest(&runs(short.path())[0]).earlier_budgets, [400, 800]);
    let back = goalbench(&extend(short.path(), &["--steps", "400"]));
    assert_eq!(back.status.code(), Some(2));
    assert!(stderr(&back).contains("budget.steps: 1000 there, 400 now"), "{}", stderr(&back));
    for command in ["status", "report", "evaluate"] {
        let output = goalbench(&[command, short.path().to_str().expect("a test path is UTF-8")]);
        assert!(output.status.success(), "{command}: {}{}", stderr(&output), stdout(&output));
    }
}

#[test]
fn an_evaluation_that_only_the_smaller_budget_had_stays() {
    let every = ["--set", "evaluation.every=300"];
    let [short, long] = [0; 2].map(|_| tempfile::tempdir().expect("a temporary folder"));
    toy(short.path(), &[&SHORT[..], &every].concat());
    toy(long.path(), &[&LONG[..], &every].concat());
    let before = recorded(short.path());
    let output = goalbench(&extend(short.path(), &every));
    assert!(output.status.success(), "{}", stderr(&output));
    let after = recorded(short.path());
    assert!(before.iter().zip(&after).all(|(before, after)| after.starts_with(before)));
    let steps = |results: &Path| -> Vec<u64> {
        let records = RunFolder::new(&runs(results)[0]).records().expect("records");
        records.iter().map(|record| record.step).collect()
    };
    assert_eq!(steps(long.path()), [0, 320, 600, 800]);
    assert_eq!(steps(short.path()), [0, 320, 400, 600, 800]);
    // Training is the same all the same: the goals of all episodes, in order.
    let goals = |results: &Path| -> Vec<Vec<f32>> {
        let teaching = RunFolder::new(&runs(results)[0]).teaching().expect("teaching");
        teaching.into_iter().flat_map(|teaching| teaching.goals).collect()
    };
    assert_eq!(goals(short.path()), goals(long.path()));
}

#[test]
fn kills_during_an_extension_change_no_byte() {
    let [short, long] = [0; 2].map(|_| tempfile::tempdir().expect("a temporary folder"));
    toy(short.path(), &SHORT);
    let more = ["--steps", "3000", "--set", "evaluation.every=100"];
    toy(long.path(), &[&LONG[..], &more].concat());
    let args = extend(short.path(), &more);
    for round in 0..8 {
        let mut command = Command::new(env!("CARGO_BIN_EXE_goalbench"));
        let child = command.args(&args).stdout(Stdio::null()).stderr(Stdio::null()).process_group(0).spawn();
        let mut child = child.expect("the program starts");
        std::thread::sleep(Duration::from_millis(90 * round));
        let pid = Pid::from_raw(i32::try_from(child.id()).expect("a process id")).expect("a process id");
        let _ = kill_process(pid, Signal::KILL);
        child.wait().expect("it was started here");
        // What it records so far is sound: the old end, or further.
        let status = goalbench(&["status", short.path().to_str().expect("a test path is UTF-8")]);
        assert!(!stdout(&status).contains("damaged"), "round {round}: {}", stdout(&status));
    }
    let output = goalbench(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(recorded(short.path()), recorded(long.path()));
}

#[test]
fn every_state_between_the_old_end_and_the_new_budget_goes_on() {
    let [short, long] = [0; 2].map(|_| tempfile::tempdir().expect("a temporary folder"));
    toy(short.path(), &SHORT);
    toy(long.path(), &LONG);
    // Killed after its outcome was removed, or its checksums too: it is the old run, and it can be ended.
    for gone in [&[layout::OUTCOME][..], &[layout::OUTCOME, layout::CHECKSUMS]] {
        for run in runs(short.path()) {
            gone.iter().for_each(|name| drop(fs::remove_file(run.join(name))));
        }
        toy(short.path(), &SHORT);
        for run in runs(short.path()) {
            gone.iter().for_each(|name| drop(fs::remove_file(run.join(name))));
        }
    }
    let output = goalbench(&extend(short.path(), &[]));
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(recorded(short.path()), recorded(long.path()));
}

#[test]
fn what_cannot_go_on_is_refused_and_left_as_it_was() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &[&SHORT[..], &["--discard-replay"]].concat());
    let [run, _] = runs(folder.path());
    assert!(!run.join(layout::REPLAY).exists());
    let before = fs::read(run.join(layout::MANIFEST)).expect("a manifest");
    let refuse = |part: &str| {
        let output = goalbench(&extend(folder.path(), &[]));
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(part), "expected {part:?} in {}", stderr(&output));
        assert_eq!(fs::read(run.join(layout::MANIFEST)).expect("a manifest"), before);
        assert!(run.join(layout::OUTCOME).exists());
    };
    refuse("--discard-replay");
    fs::remove_file(run.join(layout::CHECKPOINT)).expect("a checkpoint");
    refuse("checkpoint.bin: is missing");
    fs::write(run.join(layout::RECORDS), "").expect("it can be written");
    refuse("was cut off or altered after the run ended");
    // Without --out the folder is named after the command, so there is nothing to go on with.
    let nowhere =
        goalbench(&["run", "--env", "Point", "--curriculum", "teach", "--steps", "800", "--extend"]);
    assert_eq!(nowhere.status.code(), Some(2));
    assert!(stderr(&nowhere).contains("--extend: needs --out"), "{}", stderr(&nowhere));
}
