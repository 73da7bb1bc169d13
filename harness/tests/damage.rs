//! Files that are not what they were: named, left alone, and nothing built upon them.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use reports::store::layout;
use support::{goalbench, stderr, stdout, toy, toy_args};

fn run(results: &Path) -> PathBuf {
    results.join("runs/Point/teach/default/seed-0")
}

fn finished() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0"]);
    folder
}

/// The same command once more must refuse and say each of `expected`; so must a merge; status goes on and
/// says it, too.
fn noticed(results: &Path, expected: &[&str]) {
    let out = results.with_extension("merged");
    let text = |path: &Path| path.to_str().expect("a test path is UTF-8").to_owned();
    let again = goalbench(&toy_args(results, &["--seeds", "0"]));
    let merged = goalbench(&["merge", &text(results), "--out", &text(&out)]);
    let status = goalbench(&["status", &text(results)]);
    assert_eq!((again.status.code(), merged.status.code()), (Some(2), Some(2)), "{}", stderr(&merged));
    assert!(!out.exists());
    for part in expected {
        for said in [stderr(&again), stderr(&merged), stdout(&status)] {
            assert!(said.contains(part), "expected {part:?} in\n{said}");
        }
    }
    assert!(stdout(&status).contains("2 runs: 1 finished, 1 damaged"), "{}", stdout(&status));
}

#[test]
fn records_of_a_finished_run_that_were_altered_cut_off_or_lost() {
    let folder = finished();
    let path = run(folder.path()).join(layout::RECORDS);
    let good = fs::read_to_string(&path).expect("records");
    let altered = good.replacen("\"success_rate\":0.0", "\"success_rate\":1.0", 1);
    assert_ne!(altered, good);
    for bad in [altered.as_str(), &good[..300]] {
        fs::write(&path, bad).expect("the test folder can be written");
        noticed(folder.path(), &["records.jsonl", "cut off or altered after the run ended"]);
        assert_eq!(fs::read_to_string(&path).expect("records"), bad, "it is left alone");
    }
    fs::remove_file(&path).expect("records");
    noticed(folder.path(), &["records.jsonl", "No such file"]);
}

#[test]
fn diagnoses_of_a_finished_run_that_were_altered_or_lost() {
    let folder = finished();
    let path = run(folder.path()).join(layout::STUDENT);
    let good = fs::read_to_string(&path).expect("diagnoses");
    fs::write(&path, good.replacen("\"replay_episodes\":0", "\"replay_episodes\":1", 1))
        .expect("it can be written");
    noticed(folder.path(), &["student.jsonl", "cut off or altered after the run ended"]);
    fs::remove_file(&path).expect("diagnoses");
    noticed(folder.path(), &["student.jsonl", "No such file"]);
}

#[test]
fn an_outcome_that_was_cut_off() {
    let folder = finished();
    fs::write(run(folder.path()).join(layout::OUTCOME), "{\"status\": \"fin").expect("it can be written");
    noticed(folder.path(), &["outcome.json", "cut off or altered", "delete the folder"]);
}

#[test]
fn a_run_that_lies_in_the_place_of_another() {
    let folder = finished();
    let other = "runs/Point/her-iid/default/seed-0";
    fs::copy(folder.path().join(other).join(layout::MANIFEST), run(folder.path()).join(layout::MANIFEST))
        .expect("it can be copied");
    let again = goalbench(&toy_args(folder.path(), &["--seeds", "0"]));
    assert_eq!(again.status.code(), Some(2));
    let expected = "belongs to the run Point/her-iid/default/seed-0, not to Point/teach/default/seed-0";
    assert!(stderr(&again).contains(expected), "{}", stderr(&again));
}

#[test]
fn a_lost_manifest_does_not_give_old_records_another_config() {
    let folder = finished();
    fs::remove_file(run(folder.path()).join(layout::MANIFEST)).expect("a manifest");
    let before = fs::read(run(folder.path()).join(layout::RECORDS)).expect("records");
    let again = goalbench(&toy_args(
        folder.path(),
        &["--seeds", "0", "--curriculum", "teach", "--set", "student.batch=33"],
    ));
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("manifest.json: is missing, though there is"), "{}", stderr(&again));
    assert_eq!(fs::read(run(folder.path()).join(layout::RECORDS)).expect("records"), before);
}

#[test]
fn a_lost_checkpoint_does_not_cost_the_records() {
    let folder = finished();
    for name in [layout::OUTCOME, "checkpoint.bin"] {
        fs::remove_file(run(folder.path()).join(name)).expect(name);
    }
    let before = fs::read(run(folder.path()).join(layout::RECORDS)).expect("records");
    let again = goalbench(&toy_args(folder.path(), &["--seeds", "0"]));
    assert_eq!(again.status.code(), Some(1));
    assert!(
        stderr(&again).contains("checkpoint.bin: is missing, though 5 evaluations"),
        "{}",
        stderr(&again)
    );
    assert_eq!(fs::read(run(folder.path()).join(layout::RECORDS)).expect("records"), before);
}

/// Lets the run's manifest say that it was begun with another version of something.
fn note_version(results: &Path, what: &str, version: &str) {
    let path = run(results).join(layout::MANIFEST);
    let text = fs::read_to_string(&path).expect("a manifest");
    let mut manifest: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    manifest["versions"][what] = version.into();
    fs::write(&path, manifest.to_string()).expect("it can be written");
}

#[test]
fn an_unfinished_run_of_another_commit_goes_on_and_says_so() {
    let folder = finished();
    note_version(folder.path(), "commit", "0123456789ab");
    // Killed before its first evaluation.
    for entry in fs::read_dir(run(folder.path())).expect("a run") {
        let path = entry.expect("it can be read").path();
        if path.is_dir() {
            fs::remove_dir_all(path).expect("it can be removed");
        } else if !path.ends_with(layout::MANIFEST) {
            fs::remove_file(path).expect("it can be removed");
        }
    }
    let output = goalbench(&toy_args(folder.path(), &["--seeds", "0"]));
    assert!(output.status.success(), "{}", stderr(&output));
    let note = "Point/teach/default/seed-0: begun by a build of commit 0123456789ab, goes on with ";
    assert!(stderr(&output).contains(note), "{}", stderr(&output));
}

#[test]
fn an_unfinished_run_of_another_version_is_not_gone_on_with() {
    let folder = finished();
    note_version(folder.path(), "mujoco", "3.1.0");
    let again = || goalbench(&toy_args(folder.path(), &["--seeds", "0"]));
    assert!(again().status.success(), "a finished run stays what it is");
    fs::remove_file(run(folder.path()).join(layout::OUTCOME)).expect("an outcome");
    let output = again();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("versions.mujoco: \"3.1.0\" there, \"3.3.7\" now"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_failed_run_is_kept_until_it_is_asked_to_try_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Learning rates beyond all reason: the student diverges.
    let wild = ["--seeds", "0", "--set", "student.actor_lr=1e30", "--set", "student.critic_lr=1e30"];
    let with = |more: &[&'static str]| goalbench(&toy_args(folder.path(), &[&wild[..], more].concat()));
    let outcome = || fs::read_to_string(run(folder.path()).join(layout::OUTCOME)).expect("an outcome");
    let first = with(&[]);
    assert_eq!(first.status.code(), Some(1), "{}", stderr(&first));
    let reason = outcome();
    assert!(reason.contains("failed") && reason.contains("not finite"), "{reason}");

    let kept = with(&[]);
    assert_eq!(kept.status.code(), Some(1));
    assert!(stderr(&kept).contains("kept from before") && stderr(&kept).contains("--retry-failed"));
    // On the CPU the same config fails in the same way, to the same bytes.
    let records = fs::read(run(folder.path()).join(layout::RECORDS)).expect("records");
    let retried = with(&["--retry-failed"]);
    assert_eq!(retried.status.code(), Some(1));
    assert!(!stderr(&retried).contains("kept from before"), "{}", stderr(&retried));
    assert_eq!(outcome(), reason);
    assert_eq!(fs::read(run(folder.path()).join(layout::RECORDS)).expect("records"), records);

    note_version(folder.path(), "mujoco", "3.1.0");
    let refused = with(&["--retry-failed"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("versions.mujoco"), "{}", stderr(&refused));
    assert_eq!(outcome(), reason, "nothing was lost");
}
