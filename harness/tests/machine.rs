//! Machines that run out of something: the sweep says what, keeps what it has, and goes on later to the same
//! bytes.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "says that it was skipped")]

mod support;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use reports::store::layout;
use support::{stderr, stdout, toy};

/// Runs `script` in a shell in which mounting is allowed, with `$goalbench` and `$dir` set; `None` where the
/// system forbids it.
fn with_mounts(dir: &Path, script: &str) -> Option<Output> {
    let shell = |script: &str| {
        let mut command = Command::new("unshare");
        command.args(["--map-root-user", "--mount", "sh", "-ec", script]);
        command.env("goalbench", env!("CARGO_BIN_EXE_goalbench")).env("dir", dir).output()
    };
    let allowed =
        shell("mount -t tmpfs -o size=1m none \"$dir\"").is_ok_and(|output| output.status.success());
    if !allowed {
        println!("skipped: no mounts are allowed here");
        return None;
    }
    Some(shell(script).expect("it started before"))
}

/// A run whose files come to more than the small disk below.
const RUN: &str = "run --env Point --curriculum teach --seeds 0 --steps 2000 --set evaluation.every=100 \
    --set evaluation.episodes=5 --set student.batch=32 --set student.width=64 --set student.updates_per_cycle=2 \
    --set pool.size=20";

#[test]
fn a_full_disk_fails_the_run_and_more_space_lets_it_end_with_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (disk, kept) = (folder.path().join("disk"), folder.path().join("kept"));
    fs::create_dir(&disk).expect("the test folder can be written");
    let script = format!(
        "mount -t tmpfs -o size=300k none \"$dir\"
         code=0; \"$goalbench\" {RUN} --out \"$dir/results\" || code=$?
         mount -o remount,size=30m \"$dir\"
         \"$goalbench\" {RUN} --out \"$dir/results\" >&2
         cp -r \"$dir/results\" \"$dir/../kept\"
         echo \"first: $code\""
    );
    let Some(output) = with_mounts(&disk, &script) else { return };
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    assert!(stdout(&output).contains("first: 1"), "the run failed: {said}");
    let reason = said.lines().find(|line| line.starts_with("goalbench: Point/teach/default/seed-0: crashed"));
    assert!(reason.is_some_and(|line| line.contains("No space left on device")), "{said}");

    let undisturbed = folder.path().join("undisturbed");
    let args: Vec<&str> = RUN.split_whitespace().skip(1).collect();
    toy(&undisturbed, &args);
    for name in [layout::RECORDS, layout::TEACHING, layout::OUTCOME] {
        let read = |results: &Path| {
            fs::read(results.join("runs/Point/teach/default/seed-0").join(name)).expect(name)
        };
        assert!(read(&kept) == read(&undisturbed), "{name}");
    }
}

#[test]
fn a_read_only_folder_is_named_and_left_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let script = format!(
        "mount -t tmpfs none \"$dir\"; mount -o remount,ro \"$dir\"
         code=0; \"$goalbench\" {RUN} --out \"$dir/results\" || code=$?
         echo \"code: $code\""
    );
    let Some(output) = with_mounts(folder.path(), &script) else { return };
    assert!(stdout(&output).contains("code: 2"), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(said.contains("cannot write in this folder: Read-only file system"), "{said}");
}

#[test]
fn a_run_that_needs_more_memory_than_there_is_fails_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let protocol = folder.path().join("protocol.toml");
    let text = "name = 'memory'\nenvironments = ['Point']\ncurricula = ['her-iid']\nseeds = [0]\n\
        budget.steps = 400\nevaluation.every = 400\nstudent.batch = 32\nstudent.updates_per_cycle = 1\n\
        [[variant]]\nlabel = 'large'\nset = { student.width = 4096, student.layers = 3 }\n\
        [[variant]]\nlabel = 'small'\nset = { student.width = 16 }\n";
    fs::write(&protocol, text).expect("the test folder can be written");
    // A worker's address space without its networks is about 0.7 GB; the large one's three stacks take 2 GB
    // more.
    let script =
        "ulimit -v 1500000; exec \"$goalbench\" run \"$dir/protocol.toml\" --out \"$dir/results\" --jobs 1";
    let output = Command::new("sh")
        .args(["-ec", script])
        .env("goalbench", env!("CARGO_BIN_EXE_goalbench"))
        .env("dir", folder.path())
        .output()
        .expect("a shell starts");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("1 of 2 runs failed"), "{said}");
    let run = |variant: &str| folder.path().join("results/runs/Point/her-iid").join(variant).join("seed-0");
    assert!(run("small").join(layout::OUTCOME).exists(), "{said}");
    assert!(!run("large").join(layout::OUTCOME).exists(), "it may go better on another machine");
    let crashes = fs::read_to_string(run("large").join(layout::CRASHES)).expect("crashes are noted");
    assert_eq!(crashes.lines().count(), 3, "it was tried again twice: {crashes}");
    assert!(crashes.contains("can't allocate memory"), "{crashes}");
    let log =
        fs::read_to_string(run("large").join(layout::WORKER_LOG)).expect("what the workers said is kept");
    assert_eq!(log.matches("can't allocate memory").count(), 3, "of every attempt: {log}");
}
