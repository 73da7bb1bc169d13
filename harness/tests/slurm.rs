//! The Slurm executor on a real Slurm: `ci/local-slurm start DIR` starts one on this machine.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "says that it was skipped")]

mod support;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use reports::store::layout;
use support::{goalbench, stderr, stdout, toy, toy_args};

/// Long enough to be killed in.
const LONGER: [&str; 6] =
    ["--steps", "4000", "--set", "evaluation.every=200", "--set", "student.updates_per_cycle=12"];

const RUNS: [&str; 4] =
    ["teach/default/seed-0", "teach/default/seed-1", "her-iid/default/seed-0", "her-iid/default/seed-1"];

fn wait(what: &str, mut done: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !done() {
        assert!(begun.elapsed() < Duration::from_secs(300), "waited five minutes for {what}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn submit(out: &Path) -> String {
    let more = ["--executor", "slurm", "--chunk", "2", "--time", "10:00"];
    let output = goalbench(&toy_args(out, &[&LONGER[..], &more].concat()));
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    said.strip_prefix("submitted job ").and_then(|rest| rest.split(' ').next()).expect("a job id").to_owned()
}

fn queue_is_empty() -> bool {
    let output = Command::new("squeue").arg("--noheader").output().expect("squeue runs");
    output.status.success() && output.stdout.trim_ascii().is_empty()
}

/// Runs of `results` that have not ended.
fn unfinished(results: &Path) -> usize {
    let ended = |run: &str| results.join("runs/Point").join(run).join(layout::OUTCOME).exists();
    RUNS.iter().filter(|run| !ended(run)).count()
}

#[test]
fn a_cancelled_and_resubmitted_array_ends_with_the_bytes_of_a_local_run() {
    if std::env::var_os("GOALBENCH_TEST_SLURM").is_none() {
        println!("skipped: set GOALBENCH_TEST_SLURM where a Slurm runs");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let local = folder.path().join("local");
    toy(&local, &LONGER);
    // A name that a shell or Slurm could take for something else.
    let cluster = folder.path().join("it's a $HOME; %a");

    let job = submit(&cluster);
    let first = cluster.join("runs/Point/teach/default/seed-0/checkpoint.bin");
    wait("a checkpoint", || first.exists());
    assert!(Command::new("scancel").args(["--full", &job]).status().expect("scancel runs").success());
    wait("the cancelled job", queue_is_empty);
    assert!(unfinished(&cluster) > 0, "it was cancelled half-way");

    // A second time half-way: a task's process dies without warning, as on a node that goes down, and Slurm
    // requeues the task.
    let records = cluster.join("runs/Point/teach/default/seed-0").join(layout::RECORDS);
    let length = |path: &Path| fs::metadata(path).map_or(0, |file| file.len());
    let before = length(&records);
    let job = submit(&cluster);
    let twice = goalbench(&toy_args(&cluster, &[&LONGER[..], &["--executor", "slurm"]].concat()));
    assert_eq!(twice.status.code(), Some(2));
    assert!(stderr(&twice).contains("still in the queue"), "{}", stderr(&twice));
    wait("progress", || length(&records) > before || unfinished(&cluster) == 0);
    let control = |args: &[&str]| Command::new("scontrol").args(args).output().expect("scontrol runs");
    let task = format!("{job}_0");
    let requeued = control(&["requeue", &task]);
    assert!(requeued.status.success() || unfinished(&cluster) == 0, "{}", stderr(&requeued));
    wait("the second job", || {
        // Slurm lets a requeued task wait for two minutes unless it is told not to.
        control(&["update", &format!("JobId={task}"), "StartTime=now"]);
        std::thread::sleep(Duration::from_millis(300));
        queue_is_empty() && unfinished(&cluster) == 0
    });
    for run in RUNS {
        for name in [layout::RECORDS, layout::TEACHING, layout::OUTCOME] {
            let read =
                |results: &Path| fs::read(results.join("runs/Point").join(run).join(name)).expect(name);
            assert!(read(&local) == read(&cluster), "{run}/{name}");
        }
    }
    let again = goalbench(&toy_args(&cluster, &[&LONGER[..], &["--executor", "slurm"]].concat()));
    assert!(stdout(&again).contains("nothing to submit"), "{}", stderr(&again));
}
