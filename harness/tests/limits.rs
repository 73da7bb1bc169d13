//! Limits of the system are errors with a name, not the end of the process.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use reports::store::layout;
use support::{stderr, toy, toy_args};

/// Runs goalbench with `args` in a shell that has set `limit` first.
fn limited(limit: &str, args: &[&str]) -> Output {
    let script = format!("ulimit {limit} && exec \"$@\"");
    let mut shell = Command::new("sh");
    shell.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_goalbench")]).args(args);
    shell.output().expect("a shell")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a test path is UTF-8")
}

#[test]
fn a_file_that_may_not_grow_is_an_error_of_the_write() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0"]);
    let report = limited("-f 16", &["report", text(folder.path())]);
    assert_eq!(report.status.code(), Some(2), "{}", stderr(&report));
    assert!(stderr(&report).contains("File too large"), "{}", stderr(&report));
}

#[test]
fn a_run_that_may_not_write_goes_on_when_it_may() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args = toy_args(folder.path(), &["--seeds", "0", "--curriculum", "teach", "--retries", "0"]);
    let refused = limited("-f 8", &args);
    assert_eq!(refused.status.code(), Some(1), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("File too large"), "{}", stderr(&refused));
    let undisturbed = tempfile::tempdir().expect("a temporary folder");
    for results in [folder.path(), undisturbed.path()] {
        toy(results, &["--seeds", "0", "--curriculum", "teach"]);
    }
    let records = |results: &Path| {
        fs::read(results.join("runs/Point/teach/default/seed-0").join(layout::RECORDS)).expect("records")
    };
    assert_eq!(records(folder.path()), records(undisturbed.path()));
}
