//! Wrong input: a clear message, exit code 2, nothing half-written.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::Path;

use support::{goalbench, refused, stderr, stdout, toy, toy_args, write_protocol as write};

const HEAD: &str = "name = 'x'\nenvironments = ['Point']\ncurricula = ['teach']\nseeds = [0]\n";

#[test]
fn unknown_names_come_with_a_suggestion() {
    refused(
        &["run", "--env", "MazeA", "--curriculum", "tech"],
        &["unknown curriculum `tech`; did you mean `teach`?"],
    );
    refused(
        &["run", "--env", "mazea", "--curriculum", "teach"],
        &["unknown environment `mazea`; did you mean `MazeA`?", "FetchReach"],
    );
    refused(&["run", "--preset", "quikstart"], &["unknown preset `quikstart`; did you mean `quickstart`?"]);
    refused(&["protocol", "show", "papr"], &["did you mean `paper`?"]);
}

#[test]
fn unusable_options_say_what_is_accepted() {
    let toy = ["run", "--env", "Point", "--curriculum", "teach"];
    let with = |more: &[&'static str]| [toy.as_slice(), more].concat();
    refused(&["run"], &["protocol file", "--preset"]);
    refused(&with(&["--seeds", "7..0"]), &["--seeds", "`7..0` is empty"]);
    refused(&with(&["--seeds", "a"]), &["--seeds", "`0..7` or `0,3`"]);
    refused(&with(&["--jobs", "0"]), &["--jobs"]);
    refused(&with(&["--set", "budget.steps"]), &["has no `=`"]);
    refused(&with(&["--steps", "0"]), &["--steps 0: budget.steps: is 0; must be 1 to"]);
    let steps = ["--steps", "18446744073709551615"];
    refused(&with(&steps), &["--steps 18446744073709551615: budget.steps", "must be 1 to"]);
    let pool = ["--set", "pool.size=999999999999999"];
    refused(&with(&pool), &["pool.size: is 999999999999999; must be 1 to 1000000"]);
    refused(&with(&["--set", "student.width=99999999"]), &["student.width"]);
    refused(&with(&["--set", "budget=5"]), &["budget", "a table with the key `steps`"]);
    refused(&with(&["--partition", "cpu"]), &["--partition", "--executor slurm"]);
    refused(&with(&["--executor", "slurm", "--jobs", "2"]), &["--jobs", "--at-once"]);
    refused(&with(&["--set", "evaluation.every=10"]), &["evaluation.every", "one cycle"]);
    refused(&["report", "/nowhere/at/all"], &["/nowhere/at/all"]);
    for (option, value, accepted) in [
        ("--window", "0", "a whole number from 1 to 65535 is accepted"),
        ("--confidence", "0.4", "a number above 0.5 and below 1 is accepted"),
        ("--margin", "2", "a number above 0 and below 1 is accepted"),
        ("--fewest-pairs", "0", "a whole number from 1 to 65535 is accepted"),
        ("--failures", "never", "zero, apart"),
        ("--title", " ", "a line of text is accepted"),
    ] {
        refused(&["report", "anywhere", option, value], &[option, value, accepted]);
    }
}

#[test]
fn mistyped_config_keys_on_the_command_line_are_named_with_the_accepted_ones() {
    let set =
        |assignment: &'static str| ["run", "--env", "Point", "--curriculum", "teach", "--set", assignment];
    refused(
        &set("curriculum.teach.windw=5"),
        &[
            "--set curriculum.teach.windw=5: curriculum.teach.windw: unknown key `windw`; did you mean `window`?",
            "interplay",
        ],
    );
    refused(
        &set("curriculum.tech.window=5"),
        &["curriculum.tech: unknown curriculum `tech`; did you mean `teach`?"],
    );
    refused(&set("student.bach=5"), &["student.bach", "did you mean `batch`?"]);
    refused(&set("budgt.steps=5"), &["budgt", "did you mean `budget`?"]);
    refused(&set("budget.stps=5"), &["budget.stps", "did you mean `steps`?"]);
    refused(&set("curriculum.teach.window=0"), &["curriculum.teach.window"]);
    refused(&set("curriculum.teach.confidence=both"), &["curriculum.teach.confidence", "online, target"]);
    let noise = "student.noise={ kind = 'ornstein-uhlenbeck', sigma = 0.3 }";
    for setting in [noise, "student.noise.kind=ornstein-uhlenbeck"] {
        let output = goalbench(&[&set(setting)[..], &["--dry-run"]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
    }
    refused(
        &set("student.noise={ kind = 'ornstein-uhlenbeck', std = 0.3 }"),
        &["student.noise.std", "theta"],
    );
    refused(&set("student.preset=best"), &["student.preset", "harmonised, official"]);
    refused(&set("budget.steps=many"), &["budget.steps"]);
    refused(&set("seed=3"), &["--set seed=3: seed: ", "a table of seeds by kind", "`seeds`"]);
    refused(&set("seed.pools=3"), &["seed.pools", "did you mean `pool`?"]);
    refused(&set("seed.pool=-1"), &["seed.pool"]);
    refused(&set("evaluation.goals=pols"), &["evaluation.goals", "did you mean `pool`?"]);
}

#[test]
fn mistakes_in_a_protocol_name_file_and_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused_at = |text: &str, line: usize, expected: &[&str]| {
        let path = write(folder.path(), text);
        let place = format!("{path}:{line}: ");
        refused(&["run", &path, "--dry-run"], &[&[place.as_str()], expected].concat());
    };
    refused_at(&format!("{HEAD}[curriculum.teach]\nwindw = 3\n"), 6, &["did you mean `window`?"]);
    refused_at(&format!("{HEAD}[budgt]\nsteps = 3\n"), 5, &["did you mean `budget`?"]);
    refused_at(
        &format!("{HEAD}[[variant]]\nlabel = 'n3'\nset = {{ pool.sise = 3 }}\n"),
        7,
        &["pool.sise", "did you mean `size`?"],
    );
    refused_at(
        &format!("{HEAD}[[override]]\nenvironments = ['Pont']\nset = {{}}\n"),
        5,
        &["did you mean `Point`?"],
    );
    // Also where the patch applies to no planned run.
    let elsewhere = "[[override]]\ncurricula = ['her-iid']\nset = { student.bach = 3 }\n";
    refused_at(&format!("{HEAD}{elsewhere}"), 7, &["student.bach", "did you mean `batch`?"]);
    refused_at(&format!("{HEAD}[[variant]]\nlabel = '../x'\n"), 5, &["`../x` cannot be a label"]);
    refused_at(
        "name = 'x'\nenvironments = ['Point']\ncurricula = ['tech']\nseeds = [0]\n",
        3,
        &["did you mean `teach`?"],
    );
    refused_at(
        "name = 'x'\nenvironments = ['Point']\ncurricula = ['teach']\nseeds = '5..1'\n",
        4,
        &["empty"],
    );
    refused_at("name = 'x\n", 1, &[]);
    let path = write(folder.path(), "environments = ['Point']\n");
    refused(&["run", &path], &[path.as_str(), "name"]);
    refused(&["run", "/nowhere.toml"], &["/nowhere.toml", "cannot read this protocol"]);
}

#[test]
fn a_folder_written_with_another_config_is_left_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--curriculum", "her-iid"]);
    let before = contents(folder.path());
    let other = toy_args(folder.path(), &["--set", "student.batch=33"]);
    refused(&other, &["another config", "student.batch: 32 there, 33 now", "Nothing was changed"]);
    assert_eq!(contents(folder.path()), before);
}

#[test]
fn an_altered_manifest_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--curriculum", "her-iid", "--seeds", "0"]);
    let manifest = folder.path().join("runs/Point/her-iid/default/seed-0/manifest.json");
    fs::write(&manifest, "{\"schema\": 1").expect("the test folder can be written");
    refused(&toy_args(folder.path(), &[]), &["manifest.json", "EOF"]);
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("the test folder can be written");
    let out = file.join("results");
    refused(&toy_args(&out, &[]), &["--out", "file is no folder"]);
}

#[test]
fn a_second_run_on_the_same_folder_is_turned_away() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let lock = fs::File::create(folder.path().join(".lock")).expect("the test folder can be written");
    lock.lock().expect("nobody else has it");
    refused(&toy_args(folder.path(), &[]), &["another goalbench process is working on this folder"]);
    assert!(!folder.path().join("runs").exists());
}

#[test]
fn a_dry_run_prints_the_plan_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("results");
    let output = goalbench(&toy_args(&out, &["--dry-run"]));
    assert!(output.status.success());
    let text = stdout(&output);
    assert!(text.contains("Point/teach/default") && text.contains("4 runs, 1600 training steps"), "{text}");
    assert!(!out.exists());
}

/// Every file below `folder` with its bytes.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else {
                found.push((entry.display().to_string(), fs::read(&entry).expect("a file")));
            }
        }
    }
    found.sort();
    found
}

/// Where it can be used, the run succeeds instead.
#[test]
fn a_device_that_is_not_there_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results");
    let args = toy_args(&results, &["--seeds", "0", "--device", "cuda"]);
    let output = goalbench(&args);
    if output.status.success() {
        return;
    }
    refused(&args, &["goalbench: --device: device cuda: ", "CUDA"]);
    assert!(!results.exists());
}

#[test]
fn a_results_folder_that_is_none_is_called_so_by_all() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = |path: &std::path::Path| path.to_str().expect("a test path is UTF-8").to_owned();
    let (missing, out) = (text(&folder.path().join("missing")), text(&folder.path().join("merged")));
    let empty = text(&folder.path().join("empty"));
    fs::create_dir(&empty).expect("it can be created");
    for (place, expected) in [(&missing, "missing: cannot find this folder"), (&empty, "results folder")] {
        refused(&["status", place], &[expected]);
        refused(&["evaluate", place], &[expected]);
        refused(&["report", place], &[expected]);
        refused(&["merge", place, "--out", &out], &[expected]);
    }
}
