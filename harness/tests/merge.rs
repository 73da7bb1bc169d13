//! Bringing results of several machines together.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use reports::store::layout;
use support::{goalbench, seal, stderr, stdout, toy};

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

/// What a merge of `sources` in both orders says on standard error; it must succeed with the run of seed 1
/// whole.
fn merged_whole(folder: &Path, sources: [&Path; 2], name: &str) -> String {
    let mut said = String::new();
    for (order, [first, second]) in [sources, [sources[1], sources[0]]].into_iter().enumerate() {
        let out = folder.join(format!("{name}-{order}"));
        let output = merge(&[first, second], &out);
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        for file in [layout::RECORDS, layout::TEACHING, layout::CHECKPOINT, layout::OUTCOME] {
            let copied = fs::read(run(&out, 1).join(file)).expect(file);
            assert!(copied == fs::read(run(sources[0], 1).join(file)).expect(file), "{name}: {file}");
        }
        said += &stderr(&output);
    }
    said
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
fn of_several_copies_the_sound_one_is_taken_whatever_their_order() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    let copy = run(&b, 1);
    for (name, keep) in [
        (layout::RECORDS, 300),
        (layout::TEACHING, 0),
        (layout::CHECKPOINT, 200),
        (layout::OUTCOME, 5),
        (layout::MANIFEST, 50),
    ] {
        let good = fs::read(copy.join(name)).expect(name);
        fs::write(copy.join(name), &good[..keep]).expect("the test folder can be written");
        let said = merged_whole(folder.path(), [&a, &b], name);
        assert!(
            said.contains("left out, another source has this run whole") && said.contains(name),
            "{said}"
        );
        let alone = merge(&[&b], &folder.path().join("alone"));
        assert_eq!(alone.status.code(), Some(2), "{name}");
        assert!(stderr(&alone).contains("no source has them whole") && stderr(&alone).contains(name));
        fs::write(copy.join(name), good).expect("the test folder can be written");
    }
    // Its policy is lost, its results are not: it is taken where there is no other.
    fs::remove_file(copy.join(layout::CHECKPOINT)).expect("a checkpoint");
    assert_eq!(merged_whole(folder.path(), [&a, &b], "policy"), "");
    assert!(merge(&[&b], &folder.path().join("alone")).status.success());
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
    // Other seeds with another config: no run is there twice, but the cell has two configs.
    let more = folder.path().join("more");
    toy(&more, &["--seeds", "2,3", "--set", "student.batch=33"]);
    refused(&[&a, &more], &["Point/teach/default/seed-2: config differs", "/student/batch"]);

    // The same config and other records: one of the machines computes differently.
    for (name, from, to, said) in [
        (layout::RECORDS, "\"gradient_steps\":12", "\"gradient_steps\":13", "different records"),
        (layout::TEACHING, "\"successes\":[false", "\"successes\":[true", "different teaching.jsonl"),
    ] {
        let path = run(&b, 1).join(name);
        let good = fs::read_to_string(&path).expect(name);
        let altered = good.replace(from, to);
        assert_ne!(altered, good);
        fs::write(&path, altered).expect("the test folder can be written");
        seal(&run(&b, 1));
        refused(&[&a, &b], &["Point/teach/default/seed-1", said]);
        fs::write(&path, good).expect("the test folder can be written");
        seal(&run(&b, 1));
    }
    refused(&[&a, &folder.path().join("nowhere")], &["nowhere"]);
    assert!(merge(&[&a, &b], &out).status.success());
}

#[test]
fn what_a_killed_merge_left_is_removed_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    let place = |name: &str| folder.path().join(name);
    for name in [".goalbench-merge-0123456789ab", ".goalbench-merge-held56789abc"] {
        for folder in ["runs/Point", "protocols"] {
            fs::create_dir_all(place(name).join(folder)).expect("it can be created");
        }
    }
    let held = fs::File::create(place(".goalbench-merge-held56789abc/.lock")).expect("it can be created");
    held.lock().expect("it can be locked");
    for name in [".merge-AbCdEf/runs", ".goalbench-merge-notes", ".goalbench-merge-other6789abc/mine"] {
        fs::create_dir_all(place(name)).expect("it can be created");
    }
    assert!(merge(&[&a, &b], &place("all")).status.success());
    assert!(!place(".goalbench-merge-0123456789ab").exists());
    for kept in [
        ".goalbench-merge-held56789abc/runs/Point",
        ".merge-AbCdEf/runs",
        ".goalbench-merge-notes",
        ".goalbench-merge-other6789abc/mine",
    ] {
        assert!(place(kept).exists(), "{kept}");
    }
}

#[test]
fn an_existing_folder_is_not_merged_into() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    let output = merge(&[&a, &b], &a);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("exists already"), "{}", stderr(&output));
}

#[test]
fn no_folder_is_its_own_source_and_none_is_taken_twice() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = shares(folder.path());
    let link = folder.path().join("link");
    std::os::unix::fs::symlink(&a, &link).expect("it can be linked");
    let out = folder.path().join("all");
    for (sources, out, expected) in [
        ([&*a, &*b], a.join("all"), "is only read; name a place outside"),
        ([&*b, &*a], a.join("new/all"), "is only read; name a place outside"),
        ([&*b, &*a], link.join("all"), "is only read; name a place outside"),
        ([&*a, &*a], out.clone(), "is the same folder as"),
        ([&*a, &*link], out.clone(), "is the same folder as"),
    ] {
        let output = merge(&sources, &out);
        assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
        assert!(!out.exists() && !a.join("new").exists(), "nothing is written");
    }
}
