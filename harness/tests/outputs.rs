//! Where results go: places are checked before work begins, folders are named after what lies in them, and a
//! refused command leaves nothing.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

use reports::store::layout;
use support::{TOY, goalbench, stderr, stdout, toy, toy_args};

/// Runs goalbench in the working folder `folder`.
fn within(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_goalbench"));
    command.args(args).current_dir(folder).output().expect("the program starts")
}

fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let name = |entry: std::io::Result<fs::DirEntry>| entry.expect("it can be read").file_name();
    let mut names: Vec<String> = entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Runs `args` in `folder`, which must be refused with `parts` in the message, and leave nothing new.
fn refused(folder: &Path, args: &[&str], parts: &[&str]) {
    let before = names(folder);
    let output = within(folder, args);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {}{}", stderr(&output), stdout(&output));
    for part in parts {
        assert!(stderr(&output).contains(part), "{args:?}: expected {part:?} in {}", stderr(&output));
    }
    assert_eq!(names(folder), before, "{args:?} leaves nothing");
}

const PROTOCOL: &str = "environments = ['Point']\ncurricula = ['teach']\nseeds = [0]\n[budget]\nsteps = 400\n\
                        [evaluation]\nevery = 100\nepisodes = 5\n[student]\nbatch = 32\nwidth = 16\nupdates_per_cycle = 4\n\
                        [pool]\nsize = 20\n";

#[test]
fn every_place_to_write_to_is_checked_before_anything_is_trained() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    fs::write(here.join("p.toml"), format!("name = 'p'\n{PROTOCOL}")).expect("it can be written");
    fs::create_dir(here.join("there")).expect("it can be made");
    let run = |out: &'static str| [TOY, &["--out", out]].concat();
    refused(here, &run("p.toml"), &["--out", "p.toml is no folder"]);
    refused(here, &run("p.toml/x"), &["--out", "p.toml is no folder"]);
    refused(here, &run("/proc/x"), &["--out", "/proc: cannot write in this folder"]);
    refused(here, &run(""), &["--out"]);
    refused(here, &["run", "p.toml", "--out", "p.toml"], &["--out", "p.toml"]);
    let record = |out: &'static str| ["regress", "record", "--protocol", "p.toml", "--out", out];
    refused(here, &record("p.toml"), &["--out: p.toml is read by this command and would be overwritten"]);
    refused(here, &record("there"), &["--out: there is a folder"]);
    refused(here, &record("p.toml/x.json"), &["p.toml is no folder"]);
    refused(here, &record("/proc/x.json"), &["/proc: cannot write in this folder"]);
    refused(
        here,
        &[&record("x.json")[..], &["--keep", "p.toml/x"]].concat(),
        &["--keep", "p.toml is no folder"],
    );
    // A folder that is missing is made, at the end.
    let recorded = within(here, &[&record("made/for/it/x.json")[..], &["--seeds", "0..4"]].concat());
    assert!(recorded.status.success(), "{}", stderr(&recorded));
    let check = ["regress", "check", "--exact", "--baseline", "made/for/it/x.json", "--out"];
    refused(here, &[&check[..], &["p.toml"]].concat(), &["--out", "p.toml is no folder"]);
    refused(here, &[&check[..], &["made/for/it/x.json"]].concat(), &["would be overwritten"]);
    refused(here, &[&check[..], &["/proc/x"]].concat(), &["/proc: cannot write in this folder"]);
    let render = ["render", "--env", "Point"];
    refused(here, &[&render[..], &["--out", "there"]].concat(), &["--out: there is a folder"]);
    refused(here, &[&render[..], &["--frames", "p.toml"]].concat(), &["--frames", "p.toml is no folder"]);
    toy(&here.join("results"), &["--seeds", "0", "--curriculum", "teach"]);
    refused(here, &["merge", "results", "--out", "p.toml/x"], &["--out", "p.toml is no folder"]);
    fs::write(here.join("results/report"), "").expect("it can be written");
    refused(here, &["report", "results"], &["results/report is no folder"]);
}

#[test]
fn names_in_any_script_have_folders_of_their_own() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    for name in ["実験", "опыт", "été 2"] {
        fs::write(here.join("p.toml"), format!("name = '{name}'\n{PROTOCOL}")).expect("it can be written");
        let output = within(here, &["run", "p.toml"]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    assert_eq!(names(&here.join("results")), ["été 2", "опыт", "実験"]);
    for bad in ["a/b", "../x", ".x", "-x", " x", "a\\u0000b", "a\\u202eb", ""] {
        fs::write(here.join("p.toml"), format!("name = \"{bad}\"\n{PROTOCOL}")).expect("it can be written");
        refused(here, &["run", "p.toml"], &["p.toml:1", "cannot be a name"]);
    }
}

#[test]
fn commands_have_folders_named_after_what_they_ask_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    let one = [TOY, &["--curriculum", "teach", "--seeds", "0"]].concat();
    for more in [&[][..], &["--set", "student.her_k=0"], &["--steps", "300"]] {
        for _ in 0..2 {
            let output = within(here, &[&one[..], more].concat());
            assert!(output.status.success(), "{}", stderr(&output));
        }
    }
    let found = names(&here.join("results"));
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found.iter().all(|name| name.starts_with("Point_her-iid+teach_budget.steps=")), "{found:?}");
    assert!(found.iter().any(|name| name.contains("student.her_k=0")), "{found:?}");
}

#[test]
fn a_path_like_an_option_is_a_path() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output =
        within(folder.path(), &[TOY, &["--curriculum", "teach", "--seeds", "0", "--out=-x"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(folder.path().join("-x/runs/Point/teach/default/seed-0").join(layout::OUTCOME).exists());
    assert!(stdout(&output).contains("goalbench report ./-x"), "{}", stdout(&output));
}

#[test]
fn what_cannot_begin_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    let with = |more: &[&'static str]| [TOY, &["--out", "out"], more].concat();
    refused(
        here,
        &with(&["--set", "student.agent=sac"]),
        &["student.agent", "unknown agent `sac`", "ddpg-her"],
    );
    refused(
        here,
        &with(&["--set", "student.width=16384", "--set", "student.layers=8"]),
        &["student.width", "weights"],
    );
    refused(
        here,
        &with(&["--set", "student.batch=1000000", "--set", "student.width=1024"]),
        &["student.batch"],
    );
    refused(
        here,
        &with(&["--set", "student.episodes_per_cycle=922337203685477581"]),
        &["student.episodes_per_cycle: 922337203685477581 given"],
    );
    refused(here, &with(&["--set", "student.episodes_per_cycle=1000000"]), &["evaluation.every"]);
    let updates = ["--set", "curriculum.vds.updates_per_cycle=9223372036854775807"];
    refused(here, &with(&updates), &["curriculum.vds.updates_per_cycle", "1000000"]);
    let ranges =
        "0..10000,10000..20000,20000..30000,30000..40000,40000..50000,50000..60000,60000..70000,70000..80000";
    refused(here, &with(&["--seeds", ranges]), &["--seeds", "at most 10000 are accepted"]);
    refused(here, &with(&["--env", "Point,MazeA", "--seeds", "0..10000"]), &["more than 20000 runs"]);
    assert!(!here.join("out").exists());
    // The corrected command is not blocked.
    toy(&here.join("out"), &["--seeds", "0"]);
}

#[test]
fn job_arrays_are_refused_where_there_is_no_slurm_and_where_no_script_can_name_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    let bin = here.join("bin");
    fs::create_dir(&bin).expect("it can be made");
    let slurm = |out: &OsStr, path: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_goalbench"));
        command.args(TOY).args(["--executor", "slurm", "--out"]).arg(out).current_dir(here).env("PATH", path);
        let output = command.output().expect("the program starts");
        assert_eq!(output.status.code(), Some(2), "{}{}", stderr(&output), stdout(&output));
        assert_eq!(names(here), ["bin"], "nothing is left: {}", stderr(&output));
        stderr(&output)
    };
    assert!(slurm(OsStr::new("out"), &bin).contains("no such program on this machine's PATH"));
    let sbatch = |text: &str| {
        fs::write(bin.join("sbatch"), format!("#!/bin/sh\n{text}\n")).expect("it can be written");
        fs::set_permissions(bin.join("sbatch"), fs::Permissions::from_mode(0o755))
            .expect("its mode can be set");
    };
    sbatch("exit 0");
    assert!(slurm(OsStr::from_bytes(b"out\xff"), &bin).contains("cannot stand in the script"));
    // A program that prints no id has submitted nothing, and one that fails neither.
    assert!(slurm(OsStr::new("out"), &bin).contains("the id of a job was expected"));
    sbatch("echo Submitted");
    assert!(slurm(OsStr::new("out"), &bin).contains("printed `Submitted`"));
    sbatch("echo invalid partition >&2; exit 1");
    assert!(slurm(OsStr::new("out"), &bin).contains("sbatch: invalid partition"));
    sbatch("echo 17");
    let output = Command::new(env!("CARGO_BIN_EXE_goalbench"))
        .args(TOY)
        .args(["--executor", "slurm", "--out", "out"])
        .current_dir(here)
        .env("PATH", &bin)
        .output()
        .expect("the program starts");
    assert!(stdout(&output).contains("submitted job 17"), "{}", stderr(&output));
}

#[test]
fn a_run_that_cannot_go_on_is_left_without_new_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0", "--curriculum", "teach"]);
    let run = folder.path().join("runs/Point/teach/default/seed-0");
    // As if it had been stopped before its end, and then lost a file.
    for name in [layout::OUTCOME, layout::CHECKSUMS, layout::TEACHING] {
        fs::remove_file(run.join(name)).expect("it is there");
    }
    let records = fs::read(run.join(layout::RECORDS)).expect("records");
    let output = goalbench(&toy_args(folder.path(), &["--seeds", "0", "--curriculum", "teach"]));
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("teaching.jsonl is missing"), "{}", stderr(&output));
    assert!(!run.join(layout::TEACHING).exists(), "no empty file takes its place");
    assert_eq!(fs::read(run.join(layout::RECORDS)).expect("records"), records);
}

#[test]
fn without_proc_the_program_says_what_it_needs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let unshared = |command: &str| {
        let mut unshare = Command::new("unshare");
        unshare.args(["--mount", "--map-root-user", "sh", "-c", command, env!("CARGO_BIN_EXE_goalbench")]);
        unshare.args(TOY).args(["--out", "out"]).current_dir(folder.path()).output()
    };
    let hidden = "mount -t tmpfs none /proc";
    if !unshared(hidden).is_ok_and(|output| output.status.success()) {
        return;
    }
    let output = unshared(&format!("{hidden} && exec \"$0\" \"$@\"")).expect("it ran a moment ago");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    for part in ["/proc/self/exe", "needs /proc to be mounted"] {
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

/// Everything in the folder, by path, with the bytes of files.
fn tree(folder: &Path) -> Vec<(std::path::PathBuf, Option<Vec<u8>>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            found.push((entry.clone(), fs::read(&entry).ok()));
            if entry.is_dir() {
                folders.push(entry);
            }
        }
    }
    found.sort();
    found
}

/// Results that are read, or lie in the way, stay as they are, whatever command is given.
#[test]
fn nothing_is_written_among_the_runs_of_results() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    fs::write(here.join("p.toml"), format!("name = 'p'\n{PROTOCOL}")).expect("it can be written");
    assert!(within(here, &["run", "p.toml", "--out", "base", "--quiet"]).status.success());
    assert!(within(here, &["pack", "base", "--out", "base.tar.zst"]).status.success());
    let before = tree(&here.join("base"));
    let (runs, run) = ("base/runs", "base/runs/Point/teach/default/seed-0");
    let records = format!("{run}/records.jsonl");
    let new = format!("{runs}/Point/teach/x");
    let record = ["regress", "record", "p.toml", "--results", "base"];
    for args in [
        &[&record[..], &["--out", &records]].concat()[..],
        &[&record[..], &["--out", &new]].concat(),
        &["run", "p.toml", "--out", &new],
        &["unpack", "base.tar.zst", "--out", &new],
        &["merge", "base", "--out", &new],
        &["man", runs],
        &["pack", "base", "--out", &format!("{new}.tar.zst")],
        &["render", run, "--out", &format!("{new}.gif")],
    ] {
        refused(here, args, &["base/runs"]);
    }
    assert!(tree(&here.join("base")) == before, "the results are what they were");
}

#[test]
fn what_a_command_was_to_make_leaves_no_folders_behind_when_it_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    fs::write(here.join("no.tar.zst"), "x").expect("it can be written");
    refused(
        here,
        &["unpack", "nowhere.tar.zst", "--out", "a/b/c"],
        &["nowhere.tar.zst: cannot read this file"],
    );
    refused(here, &["unpack", "no.tar.zst", "--out", "a/b/c"], &["no.tar.zst: cannot use this archive"]);
    refused(here, &["export", "nowhere", "--out", "a/b"], &["nowhere: is no folder of a run"]);
}

#[test]
fn two_outputs_of_one_command_lie_apart_and_quickstart_runs_its_own_protocol() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    fs::write(here.join("p.toml"), format!("name = 'p'\n{PROTOCOL}")).expect("it can be written");
    refused(here, &["regress", "record", "p.toml", "--out", "x", "--keep", "x"], &["--keep", "--out x"]);
    refused(here, &["quickstart", "--preset", "smoke"], &["quickstart: runs the preset `quickstart`"]);
    refused(here, &["quickstart", "--bogus"], &["Usage: goalbench quickstart"]);
}

/// What is said to no effect is told, wherever it stands.
#[test]
fn options_that_others_replace_bring_a_warning() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    fs::write(here.join("p.toml"), format!("name = 'p'\n{PROTOCOL}")).expect("it can be written");
    let said = |more: &[&str]| {
        let output = within(here, &[&["run", "p.toml", "--print-config"][..], more].concat());
        assert!(output.status.success(), "{more:?}: {}", stderr(&output));
        stderr(&output)
    };
    for (options, expected) in [
        (
            &["--set", "budget.steps=100", "--steps", "200"][..],
            "--steps 200: changes nothing: --set budget.steps=100 sets",
        ),
        (&["--steps", "200", "--set", "budget={steps=100}"], "--steps 200: changes nothing"),
        (&["--device", "cpu", "--set", "student.device='cpu'"], "--device cpu: changes nothing"),
        (&["--shadow", "vds", "--set", "shadow=['lp']"], "--shadow vds: changes nothing"),
        (&["--shadow", "teach"], "the shadow `teach` changes nothing"),
    ] {
        let text = said(options);
        assert!(text.contains(expected), "{options:?}: expected {expected:?} in {text}");
    }
    let repeated =
        ["--set", "student.batch=16", "--set", "student.batch=32", "--steps", "300", "--steps", "200"];
    assert_eq!(said(&repeated), "", "the last of several counts, as with every option");
}
