//! Curricula in Python, as a user has them: real programs, real runs.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::{Duration, Instant};

use curricula::methods::process::PYTHON_HELPER;
use reports::schema::{Manifest, Outcome};
use serde_json::Value;
use support::{goalbench, refused, stderr, stdout};
use tempfile::TempDir;

/// A folder with the helper and the program `teacher.py`.
fn workplace(program: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("goalbench_curriculum.py"), PYTHON_HELPER).expect("it can be written");
    std::fs::write(folder.path().join("teacher.py"), program).expect("it can be written");
    folder
}

/// The example.
const NEAREST: &str = include_str!("../examples/nearest.py");

/// Arguments for 40 episodes of the toy task with two evaluations on the way, into the folder's `out`.
fn args(folder: &Path, options: &str, more: &[&str]) -> Vec<String> {
    let command = format!("python3 {} {options}", folder.join("teacher.py").display());
    let command = format!("curriculum.process.command={}", command.trim());
    let out = folder.join("out").display().to_string();
    let mut args: Vec<String> =
        ["run", "--env", "Point", "--curriculum", "process", "--out", &out].map(str::to_owned).to_vec();
    let small = ["budget.steps=800", "evaluation.every=400", "student.batch=64", "student.width=32"];
    for set in small.into_iter().chain(["pool.size=50", &command]) {
        args.extend(["--set".to_owned(), set.to_owned()]);
    }
    args.extend(more.iter().map(|&arg| arg.to_owned()));
    args
}

fn run(folder: &Path, options: &str, more: &[&str]) -> Output {
    let args = args(folder, options, more);
    goalbench(&args.iter().map(String::as_str).collect::<Vec<_>>())
}

fn run_folder(folder: &Path, curriculum: &str, seed: u64) -> PathBuf {
    folder.join(format!("out/runs/Point/{curriculum}/default/seed-{seed}"))
}

fn read(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn the_example_teaches_what_its_twin_in_rust_does() {
    let folder = workplace(NEAREST);
    let own = ["curriculum.nearest.threshold=0.25", "curriculum.nearest.episodes=6"];
    let more = ["--set", own[0], "--set", own[1], "--seeds", "0,3"];
    let mut args = args(folder.path(), "--threshold 0.25 --episodes 6", &more);
    *args.iter_mut().find(|arg| *arg == "process").expect("the curriculum") = "process,nearest".to_owned();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let done = support::run_example("own_curriculum", &args);
    assert!(done.status.success(), "{}", stderr(&done));
    for seed in [0, 3] {
        let [python, rust] = ["process", "nearest"].map(|id| run_folder(folder.path(), id, seed));
        assert_eq!(read(&python, "teaching.jsonl"), read(&rust, "teaching.jsonl"), "seed {seed}");
        let records = read(&rust, "records.jsonl").replace("\"nearest\"", "\"process\"");
        assert_eq!(read(&python, "records.jsonl"), records, "seed {seed}");
        assert!(records.contains("\"share\":0.1") && !records.ends_with("\"share\":0.1}\n"), "{records}");
    }
}

/// The example, in a program that kills goalbench's worker in its 30th episode and leaves a child that stays.
const MURDEROUS: &str = r#"
import os, signal, sys, time
import goalbench_curriculum
here = os.path.dirname(os.path.abspath(__file__))

def serve(nearest):
    class Murderous(nearest):
        count = 0
        def propose(self, lesson):
            self.count += 1
            if self.count == 30 and not os.path.exists(os.path.join(here, "parent")):
                if os.fork() == 0:
                    self.write("child")
                    time.sleep(600)
                self.write("parent")
                os.kill(os.getppid(), signal.SIGKILL)
                time.sleep(600)
            return super().propose(lesson)
        def write(self, name):
            with open(os.path.join(here, name), "w") as file:
                file.write(f"{os.getpid()}\n")
    goalbench_curriculum.serve(Murderous)

exec(open(os.path.join(here, "nearest.py")).read().replace("import Curriculum, serve", "import Curriculum"))
"#;

#[test]
fn a_worker_that_is_killed_leaves_nobody_behind_and_the_run_goes_on_to_the_same_bytes() {
    let folder = workplace(MURDEROUS);
    std::fs::write(folder.path().join("nearest.py"), NEAREST).expect("it can be written");
    let longer = ["--set", "budget.steps=1600", "--set", "evaluation.every=200"];
    let done = run(folder.path(), "--threshold 0", &longer);
    assert!(done.status.success(), "{}", stderr(&done));
    let crashes = read(&run_folder(folder.path(), "process", 0), "crashes.jsonl");
    assert!(crashes.contains("killed from outside"), "{crashes}");
    for name in ["parent", "child"] {
        let id = read(folder.path(), name);
        let begun = Instant::now();
        // A zombie is dead, whether or not somebody waits for it.
        let lives = || {
            let stat = std::fs::read_to_string(format!("/proc/{}/stat", id.trim())).unwrap_or_default();
            stat.rsplit(')').next().is_some_and(|rest| !rest.is_empty() && !rest.starts_with(" Z"))
        };
        while lives() {
            assert!(begun.elapsed() < Duration::from_secs(20), "{name} is an orphan");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
    // The marks are there now, so that this one is not disturbed.
    let out = folder.path().join("out");
    std::fs::rename(&out, folder.path().join("disturbed")).expect("it can be renamed");
    let done = run(folder.path(), "--threshold 0", &longer);
    assert!(done.status.success(), "{}", stderr(&done));
    let undisturbed = run_folder(folder.path(), "process", 0);
    assert!(!undisturbed.join("crashes.jsonl").exists());
    let disturbed = folder.path().join("disturbed/runs/Point/process/default/seed-0");
    for file in ["records.jsonl", "teaching.jsonl"] {
        assert_eq!(read(&disturbed, file), read(&undisturbed, file), "{file}");
    }
}

#[test]
fn a_program_that_dies_half_way_fails_its_run_alone_with_a_reason() {
    let dying = "
from goalbench_curriculum import Curriculum, serve
class Dying(Curriculum):
    def begin(self):
        self.left = 10 if self.seed == 1 else 1000
    def propose(self, lesson):
        self.left -= 1
        print('left:', self.left)
        return 1 // min(self.left, 1) - 1
serve(Dying)";
    let folder = workplace(dying);
    let done = run(folder.path(), "", &["--seeds", "0..3"]);
    assert_eq!(done.status.code(), Some(1), "{}", stderr(&done));
    for seed in [0, 1, 2] {
        let run = run_folder(folder.path(), "process", seed);
        let outcome: Outcome = serde_json::from_str(&read(&run, "outcome.json")).expect("an outcome");
        match outcome {
            Outcome::Finished { .. } => assert_ne!(seed, 1),
            Outcome::Failed { reason, .. } => {
                assert_eq!(seed, 1, "{reason}");
                let expected =
                    "the curriculum's program ended (exit status: 1) when it was to answer `propose`";
                assert!(reason.contains(expected), "{reason}");
                assert!(reason.contains("ZeroDivisionError"), "{reason}");
            }
        }
        let words = if seed == 1 { "left: 5\n" } else { "left: 995\n" };
        assert!(read(&run, "worker.log").contains(words), "its words are kept");
    }
}

#[test]
fn a_command_that_is_missing_or_does_not_start_is_refused_before_anything_is_written() {
    let folder = workplace("import sys\nsys.exit('no licence')");
    let out = folder.path().join("out");
    let text = out.to_str().expect("a test path is UTF-8");
    let base = ["run", "--env", "Point", "--curriculum", "her-iid,process", "--out", text];
    refused(&base, &["curriculum.process.command", "must be set"]);
    refused(&[base.as_slice(), &["--dry-run"]].concat(), &["curriculum.process.command", "must be set"]);
    let with = |command: &str| format!("curriculum.process.command={command}");
    let none = with("no-such-program-here");
    refused(&[base.as_slice(), &["--set", &none]].concat(), &["`no-such-program-here` cannot be started"]);
    let refusing = with(&format!("python3 {}", folder.path().join("teacher.py").display()));
    refused(
        &[base.as_slice(), &["--set", &refusing]].concat(),
        &["exit status: 1", "it had said: no licence"],
    );
    assert!(!out.exists(), "something was written");
    // The default of a field that others do not need stands in nobody's way.
    let config = stdout(&goalbench(&["list", "config"]));
    assert!(config.contains("[curriculum.process]\ncommand = \"\""), "{config}");
}

#[test]
fn a_program_that_was_edited_is_another_one() {
    let folder = workplace(NEAREST);
    assert!(run(folder.path(), "", &[]).status.success());
    let manifest: Manifest =
        serde_json::from_str(&read(&run_folder(folder.path(), "process", 0), "manifest.json"))
            .expect("a manifest");
    let digest = reports::store::digest::sha256(NEAREST.as_bytes());
    assert_eq!(manifest.versions["curriculum"], format!("1, teacher.py {}", &digest[..12]));
    std::fs::write(folder.path().join("teacher.py"), format!("{NEAREST}# edited\n"))
        .expect("it can be written");
    let again = run(folder.path(), "", &[]);
    assert_eq!(again.status.code(), Some(2), "{}", stderr(&again));
    assert!(stderr(&again).contains("versions.curriculum"), "{}", stderr(&again));
}

#[test]
fn figures_and_tables_name_it_as_the_user_does() {
    let folder = workplace(NEAREST);
    let protocol = format!(
        "name = 'two'\nenvironments = ['Point']\ncurricula = ['teach', 'process']\nseeds = [0]\n\
         budget.steps = 400\nevaluation.every = 200\nstudent = {{ batch = 64, width = 32 }}\npool.size = 20\n\
         [[variant]]\nlabel = 'default'\ncurricula = ['teach']\n\
         [[variant]]\nlabel = 'small'\ncurricula = ['process']\n\
         set.curriculum.process = {{ command = 'python3 {0}', title = 'Nearest first' }}\n\
         [[variant]]\nlabel = 'wide'\ncurricula = ['process']\n\
         set.curriculum.process = {{ command = 'python3 {0} --share 0.5', title = 'Half first' }}\n",
        folder.path().join("teacher.py").display()
    );
    let file = support::write_protocol(folder.path(), &protocol);
    let out = folder.path().join("out").display().to_string();
    let done = goalbench(&["run", &file, "--out", &out]);
    assert!(done.status.success(), "{}", stderr(&done));
    let done = goalbench(&["report", &out]);
    assert!(done.status.success(), "{}", stderr(&done));
    let report = folder.path().join("out/report");
    let (page, summary) = (read(&report, "index.html"), read(&report, "summary.md"));
    for title in ["Nearest first (small)", "Half first (wide)"] {
        assert!(page.contains(title), "{title} is not on the page");
        assert!(summary.contains(title), "{title} is in no table: {summary}");
    }
    assert!(!page.contains("Process ("), "the plain title is still there");

    // The titles go along in an archive.
    let archive = folder.path().join("lab.tar.zst").display().to_string();
    let packed = goalbench(&["pack", &out, "--out", &archive]);
    assert!(packed.status.success(), "{}", stderr(&packed));
    let done = goalbench(&["report", &out, "--with", &archive]);
    assert!(done.status.success(), "{}", stderr(&done));
    let summary = read(&report, "summary.md");
    assert!(summary.contains("3 runs are once more what these results have already"), "{summary}");
    for title in ["Nearest first \\[lab\\]", "Half first \\[lab\\]"] {
        assert!(summary.contains(title), "{title} is in no table: {summary}");
    }
}

#[test]
fn a_title_that_another_curriculum_has_is_refused() {
    let folder = workplace(NEAREST);
    let title = ["--set", "curriculum.process.title=teach"];
    let args = args(folder.path(), "", &title);
    support::refused(&args.iter().map(String::as_str).collect::<Vec<_>>(), &["`TEACH`", "another title"]);
    assert!(!folder.path().join("out").exists());
}

/// The tutorial's own program, as it stands there, on its own maze.
#[test]
fn the_program_of_the_tutorial_runs() {
    let page = include_str!("../docs/tutorial.md");
    let program = page.split("```python\n").nth(1).and_then(|rest| rest.split("```").next());
    let folder = workplace(program.expect("a program"));
    let small = ["--set", "budget.steps=400", "--set", "student.updates_per_cycle=2"];
    let mut args = args(folder.path(), "", &small);
    *args.iter_mut().find(|arg| *arg == "Point").expect("the environment") = "MazeA".to_owned();
    let done = goalbench(&args.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(done.status.success(), "{}", stderr(&done));
}

#[test]
fn the_helper_is_listed_for_whoever_has_the_program_alone() {
    assert_eq!(stdout(&goalbench(&["list", "python"])), PYTHON_HELPER);
    let curricula: Value =
        serde_json::from_str(&stdout(&goalbench(&["list", "curricula", "--json"]))).expect("JSON");
    let row = curricula.as_array().and_then(|rows| rows.iter().find(|row| row["id"] == "process"));
    assert_eq!(row.expect("a row")["needs"], "command");
}
