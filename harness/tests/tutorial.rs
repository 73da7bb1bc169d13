//! The commands of the tutorial, as they stand there but for the numbers, in an empty folder.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::Path;
use std::process::Command;

const PAGE: &str = include_str!("../docs/tutorial.md");

/// What is made smaller, so that all of it takes seconds.
const SMALLER: [(&str, &str); 4] = [
    (
        "--steps 20000",
        "--steps 400 --set student.batch=32 --set student.width=16 --set student.updates_per_cycle=2",
    ),
    ("evaluation.every=2000", "evaluation.every=200 --set evaluation.episodes=2"),
    ("--episodes 200", "--episodes 5"),
    ("--episodes 3", "--episodes 1"),
];

/// The fenced blocks of the page in this language, in order.
fn blocks(language: &str) -> impl Iterator<Item = &'static str> {
    let opening = format!("```{language}\n");
    let starts: Vec<usize> = PAGE.match_indices(&opening).map(|(at, _)| at + opening.len()).collect();
    starts.into_iter().map(|at| PAGE[at..].split("```").next().expect("a block"))
}

/// Runs a block as a shell would, where `goalbench` is on the `PATH`.
fn shell(commands: &str, folder: &Path) {
    let program = Path::new(env!("CARGO_BIN_EXE_goalbench")).parent().expect("a folder");
    let path = std::env::join_paths(
        std::iter::once(program.to_owned())
            .chain(std::env::split_paths(&std::env::var_os("PATH").expect("a PATH"))),
    );
    let output = Command::new("sh")
        .args(["-e", "-c", commands])
        .current_dir(folder)
        .env("PATH", path.expect("plain folders"))
        .output()
        .expect("a shell");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{commands}\n{said}");
}

#[test]
fn every_command_of_the_tutorial_works_and_both_curricula_are_in_their_figures() {
    let folder = tempfile::tempdir().expect("an empty folder");
    let example = support::example("own_curriculum").display().to_string();
    let program = blocks("python").next().expect("a curriculum in Python");
    std::fs::write(folder.path().join("outward.py"), program).expect("it can be written");
    let mut used = [false; SMALLER.len()];
    for block in blocks("sh") {
        let mut commands =
            block.replace("cargo run --release -p goalbench --example own_curriculum --", &example);
        for ((full, small), used) in SMALLER.into_iter().zip(&mut used) {
            *used |= commands.contains(full);
            commands = commands.replace(full, small);
        }
        // Drawing needs a graphics library, which `harness/tests/render.rs` asks for.
        let drawn: Vec<&str> =
            commands.lines().filter(|line| !line.starts_with("goalbench render")).collect();
        shell(&drawn.join("\n"), folder.path());
    }
    assert_eq!(used, [true; SMALLER.len()], "the page has other numbers");
    for (results, title) in [("first", "TEACH"), ("outward", "Outward"), ("nearest", "Nearest first")] {
        let report = folder.path().join(results).join("report");
        let page = std::fs::read_to_string(report.join("index.html")).expect("a report");
        assert!(page.contains(title), "{title} is not on the page");
        assert!(report.join("figures/success-MazeA.png").exists());
    }
}
