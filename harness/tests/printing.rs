//! What is printed arrives, or the exit code says that it did not.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs::File;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use support::{goalbench, stderr, stdout, toy, toy_args};

/// Runs goalbench with standard output on a full disk.
fn on_a_full_disk(args: &[&str]) -> Output {
    let full = File::options().write(true).open("/dev/full").expect("Linux has it");
    Command::new(env!("CARGO_BIN_EXE_goalbench"))
        .args(args)
        .stdout(full)
        .stderr(Stdio::piped())
        .output()
        .expect("the program starts")
}

/// Command lines that succeed and print, by subcommand. `DIR` holds the toy runs in `toy`, a baseline of them
/// in `base.json`, and whatever they write.
const COMMANDS: &[&[&str]] = &[
    &["--help"],
    &["--version"],
    &["help", "run"],
    &["list"],
    &["list", "config"],
    &["list", "presets", "--json"],
    &["run", "--help"],
    &["run", "TOY", "--dry-run"],
    &["run", "TOY", "--json"],
    &["run", "TOY"],
    &["status", "DIR/toy"],
    &["status", "DIR/toy", "--json"],
    &["merge", "DIR/toy", "--out", "DIR/merged-N"],
    &["report", "DIR/toy"],
    &["pack", "DIR/toy", "--out", "DIR/pack-N.tar.zst"],
    &["unpack", "DIR/pack-1.tar.zst", "--out", "DIR/unpacked-N"],
    &["export", "DIR/toy/runs/Point/teach/default/seed-0", "--out", "DIR/policy-N"],
    &["completions", "bash"],
    &["man", "DIR/man-N"],
    &["evaluate", "DIR/toy", "--episodes", "2"],
    &["evaluate", "DIR/toy", "--episodes", "2", "--json"],
    &["render", "--env", "Point", "--episodes", "1", "--size", "16", "--out", "DIR/N.gif"],
    &["verify", "DIR/traces"],
    &["verify", "DIR/traces", "--json"],
    &["regress", "record", "DIR/gate.toml", "--results", "DIR/gate", "--out", "DIR/N.json"],
    &[
        "regress",
        "check",
        "--baseline",
        "DIR/base.json",
        "--results",
        "DIR/gate",
        "--exact",
        "--out",
        "DIR/check-N",
    ],
    &["profile", "--env", "Point", "--curriculum", "her-iid", "--cycles", "1", "--json"],
    &["protocol", "show", "quickstart"],
    &[
        "quickstart",
        "--out",
        "DIR/quick-N",
        "--env",
        "MazeA",
        "--steps",
        "100",
        "--set",
        "evaluation.episodes=1",
    ],
];

const GATE: &str = "name = 'gate'\nenvironments = ['Point']\ncurricula = ['her-iid']\nseeds = [0, 1]\nbudget.steps = 80\n\
    evaluation.every = 40\nevaluation.episodes = 2\nstudent.batch = 16\nstudent.width = 8\nstudent.updates_per_cycle = 1\n\
    pool.size = 5\n";

/// `command` with the places filled in. Two uses of one command do not write to the same place.
fn filled(command: &[&str], dir: &str, use_: usize) -> Vec<String> {
    let toy: Vec<String> =
        toy_args(&Path::new(dir).join("toy"), &[]).iter().map(|&arg| arg.to_owned()).collect();
    let fill = |arg: &&str| match *arg {
        "TOY" => toy[1..].to_vec(),
        arg => vec![
            arg.replace("DIR", dir).replace("-N", &format!("-{use_}")).replace("/N.", &format!("/{use_}.")),
        ],
    };
    command.iter().flat_map(fill).collect()
}

/// The names of all subcommands, as the help lists them.
fn subcommands() -> Vec<String> {
    let help = stdout(&goalbench(&["--help"]));
    let (_, rest) = help.split_once("Commands:\n").expect("a list of commands");
    let list = rest.lines().take_while(|line| line.starts_with("  "));
    // What is indented further goes on from the line before.
    let names = list.filter_map(|line| line.strip_prefix("  ").filter(|rest| !rest.starts_with(' ')));
    names.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

#[test]
fn a_full_disk_behind_standard_output_is_a_failure_of_every_command() {
    for name in subcommands() {
        assert!(COMMANDS.iter().any(|command| command[0] == name), "{name} is not tried");
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let dir = folder.path().to_str().expect("UTF-8");
    toy(&folder.path().join("toy"), &[]);
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../envs/tests/golden/MazeA.json.gz");
    std::fs::create_dir(folder.path().join("traces")).expect("the test folder can be written");
    std::fs::copy(golden, folder.path().join("traces/MazeA.json.gz"))
        .expect("the test folder can be written");
    std::fs::write(folder.path().join("gate.toml"), GATE).expect("the test folder can be written");
    let (gate, protocol) = (format!("{dir}/gate"), format!("{dir}/gate.toml"));
    assert!(goalbench(&["run", &protocol, "--out", &gate]).status.success());
    let base = format!("{dir}/base.json");
    let recorded = goalbench(&["regress", "record", &protocol, "--results", &gate, "--out", &base]);
    assert!(recorded.status.success(), "{}", stderr(&recorded));

    for command in COMMANDS {
        let args = filled(command, dir, 1);
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let heard = goalbench(&args);
        assert!(heard.status.success() && !heard.stdout.is_empty(), "{args:?}: {}", stderr(&heard));

        let args = filled(command, dir, 2);
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let lost = on_a_full_disk(&args);
        let said = stderr(&lost);
        assert_eq!(lost.status.code(), Some(1), "{args:?}: {said}");
        assert_eq!(
            said.matches("cannot write to standard output: No space left").count(),
            1,
            "{args:?}: {said}"
        );
    }
}

#[test]
fn progress_that_cannot_be_written_is_a_failure_and_the_runs_are_kept() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let full = File::options().write(true).open("/dev/full").expect("Linux has it");
    let status = Command::new(env!("CARGO_BIN_EXE_goalbench"))
        .args(toy_args(folder.path(), &["--seeds", "0"]))
        .stdout(Stdio::null())
        .stderr(full)
        .status()
        .expect("the program starts");
    assert_eq!(status.code(), Some(1));
    let told = stdout(&goalbench(&["status", folder.path().to_str().expect("UTF-8")]));
    assert!(told.contains("2 runs: 2 finished"), "{told}");
}

#[test]
fn a_reader_that_went_away_is_no_error() {
    for args in [vec!["list"], vec!["list", "config"], vec!["--help"], vec!["protocol", "show", "paper"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_goalbench"))
            .args(&args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        // If it was faster than this test, nobody had gone yet; either way it has succeeded.
        assert!(output.status.success() && output.stderr.is_empty(), "{args:?}: {}", stderr(&output));
    }
}
