//! Bringing results of several machines together.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use reports::store::layout;
use support::{goalbench, stderr, stdout, toy};

/// Arguments of a merge of `sources` into `out`.
fn merge(sources: &[&Path], out: &Path) -> std::process::Output {
    let text = |path: &Path| path.to_str().expect("a test path is UTF-8").to_owned();
    let mut args = vec!["merge".to_owned()];
    args.extend(sources.iter().map(|source| text(source)));
    args.extend(["--out".to_owned(), text(out)]);
    goalbench(&args.iter().map(String::as_str).collect::<Vec<_>>())
}

fn run(results: &Path, seed: u64) -> PathBuf {
    results.join(format!("runs/Point/teach/default/seed-{seed}"))
}

/// Two machines' shares of one sweep: seeds 0 and 1, seeds 1 and 2.
fn shares(folder: &Path) -> (PathBuf, PathBuf) {
    let (a, b) = (folder.join("a"), folder.join("b"));
    toy(&a, &["--seeds", "0,1"]);
    toy(&b, &["--seeds", "1,2", "--tensorboard"]);
    (a, b)
}

#[test]
fn shares_of_a_sweep_become_one_folder_that_can_be_gone_on_with() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    let out = folder.path().join("all");
    let output = merge(&[&a, &b], &out);
    assert!(output.status.success(), "{}", stderr(&output));
    for (seed, source) in [(0, &a), (1, &a), (2, &b)] {
        let recorded = [layout::RECORDS, layout::TEACHING, layout::STUDENT, layout::TIMING];
        for name in recorded.into_iter().chain([layout::MANIFEST, layout::OUTCOME]) {
            let copied = fs::read(run(&out, seed).join(name)).expect(name);
            assert!(copied == fs::read(run(source, seed).join(name)).expect(name), "seed {seed}: {name}");
        }
    }
    assert!(run(&out, 2).join(goalbench::tracking::EVENTS).exists(), "the event file came along");

    // The merged folder is a results folder like any other: finished runs are kept, further ones added.
    let before = fs::metadata(run(&out, 0).join(layout::RECORDS)).and_then(|file| file.modified());
    toy(&out, &["--seeds", "0..4"]);
    let after = fs::metadata(run(&out, 0).join(layout::RECORDS)).and_then(|file| file.modified());
    assert_eq!(before.expect("a file"), after.expect("a file"));
    let status = goalbench(&["status", out.to_str().expect("UTF-8")]);
    assert!(stdout(&status).contains("8 runs: 8 finished"), "{}", stdout(&status));
}

#[test]
fn of_two_equal_runs_the_one_that_kept_its_timings_is_taken() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    fs::remove_file(run(&a, 1).join(layout::TIMING)).expect("timings");
    for (name, sources) in [("ab", [&*a, &*b]), ("ba", [&*b, &*a])] {
        let out = folder.path().join(name);
        assert!(merge(&sources, &out).status.success());
        assert!(run(&out, 1).join(layout::TIMING).exists(), "{name}");
    }
}

#[test]
fn of_two_states_of_a_run_the_further_one_is_taken_whatever_their_order() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    // As if machine b had been switched off in the middle of seed 1.
    let records = run(&b, 1).join(layout::RECORDS);
    let text = fs::read_to_string(&records).expect("records");
    let half: String = text.split_inclusive('\n').take(2).collect();
    fs::write(&records, half).expect("the test folder can be written");
    fs::remove_file(run(&b, 1).join(layout::OUTCOME)).expect("an outcome");
    for (number, sources) in [[a.as_path(), &b], [b.as_path(), &a]].iter().enumerate() {
        let out = folder.path().join(format!("all-{number}"));
        let output = merge(sources, &out);
        assert!(output.status.success(), "{}", stderr(&output));
        let merged = fs::read_to_string(run(&out, 1).join(layout::RECORDS)).expect("records");
        assert_eq!(merged, text);
    }
}

#[test]
fn conflicting_runs_are_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    let out = folder.path().join("all");
    let refused = |sources: &[&Path], expected: &[&str]| {
        let output = merge(sources, &out);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        for part in expected {
            assert!(stderr(&output).contains(part), "expected {part:?} in {}", stderr(&output));
        }
        assert!(!out.exists(), "nothing is written");
    };

    // Another config under the same name.
    let other = folder.path().join("other");
    toy(&other, &["--seeds", "0,1", "--set", "student.batch=33"]);
    let conflicts = ["Point/teach/default/seed-0", "Point/teach/default/seed-1", "have different configs"];
    refused(&[&a, &other], &conflicts);

    // The same config and other records: one of the machines computes differently.
    let records = run(&b, 1).join(layout::RECORDS);
    let text = fs::read_to_string(&records)
        .expect("records")
        .replace("\"gradient_steps\":12", "\"gradient_steps\":13");
    fs::write(&records, text).expect("the test folder can be written");
    fs::remove_file(run(&b, 1).join(layout::OUTCOME)).expect("an outcome");
    refused(&[&a, &b], &["Point/teach/default/seed-1", "different records"]);

    refused(&[&a, &folder.path().join("nowhere")], &["nowhere"]);
}

#[test]
fn an_existing_folder_is_not_merged_into() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    let output = merge(&[&a, &b], &a);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("exists already"), "{}", stderr(&output));
}
