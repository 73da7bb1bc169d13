//! The whole program on damaged folders and protocols.

use std::fs;

use proptest::sample::select;
use reports::store::layout;

use crate::damage::{damaged, damages};
use crate::fixture::{RUN, copy, finished};
use crate::support::{goalbench, stderr, toy_args};
use crate::target::fuzz;

/// A dry run measures how fast runs are: these make any protocol quick. What the file says is checked all the
/// same.
const QUICK: [&str; 6] = [
    "pool.size=10",
    "evaluation.episodes=2",
    "student.batch=16",
    "student.width=8",
    "student.updates_per_cycle=1",
    "student.episodes_per_cycle=1",
];

/// Runs goalbench: it ends by itself, with a code that means something, and what it says can be shown on a
/// terminal.
fn assert_orderly(args: &[&str]) -> i32 {
    let output = goalbench(args);
    let said = stderr(&output);
    let code = output.status.code().unwrap_or_else(|| panic!("{args:?} ended by a signal: {said}"));
    assert!((0..=2).contains(&code), "{args:?} ended with {code}: {said}");
    assert!(!said.contains("panicked"), "{args:?}: {said}");
    assert!(code == 0 || !said.trim().is_empty(), "{args:?} ended with {code} and said nothing");
    code
}

#[test]
fn results_that_are_damaged() {
    let files: Vec<&str> = layout::FILES
        .iter()
        .map(|file| file.name)
        .filter(|name| finished().join(RUN).join(name).is_file())
        .collect();
    let inputs = (select(files), damages());
    fuzz("program-results", 6, &inputs, |(name, damages)| {
        let folder = copy(finished());
        let path = folder.path().join(RUN).join(name);
        let good = fs::read(&path).expect(name);
        let bad = damaged(&good, &damages);
        fs::write(&path, &bad).expect(name);
        let results = folder.path().to_str().expect("a test path is UTF-8");
        let home = tempfile::tempdir().expect("a temporary folder");
        let merged = home.path().join("merged");
        assert_orderly(&["status", results]);
        assert_orderly(&["evaluate", results, "--episodes", "2"]);
        assert_orderly(&["merge", results, "--out", merged.to_str().expect("UTF-8")]);
        assert_orderly(&["report", results]);
        assert_orderly(&toy_args(folder.path(), &["--seeds", "0", "--dry-run"]));
        let again = assert_orderly(&toy_args(folder.path(), &["--seeds", "0", "--curriculum", "teach"]));
        if again != 0 {
            assert_eq!(fs::read(&path).expect(name), bad, "what is refused is left alone");
        }
    });
}

#[test]
fn protocols_that_are_damaged() {
    let text = include_str!("../../src/protocol/presets/smoke.toml");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("damaged.toml");
    fuzz("program-protocols", 16, &damages(), |damages| {
        fs::write(&path, damaged(text.as_bytes(), &damages)).expect("it can be written");
        let protocol = path.to_str().expect("a test path is UTF-8");
        let out = folder.path().join("out");
        let mut args = vec!["run", protocol, "--dry-run", "--out", out.to_str().expect("UTF-8")];
        args.extend(QUICK.iter().flat_map(|assignment| ["--set", assignment]));
        assert_orderly(&args);
        assert!(!out.exists(), "a dry run writes nothing");
    });
}
