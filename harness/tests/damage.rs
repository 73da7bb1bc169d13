//! Files that are not what they were: named, left alone, and nothing built upon them.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use reports::store::{RunFolder, layout};
use rustix::process::{Pid, Signal, kill_process};
use support::{goalbench, seal, stderr, stdout, toy, toy_args};

fn run(results: &Path) -> PathBuf {
    results.join("runs/Point/teach/default/seed-0")
}

fn finished() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0"]);
    folder
}

/// The same command once more must refuse and say each of `expected`; so must a merge; status goes on and
/// says it, too. Report and evaluation go on with the other run, name the file and fail.
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
    assert_eq!(goalbench(&["status", "--strict", &text(results)]).status.code(), Some(1));
    for args in [&["report", &text(results)][..], &["evaluate", "--episodes", "2", &text(results)]] {
        let output = goalbench(args);
        assert_eq!(output.status.code(), Some(1), "{args:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(expected[0]), "{args:?}: {}", stderr(&output));
    }
}

#[test]
fn what_a_finished_run_recorded_that_was_altered_cut_off_emptied_or_lost() {
    let folder = finished();
    for (name, from, to) in [
        (layout::RECORDS, "\"success_rate\":0.0", "\"success_rate\":1.0"),
        (layout::TEACHING, "\"successes\":[false", "\"successes\":[true"),
    ] {
        let path = run(folder.path()).join(name);
        let good = fs::read_to_string(&path).expect(name);
        let altered = good.replacen(from, to, 1);
        assert_ne!(altered, good);
        let line_less: String = good.split_inclusive('\n').take(4).collect();
        assert!(line_less.len() < good.len());
        for bad in [altered.as_str(), &good[..300], &line_less, ""] {
            fs::write(&path, bad).expect("the test folder can be written");
            noticed(folder.path(), &[name, "cut off or altered after the run ended"]);
            assert_eq!(fs::read_to_string(&path).expect(name), bad, "it is left alone");
        }
        fs::remove_file(&path).expect(name);
        noticed(folder.path(), &[name, "No such file"]);
        fs::write(&path, good).expect("the test folder can be written");
    }
}

#[test]
fn a_manifest_that_was_edited_or_is_missing() {
    let folder = finished();
    let path = run(folder.path()).join(layout::MANIFEST);
    let good = fs::read_to_string(&path).expect("a manifest");
    let edited = good.replace("\"batch\": 32", "\"batch\": 1024");
    assert_ne!(edited, good);
    let text = folder.path().to_str().expect("a test path is UTF-8");
    let out = folder.path().with_extension("merged");
    let out = out.to_str().expect("a test path is UTF-8");
    for (bad, reason) in [(Some(edited.as_str()), "hash does not fit its config"), (None, "manifest")] {
        match bad {
            Some(bad) => fs::write(&path, bad).expect("the test folder can be written"),
            None => fs::remove_file(&path).expect("a manifest"),
        }
        let commands: [(&[&str], i32); 5] = [
            (&["status", text], 0),
            (&["status", "--strict", text], 1),
            (&["report", text], 1),
            (&["evaluate", "--episodes", "2", text], 1),
            (&["merge", text, "--out", out], 2),
        ];
        for (args, code) in commands {
            let output = goalbench(args);
            let said = stdout(&output) + &stderr(&output);
            assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
            assert!(said.contains("Point/teach/default/seed-0") && said.contains(reason), "{args:?}: {said}");
        }
        let again = goalbench(&toy_args(folder.path(), &["--seeds", "0"]));
        assert_eq!(again.status.code(), Some(2));
        assert!(!Path::new(out).exists(), "nothing is written");
    }
}

/// Two runs that were stopped, each with a checkpoint and a replay log.
fn stopped() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = toy_args(folder.path(), &["--seeds", "0", "--jobs", "2", "--steps", "1000000"]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_goalbench"));
    let mut sweep = command.args(args).stderr(Stdio::null()).spawn().expect("the program starts");
    let begun = Instant::now();
    let recorded = |curriculum: &str| {
        let place = format!("runs/Point/{curriculum}/default/seed-0/{}", layout::RECORDS);
        fs::read_to_string(folder.path().join(place)).unwrap_or_default().lines().count()
    };
    while recorded("teach").min(recorded("her-iid")) < 6 {
        assert!(begun.elapsed() < Duration::from_secs(60), "no evaluation within a minute");
        std::thread::sleep(Duration::from_millis(10));
    }
    let pid = i32::try_from(sweep.id()).ok().and_then(Pid::from_raw).expect("a process id");
    kill_process(pid, Signal::TERM).expect("it can be stopped");
    assert_eq!(sweep.wait().expect("it ends").code(), Some(3));
    folder
}

#[test]
fn damage_of_an_unfinished_run_is_seen_before_it_goes_on() {
    let folder = stopped();
    let text = folder.path().to_str().expect("a test path is UTF-8");
    let home = tempfile::tempdir().expect("a temporary folder");
    let out = home.path().join("merged");
    let out = out.to_str().expect("a test path is UTF-8");
    let sound = goalbench(&["status", "--strict", text]);
    assert!(sound.status.success() && stdout(&sound).contains("2 stopped"), "{}", stdout(&sound));
    let segment = "replay/episodes-0.bin";
    for (name, keep) in [
        (layout::CHECKPOINT, Some(100)),
        (layout::CHECKPOINT, None),
        (layout::RECORDS, Some(300)),
        (layout::TEACHING, Some(0)),
        (layout::TEACHING, None),
        (layout::STUDENT, Some(0)),
        (layout::STUDENT, None),
        (segment, Some(0)),
        (segment, Some(1000)),
        (segment, None),
    ] {
        let path = run(folder.path()).join(name);
        let good = fs::read(&path).expect(name);
        match keep {
            Some(bytes) => fs::write(&path, &good[..bytes]).expect("the test folder can be written"),
            None => fs::remove_file(&path).expect(name),
        }
        let (status, merged) =
            (goalbench(&["status", "--strict", text]), goalbench(&["merge", text, "--out", out]));
        assert_eq!((status.status.code(), merged.status.code()), (Some(1), Some(2)), "{name}");
        let report = goalbench(&["report", text]);
        assert_eq!(report.status.code(), Some(1), "{name}");
        for said in [stdout(&status), stderr(&merged), stderr(&report)] {
            assert!(said.contains(name), "expected {name} in {said}");
        }
        assert!(stdout(&status).contains("1 damaged") && !Path::new(out).exists());
        fs::write(&path, good).expect("the test folder can be written");
    }
    assert!(goalbench(&["merge", text, "--out", out]).status.success(), "it was put right again");
}

#[test]
fn absurd_timings_are_numbers_like_any_other() {
    let folder = stopped();
    let text = folder.path().to_str().expect("a test path is UTF-8");
    let path = run(folder.path()).join(layout::TIMING);
    // What came after the checkpoint is nobody's yet.
    let sound = fs::read_to_string(&path).expect("timings");
    for wall_s in ["1e300", "1e19", "5e-324"] {
        let line = format!("{{\"eval_index\":999,\"step\":100,\"wall_s\":{wall_s},\"evaluation_s\":0.0}}\n");
        fs::write(&path, format!("{sound}{line}")).expect("it can be written");
        let status = goalbench(&["status", text]);
        assert!(status.status.success() && stdout(&status).contains("2 stopped"), "{}", stderr(&status));
        let report = goalbench(&["report", text]);
        assert!(report.status.code().is_some_and(|code| code < 2), "{wall_s}: {}", stderr(&report));
    }
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
fn an_outcome_that_was_edited() {
    let folder = finished();
    let path = run(folder.path()).join(layout::OUTCOME);
    for bad in [
        r#"{"status":"finished","step":0}"#,
        r#"{"status":"finished","step":18446744073709551615}"#,
        r#"{"status":"failed","step":400,"reason":"bad luck"}"#,
    ] {
        fs::write(&path, bad).expect("it can be written");
        noticed(folder.path(), &["outcome.json", "cut off or altered after the run ended"]);
    }
    fs::write(&path, r#"{"status":"finished","step":360}"#).expect("it can be written");
    seal(&run(folder.path()));
    noticed(folder.path(), &["outcome.json", "finished at step 360, but the last evaluation is at step 400"]);
}

#[test]
fn forged_records_whose_checksums_fit() {
    let folder = finished();
    let path = run(folder.path()).join(layout::RECORDS);
    let good = fs::read_to_string(&path).expect("records");
    for (from, to, expected) in [
        ("\"episodes\":5", "\"episodes\":18446744073709551615", "expected as many as the config says"),
        ("\"mean_return\":-20.0", "\"mean_return\":-1.7e308", "at least -1 for every step of an episode"),
        ("\"gradient_steps\":40", "\"gradient_steps\":18446744073709551615", "updates per cycle"),
        ("\"step\":400", "\"step\":18446744073709551615", "expected a step within the budget"),
        ("\"eval_index\":2", "\"eval_index\":9", "evaluation 2 is missing"),
    ] {
        let forged = good.replacen(from, to, 1);
        assert_ne!(forged, good);
        fs::write(&path, forged).expect("it can be written");
        seal(&run(folder.path()));
        noticed(folder.path(), &["records.jsonl", expected]);
    }
}

#[test]
fn an_outcome_that_was_not_written_or_was_lost_is_written_again() {
    let folder = finished();
    let place = run(folder.path());
    let files = [layout::RECORDS, layout::TIMING, layout::CHECKSUMS, layout::OUTCOME];
    let read = || files.map(|name| fs::read(place.join(name)).expect(name));
    let before = read();
    let text = folder.path().to_str().expect("a test path is UTF-8");
    // As a kill leaves it; then without the replay buffer, which --discard-replay removes.
    for lost in [&[layout::OUTCOME][..], &[layout::OUTCOME, layout::REPLAY]] {
        for path in lost.iter().map(|name| place.join(name)) {
            if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }
                .expect("it was there");
        }
        let status = goalbench(&["status", "--strict", text]);
        assert!(status.status.success() && stdout(&status).contains("1 stopped"), "{}", stdout(&status));
        toy(folder.path(), &["--seeds", "0"]);
        assert!(read() == before && !place.join(layout::CRASHES).exists(), "{lost:?}");
    }
    // Whose records are not those of its checkpoint is named, and no worker tries twice.
    fs::remove_file(place.join(layout::OUTCOME)).expect("an outcome");
    fs::write(place.join(layout::RECORDS), "").expect("it can be written");
    let again = goalbench(&toy_args(folder.path(), &["--seeds", "0"]));
    assert_eq!(again.status.code(), Some(1));
    for said in [stderr(&again), stdout(&goalbench(&["status", text]))] {
        assert!(said.contains("records.jsonl was cut") || said.contains("records.jsonl: was cut"), "{said}");
    }
    assert_eq!(RunFolder::new(place).crashes().expect("sound lines").len(), 1);
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
        stderr(&again).contains("checkpoint.bin: is missing, though records of 5 evaluations exist"),
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
    let priced = with(&["--retry-failed", "--dry-run"]);
    let said = String::from_utf8_lossy(&priced.stdout);
    assert!(said.contains("; 2 runs (800 steps) still to do"), "what would go on: {said}");
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
