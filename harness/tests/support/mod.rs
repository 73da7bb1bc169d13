//! Runs the program as a user would.

#![allow(dead_code, reason = "each test file takes what it needs of these")]

pub(crate) mod children;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use reports::store::checksums::Checksums;
use reports::store::{RunFolder, layout};

/// A run of the toy task that takes about a second, whose options later ones override.
pub(crate) const TOY: &[&str] = &[
    "run",
    "--env",
    "Point",
    "--curriculum",
    "teach,her-iid",
    "--seeds",
    "0,1",
    "--steps",
    "400",
    "--set",
    "evaluation.every=100",
    "--set",
    "evaluation.episodes=5",
    "--set",
    "student.batch=32",
    "--set",
    "student.width=16",
    "--set",
    "student.updates_per_cycle=4",
    "--set",
    "pool.size=20",
];

/// Runs goalbench with `args` and waits.
pub(crate) fn goalbench(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_goalbench")).args(args).output().expect("the program starts")
}

/// Runs the toy protocol into `out` with further options; the run must succeed.
pub(crate) fn toy(out: &Path, more: &[&str]) {
    let output = goalbench(&toy_args(out, more));
    assert!(output.status.success(), "{}", stderr(&output));
}

/// Arguments of the toy protocol into `out`.
pub(crate) fn toy_args<'a>(out: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
    let out = out.to_str().expect("a test path is UTF-8");
    TOY.iter().copied().chain(["--out", out]).chain(more.iter().copied()).collect()
}

/// The example program `name`. Cargo builds examples with the tests, into a folder beside theirs.
pub(crate) fn example(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test has a path");
    let profile = test.parent().and_then(|deps| deps.parent()).expect("tests lie in PROFILE/deps");
    profile.join("examples").join(name)
}

/// Runs the example program `name` with `args` and waits.
pub(crate) fn run_example(name: &str, args: &[&str]) -> Output {
    Command::new(example(name))
        .args(args)
        .output()
        .expect("`cargo test` builds examples; with --test alone, `cargo build --release --examples` first")
}

/// Checks that the section of `page` under `heading` quotes lines of `example`, so that the page stays true
/// when the example changes.
pub(crate) fn assert_quotes(page: &str, heading: &str, example: &str) {
    let (_, rest) = page.split_once(heading).expect("the walk through the example");
    // Attributes in the code begin with `#` as well: a section ends where one of its level begins.
    let level = heading.split(' ').next().unwrap_or_default();
    let walk = rest.split(&format!("\n{level} ")).next().unwrap_or_default();
    let quoted: Vec<&str> = walk
        .split("```rust\n")
        .skip(1)
        .flat_map(|rest| rest.split("```").next().unwrap_or_default().lines())
        .map(str::trim)
        .collect();
    assert!(quoted.len() > 10, "{quoted:?}");
    for line in quoted {
        assert!(example.contains(line), "the example has no line `{line}`");
    }
}

/// Number of TFRecords in `file`: length (8 bytes), its checksum (4), payload, its checksum (4).
pub(crate) fn tfrecords(file: &Path) -> usize {
    let bytes = std::fs::read(file).expect("an event file");
    let (mut rest, mut count) = (bytes.as_slice(), 0);
    while !rest.is_empty() {
        let length = u64::from_le_bytes(rest[..8].try_into().expect("8 bytes")) as usize;
        rest = &rest[length + 16..];
        count += 1;
    }
    count
}

/// Makes what lies in the folder of an ended run what it ended with.
pub(crate) fn seal(folder: &Path) {
    let run = RunFolder::new(folder);
    let manifest = run.manifest().expect("a manifest").expect("a manifest");
    let sums = Checksums::of(&run, &manifest.hash).expect("its files can be read");
    let text = serde_json::to_string(&sums).expect("plain data");
    std::fs::write(folder.join(layout::CHECKSUMS), text).expect("the test folder can be written");
}

/// What the program said on standard error.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What the program said on standard output.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs goalbench, which must refuse with exit code 2 and say each of `expected`.
pub(crate) fn refused(args: &[&str], expected: &[&str]) {
    let output = goalbench(args);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    for part in expected {
        assert!(message.contains(part), "{args:?}: expected {part:?} in\n{message}");
    }
}

/// Writes a protocol into `folder` and gives its path.
pub(crate) fn write_protocol(folder: &Path, text: &str) -> String {
    let path = folder.join("protocol.toml");
    std::fs::write(&path, text).expect("the test folder can be written");
    path.to_str().expect("a test path is UTF-8").to_owned()
}
