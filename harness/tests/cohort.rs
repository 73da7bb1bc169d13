//! Runs that one worker trains in lockstep record, to the byte, what each records alone.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use reports::store::{Results, layout};
use rustix::process::Signal;
use support::children::{results, signal, start, workers};
use support::{goalbench, stderr, stdout, write_protocol};

/// Twelve runs that keep step, of all kinds of teachers: three variants, of which one has runs of half the
/// length, one a shorter warm-up and another buffer; and two runs whose ensembles diverge.
const PROTOCOL: &str = "
name = 'lanes'
environments = ['Point']
curricula = ['teach', 'vds', 'space']
seeds = [0, 1]

budget = { steps = 1200 }
evaluation = { every = 200, episodes = 5 }
pool = { size = 20 }
student = { batch = 32, width = 16, updates_per_cycle = 4 }
curriculum = { vds = { candidates = 50 } }

[[variant]]
label = 'plain'

[[variant]]
label = 'short'
curricula = ['vds', 'space']
set = { budget = { steps = 500 }, student = { warmup_episodes = 5, her_k = 2, replay_capacity = 200 } }

[[variant]]
label = 'broken'
curricula = ['vds']
set = { curriculum = { vds = { learning_rate = 1e39 } } }
";

/// The arguments of the protocol at `protocol` into `out`.
fn args<'a>(protocol: &'a str, out: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
    ["run", protocol, "--out", out.to_str().expect("a test path is UTF-8")]
        .into_iter()
        .chain(more.iter().copied())
        .collect()
}

/// Runs it to its end, which two runs come to early.
fn run(protocol: &str, out: &Path, more: &[&str]) -> String {
    let output = goalbench(&args(protocol, out, more));
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("2 of 12 runs failed"), "{said}");
    said
}

fn assert_same(found: &BTreeMap<PathBuf, Vec<u8>>, expected: &BTreeMap<PathBuf, Vec<u8>>, how: &str) {
    assert_eq!(found.len(), expected.len(), "{how}");
    for (path, bytes) in found {
        assert!(bytes == &expected[path], "{how}: {}", path.display());
    }
}

#[test]
fn lanes_record_what_runs_alone_record() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let protocol = write_protocol(folder.path(), PROTOCOL);
    let alone = folder.path().join("alone");
    let said = run(&protocol, &alone, &["--jobs", "2"]);
    assert!(said.contains("12 runs, 12 to do, 2 at a time"), "{said}");
    let expected = results(&alone);
    assert_eq!(expected.len(), 48);
    let failed = expected.iter().filter(|(path, bytes)| {
        path.ends_with(layout::OUTCOME) && String::from_utf8_lossy(bytes).contains("diverged")
    });
    assert_eq!(failed.count(), 2);
    for (lanes, jobs, at_a_time) in [("12", "2", "12"), ("12", "1", "12"), ("5", "5", "5"), ("2", "4", "4")] {
        let together = folder.path().join(format!("{lanes}-{jobs}"));
        let said = run(&protocol, &together, &["--lanes", lanes, "--jobs", jobs]);
        assert!(said.contains(&format!("12 to do, {at_a_time} at a time")), "{said}");
        assert_same(&results(&together), &expected, &format!("--lanes {lanes} --jobs {jobs}"));
    }
}

/// As it says, for halves of one lane, of two and one, and of three and two; and with lanes that leave early.
#[test]
fn halves_that_take_turns_record_what_runs_alone_record() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let protocol = write_protocol(folder.path(), PROTOCOL);
    let alone = folder.path().join("alone");
    run(&protocol, &alone, &["--jobs", "2"]);
    let expected = results(&alone);
    for (lanes, jobs) in [("2", "2"), ("3", "2"), ("5", "1"), ("12", "3")] {
        let together = folder.path().join(format!("{lanes}-{jobs}"));
        run(&protocol, &together, &["--overlap", "--lanes", lanes, "--jobs", jobs]);
        assert_same(&results(&together), &expected, &format!("--overlap --lanes {lanes} --jobs {jobs}"));
    }
}

#[test]
fn turns_are_for_cohorts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for lanes in ["--lanes=auto", "--lanes=1"] {
        let out = folder.path().join("out");
        let args = support::toy_args(&out, &["--overlap", lanes]);
        support::refused(&args, &["--overlap", "every run goes alone", "--lanes 2 or more"]);
        assert!(!out.exists());
    }
    // A single run in a cohort that has room for more.
    let (halved, whole) = (folder.path().join("halved"), folder.path().join("whole"));
    support::toy(&halved, &["--overlap", "--lanes", "4", "--curriculum", "teach", "--seeds", "0"]);
    support::toy(&whole, &["--curriculum", "teach", "--seeds", "0"]);
    assert_same(&results(&halved), &results(&whole), "one lane of four");
}

/// Workers are killed, then sweeps, then one is stopped by a signal; each time the runs go on in other
/// cohorts or alone.
#[test]
fn killed_and_stopped_lanes_go_on_in_other_cohorts_and_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let protocol = write_protocol(folder.path(), PROTOCOL);
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    run(&protocol, &whole, &["--jobs", "2"]);
    let recorded = || -> u64 {
        let runs = Results::new(&broken).survey().map_or_else(|_| Vec::new(), |survey| survey.runs);
        let length = |path: PathBuf| fs::metadata(path).map_or(0, |file| file.len());
        runs.iter().map(|run| length(run.file(layout::RECORDS))).sum()
    };
    let halved = ["--overlap"].as_slice();
    for (round, (lanes, more)) in
        [("12", &[][..]), ("5", halved), ("1", &[]), ("12", halved), ("7", halved)].into_iter().enumerate()
    {
        let before = recorded();
        let more = [&["--lanes", lanes, "--jobs", "2"], more].concat();
        let mut sweep = start(&args(&protocol, &broken, &more));
        // Something is recorded, and a little more may be.
        while recorded() == before && sweep.try_wait().expect("it can be asked").is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_millis(40 * round as u64));
        match round {
            // The sweep starts another worker for the lanes of this one.
            0 => workers(sweep.id()).into_iter().for_each(|worker| signal(worker, Signal::KILL)),
            1 | 2 => signal(sweep.id(), Signal::KILL),
            _ => signal(sweep.id(), Signal::TERM),
        }
        if round == 0 {
            std::thread::sleep(Duration::from_millis(300));
            signal(sweep.id(), Signal::KILL);
        }
        sweep.wait().expect("it ends");
    }
    run(&protocol, &broken, &["--lanes", "8", "--jobs", "2"]);
    assert_same(&results(&broken), &results(&whole), "broken off and gone on");
}

#[test]
fn a_run_that_cannot_go_on_is_left_out_and_the_others_go_on() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    support::toy(folder.path(), &["--curriculum", "teach", "--seeds", "0,1"]);
    let run = |seed: u64| folder.path().join(format!("runs/Point/teach/default/seed-{seed}"));
    let expected = fs::read(run(1).join(layout::RECORDS)).expect("it recorded");
    for seed in [0, 1] {
        fs::remove_file(run(seed).join(layout::OUTCOME)).expect("it ended");
    }
    fs::write(run(0).join("checkpoint.bin"), "nonsense, and long").expect("it can be damaged");
    let [damaged, sound] = [0, 1].map(|seed| run(seed).to_str().expect("UTF-8").to_owned());
    let output = goalbench(&["worker", "--width", "2", "--", &damaged, &sound]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let told: Vec<serde_json::Value> =
        stdout(&output).lines().map(|line| serde_json::from_str(line).expect("an event")).collect();
    let last = |lane: u64| told.iter().rfind(|told| told["lane"] == lane).expect("told");
    assert_eq!((&last(0)["event"], &last(1)["event"]), (&"refused".into(), &"ended".into()), "{told:?}");
    assert!(!run(0).join(layout::OUTCOME).exists() && run(1).join(layout::OUTCOME).exists());
    assert_eq!(fs::read(run(1).join(layout::RECORDS)).expect("it recorded"), expected);
}

#[test]
fn lanes_that_are_no_number_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for wrong in ["0", "all", "-3"] {
        let lanes = format!("--lanes={wrong}");
        support::refused(
            &support::toy_args(folder.path(), &[&lanes]),
            &["--lanes", "auto", "from 1 to 1000"],
        );
    }
}

/// A Slurm that takes job arrays and keeps what it was told.
fn fake_slurm(folder: &Path) -> PathBuf {
    let bin = folder.join("bin");
    fs::create_dir(&bin).expect("it can be made");
    let program = bin.join("sbatch");
    fs::write(&program, "#!/bin/sh\necho \"$@\" >\"$(dirname \"$0\")/told\"\necho 17\n")
        .expect("it can be written");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("its mode can be set");
    bin
}

/// Four runs in tasks of up to three in lockstep.
#[test]
fn a_task_of_a_job_array_carries_out_a_cohort() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (bin, out) = (fake_slurm(folder.path()), folder.path().join("out"));
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").expect("UTF-8"));
    let submit = |more: &[&str]| {
        let more = [&["--executor", "slurm"], more].concat();
        let mut command = Command::new(env!("CARGO_BIN_EXE_goalbench"));
        command.args(support::toy_args(&out, &more)).env("PATH", &path).output().expect("the program starts")
    };
    let refusal = submit(&["--device", "cuda"]);
    assert_eq!(refusal.status.code(), Some(2));
    assert!(stderr(&refusal).contains("--lanes: give a number"), "{}", stderr(&refusal));
    assert!(!out.exists());
    let gpu = submit(&["--device", "cuda", "--lanes", "3"]);
    assert!(stdout(&gpu).contains("submitted job 17 with 2 tasks"), "{}", stderr(&gpu));
    let told = fs::read_to_string(bin.join("told")).expect("it was called");
    for option in ["--array=0-1", "--cpus-per-task=3", "--gres=gpu:1"] {
        assert!(told.contains(option), "{told}");
    }

    let out = folder.path().join("cpu");
    let args = support::toy_args(&out, &["--executor", "slurm", "--lanes", "3", "--overlap"]);
    let cpu = Command::new(env!("CARGO_BIN_EXE_goalbench")).args(&args).env("PATH", &path).output();
    let cpu = cpu.expect("the program starts");
    assert!(stdout(&cpu).contains("submitted job 17 with 2 tasks"), "{}", stderr(&cpu));
    let told = fs::read_to_string(bin.join("told")).expect("it was called");
    assert!(told.contains("--cpus-per-task=3") && !told.contains("--gres"), "{told}");
    let list = out.join("slurm/1/tasks.json");
    let tasks: serde_json::Value =
        serde_json::from_slice(&fs::read(&list).expect("it was written")).expect("JSON");
    assert_eq!((&tasks["lanes"], &tasks["overlap"]), (&3.into(), &true.into()));
    for task in ["0", "1"] {
        let output = goalbench(&["task", list.to_str().expect("UTF-8"), task]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let local = folder.path().join("local");
    support::toy(&local, &[]);
    assert_same(&results(&out), &results(&local), "tasks of three lanes");
}

/// The twelve runs in cohorts of five: prices, of which that of a GPU needs one.
#[test]
fn a_dry_run_prices_cohorts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let protocol = write_protocol(folder.path(), PROTOCOL);
    let out = folder.path().join("out");
    let price = |more: &[&str]| {
        let more =
            [&["--dry-run", "--jobs", "2", "--set", "curriculum.vds.learning_rate=0.001"], more].concat();
        let output = goalbench(&args(&protocol, &out, &more));
        assert!(output.status.success() && !out.exists(), "{}", stderr(&output));
        (stdout(&output), stderr(&output))
    };
    let lines = |text: &str, what: &str| text.lines().filter(|line| line.contains(what)).count();
    let (priced, _) = price(&["--lanes", "5"]);
    assert!(priced.contains("3 cohorts of up to 5 runs in lockstep, 1 at a time"), "{priced}");
    assert!(priced.contains(" with 1 side by side; longest cohort "), "{priced}");
    assert_eq!(lines(&priced, "core-hours"), 1, "{priced}");
    assert_eq!(
        lines(&priced, "GPU-hours") + lines(&priced, "on a GPU can only be measured on one"),
        1,
        "{priced}"
    );
    // The price on the cores is told whichever device the runs are for.
    let (on_gpu, _) = price(&["--device", "cuda"]);
    assert!(on_gpu.contains("core-hours") && on_gpu.contains("longest run"), "{on_gpu}");
    let (_, said) = price(&["--lanes", "50"]);
    assert!(said.contains("--lanes 50: there are only 12 runs to do"), "{said}");
    let mixed = ["--lanes", "12", "--env", "Point,MazeA", "--seeds", "0", "--steps", "40"];
    let (priced, said) = price(&mixed);
    assert!(said.contains("--lanes 12: no more than 6 of the 12 runs to do can share a cohort"), "{said}");
    assert!(priced.contains("2 cohorts of up to 12 runs"), "{priced}");
}

/// Threads are made for runs, not for a number that somebody typed.
#[test]
fn far_more_jobs_than_runs_change_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for lanes in ["1", "3"] {
        let args = ["--jobs", "65535", "--lanes", lanes, "--steps", "40"];
        let output = goalbench(&support::toy_args(&folder.path().join(lanes), &args));
        assert!(output.status.success(), "{}", stderr(&output));
    }
    assert_same(&results(&folder.path().join("3")), &results(&folder.path().join("1")), "--lanes 3");
}
