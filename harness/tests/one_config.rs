//! A cell (environment × curriculum × variant) has one config: its runs differ in their seeds alone.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use reports::store::{Results, layout};
use support::{goalbench, stderr, stdout, toy, toy_args};

/// Another config of the same cell.
const OTHER: [&str; 4] = ["--set", "student.width=8", "--set", "student.her_k=0"];

fn path(path: &Path) -> &str {
    path.to_str().expect("a test path is UTF-8")
}

fn seed(results: &Path, seed: u64) -> PathBuf {
    results.join(format!("runs/Point/teach/default/seed-{seed}"))
}

/// Two results folders of one cell with different configs and seeds, put into one by hand.
fn mixed(results: &Path) {
    toy(results, &["--curriculum", "teach"]);
    let other = tempfile::tempdir().expect("a temporary folder");
    toy(other.path(), &[&["--curriculum", "teach", "--seeds", "2,3"][..], &OTHER].concat());
    for number in [2, 3] {
        fs::rename(seed(other.path(), number), seed(results, number)).expect("one file system");
    }
}

#[test]
fn other_seeds_with_another_config_are_refused_and_leave_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--curriculum", "teach"]);
    let output = goalbench(&toy_args(folder.path(), &[&["--seeds", "2,3"][..], &OTHER].concat()));
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    for part in
        ["seed-0", "student.width: 16 there, 8 now", "student.her_k: 4 there, 0 now", "their seeds alone"]
    {
        assert!(stderr(&output).contains(part), "expected {part:?} in {}", stderr(&output));
    }
    assert!(!seed(folder.path(), 2).exists());
    // An unfinished run and a failed one have a config as well.
    for outcome in [None, Some(r#"{"status":"failed","step":100,"reason":"x"}"#)] {
        for run in Results::new(folder.path()).survey().expect("a results folder").runs {
            let file = run.file(layout::OUTCOME);
            match outcome {
                Some(outcome) => fs::write(&file, outcome).expect("it can be written"),
                None => fs::remove_file(&file).expect("it is there"),
            }
        }
        let output = goalbench(&toy_args(folder.path(), &[&["--seeds", "2"][..], &OTHER].concat()));
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    }
    // The same config is welcome.
    toy(folder.path(), &["--seeds", "2"]);
}

#[test]
fn report_and_evaluate_name_the_odd_ones_and_average_over_the_others() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    mixed(folder.path());
    let report = goalbench(&["report", path(folder.path())]);
    assert_eq!(report.status.code(), Some(1), "{}", stderr(&report));
    let evaluate = goalbench(&["evaluate", path(folder.path()), "--episodes", "20"]);
    assert_eq!(evaluate.status.code(), Some(1), "{}", stderr(&evaluate));
    for said in [stderr(&report), stderr(&evaluate)] {
        for part in ["default/seed-2", "default/seed-3", "config differs from", "/student/width"] {
            assert!(said.contains(part), "expected {part:?} in {said}");
        }
        assert!(!said.contains("default/seed-1:"), "{said}");
    }
    let text = stdout(&evaluate);
    let means = text.lines().find(|line| line.starts_with("Point/teach/default  ")).expect("a line of means");
    assert_eq!(means.split_whitespace().nth(2), Some("2"), "a mean of the two alike: {means}");
    assert_eq!(text.matches("Point/teach/default/seed-").count(), 4, "every policy was played: {text}");
    // By themselves the others are a cell as well.
    let alone = [2, 3].map(|number| seed(folder.path(), number));
    let alone = goalbench(&["evaluate", path(&alone[0]), path(&alone[1]), "--episodes", "20"]);
    assert!(alone.status.success(), "{}", stderr(&alone));
}

#[test]
fn a_run_that_never_began_blocks_no_other_config() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--curriculum", "teach"]);
    // As a sweep leaves runs that it was stopped before: with their manifests alone.
    for run in Results::new(folder.path()).survey().expect("a results folder").runs {
        for entry in fs::read_dir(run.path()).expect("a run's folder") {
            let file = entry.expect("it can be read").path();
            if file.is_dir() {
                fs::remove_dir_all(&file).expect("it can be removed");
            } else if file.file_name().is_some_and(|name| name != layout::MANIFEST) {
                fs::remove_file(&file).expect("it can be removed");
            }
        }
    }
    toy(folder.path(), &[&["--curriculum", "teach", "--seeds", "1,2"][..], &OTHER].concat());
    assert!(!seed(folder.path(), 0).exists(), "a plan that was given up is no run of this cell");
    let report = goalbench(&["report", path(folder.path())]);
    assert!(report.status.success(), "{}", stderr(&report));
}
