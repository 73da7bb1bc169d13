//! The commands of the tutorial and of a gate for its curriculum, as they stand in the pages but for the
//! numbers, in an empty folder.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::Path;
use std::process::Command;

const PAGE: &str = include_str!("../docs/tutorial.md");
const GATE: &str = include_str!("../docs/regression.md");

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

/// The fenced blocks of `page` in this language, in order.
fn blocks(page: &'static str, language: &str) -> impl Iterator<Item = &'static str> {
    let opening = format!("```{language}\n");
    let starts: Vec<usize> = page.match_indices(&opening).map(|(at, _)| at + opening.len()).collect();
    starts.into_iter().map(move |at| page[at..].split("```").next().expect("a block"))
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
    let program = blocks(PAGE, "python").next().expect("a curriculum in Python");
    std::fs::write(folder.path().join("outward.py"), program).expect("it can be written");
    let mut used = [false; SMALLER.len()];
    for block in blocks(PAGE, "sh") {
        let mut commands =
            block.replace("cargo run --release -p goalbench --example own_curriculum --", &example);
        for ((full, small), used) in SMALLER.into_iter().zip(&mut used) {
            *used |= commands.contains(full);
            commands = commands.replace(full, small);
        }
        shell(&commands, folder.path());
    }
    assert_eq!(used, [true; SMALLER.len()], "the page has other numbers");
    for (results, title) in [("first", "TEACH"), ("outward", "Outward"), ("nearest", "Nearest first")] {
        let report = folder.path().join(results).join("report");
        let page = std::fs::read_to_string(report.join("index.html")).expect("a report");
        assert!(page.contains(title), "{title} is not on the page");
        assert!(report.join("figures/success-MazeA.png").exists());
    }
}

/// A baseline of a Python program is recorded and checked by the page's protocol and commands; a program that
/// was changed since is still checked, and no longer the same.
#[test]
fn the_gate_for_a_method_of_ones_own_works_as_its_page_says() {
    let folder = tempfile::tempdir().expect("an empty folder");
    let program = blocks(PAGE, "python").next().expect("a curriculum in Python");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("it can be written");
    };
    shell("goalbench list python > goalbench_curriculum.py", folder.path());
    write("outward.py", program);
    let (mut protocol, smaller) = (
        blocks(GATE, "toml").next().expect("a protocol").to_owned(),
        [
            ("10_000", "400"),
            ("1_000", "200"),
            ("episodes = 100", "episodes = 2"),
            ("batch = 256", "batch = 32"),
        ],
    );
    for (full, small) in smaller {
        assert!(protocol.contains(full), "the page has other numbers: {full}");
        protocol = protocol.replace(full, small);
    }
    write("mine.toml", &protocol);
    let commands = blocks(GATE, "sh")
        .find(|block| block.contains("record --protocol mine.toml --out mine.json    #"))
        .expect("its commands");
    shell(commands, folder.path());
    let said = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a summary");
    let same = "identical to the baseline's, byte for byte";
    assert!(said("gate/summary.md").contains(same), "{}", said("gate/summary.md"));
    write("outward.py", &program.replace("self.reach = 0.3", "self.reach = 2.0"));
    shell("goalbench regress check --baseline mine.json --out again || [ $? = 1 ]", folder.path());
    assert!(!said("again/summary.md").contains(same), "{}", said("again/summary.md"));
}
