//! Limits of the system are errors with a name, not the end of the process.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use reports::store::layout;
use support::{goalbench, stderr, toy, toy_args};

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
    assert_eq!(report.status.code(), Some(1), "no input is wrong: {}", stderr(&report));
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

#[test]
fn too_few_files_for_the_workers_are_told_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results");
    let refused = limited("-n 10", &toy_args(&results, &["--jobs", "1"]));
    let said = stderr(&refused);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert_eq!(
        said.matches("may have 10 files open (ulimit -n); raise it to 32 or more").count(),
        1,
        "{said}"
    );
    assert!(!said.contains("checkpoint") && !results.exists(), "{said}");
}

#[test]
fn a_small_file_that_unpacks_to_a_large_one_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = fs::File::create(folder.path().join("zeros.json.gz")).expect("the test folder can be written");
    let mut packed = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
    std::io::copy(&mut std::io::repeat(b' ').take(300 << 20), &mut packed).expect("it is written");
    packed.finish().expect("it is written");
    let output = goalbench(&["verify", text(folder.path())]);
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(said.contains("zeros.json.gz: it holds more than 256 MB, the most that is read"), "{said}");
}

#[test]
fn a_dry_run_ends_though_no_cycle_does() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let large = ["student.batch=1e6", "student.updates_per_cycle=1e6", "pool.size=1e6"];
    let mut args = vec!["run", "--env", "Point", "--curriculum", "teach", "--dry-run", "--out"];
    args.push(text(folder.path()));
    args.extend(large.iter().flat_map(|assignment| ["--set", assignment]));
    let begun = Instant::now();
    let output = goalbench(&args);
    assert!(output.status.success() && begun.elapsed() < Duration::from_secs(90), "{:?}", begun.elapsed());
    let said = stderr(&output);
    assert!(said.contains("none came through in that time, so there is no estimate"), "{said}");
}
