//! What a sweep shows on terminals of several widths and kinds, and what it counts.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::Path;
use std::process::{Command, Output};

use support::{TOY, goalbench, stdout};

/// Arguments of the toy sweep into `out`, for a shell.
fn toy_line(out: &Path) -> String {
    let args: Vec<String> = TOY.iter().map(|arg| format!("'{arg}'")).collect();
    format!("{} --jobs 2 --out '{}'", args.join(" "), out.display())
}

/// Runs the toy sweep on a terminal of its own (`script` makes one) after `prepare` has set it up; gives what
/// the terminal was sent. Standard output is part of it.
fn on_a_terminal(prepare: &str, environment: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let goalbench = env!("CARGO_BIN_EXE_goalbench");
    let line = format!("{prepare}; '{goalbench}' {}", toy_line(folder.path()));
    let output: Output = Command::new("script")
        .args(["--quiet", "--return", "--command", &line, "/dev/null"])
        .env_remove("NO_COLOR")
        .env("TERM", "xterm")
        .envs(environment.iter().copied())
        .stdin(std::process::Stdio::null())
        .output()
        .expect("script of util-linux, which Debian always has");
    let sent = stdout(&output);
    assert!(output.status.success(), "{sent}");
    sent
}

/// The lines of a terminal `columns` wide that was sent `sent`: those that end, and those that it wraps.
fn drawn(sent: &str, columns: usize) -> Vec<String> {
    let text = console::strip_ansi_codes(sent).replace('\r', "\n");
    let characters: Vec<Vec<char>> = text.lines().map(|line| line.chars().collect()).collect();
    let rows = characters.iter().flat_map(|line| line.chunks(columns));
    rows.map(|row| row.iter().collect::<String>().trim_end().to_owned())
        .filter(|row| !row.is_empty())
        .collect()
}

/// Lines of progress, not of history.
fn is_progress(line: &str) -> bool {
    line.contains("% ") || line.ends_with('%') || line.contains("left") || line.contains("at a time")
}

#[test]
fn bars_fit_terminals_of_all_widths() {
    for columns in [40, 60, 80, 200] {
        let sent = on_a_terminal(&format!("stty rows 24 cols {columns}"), &[]);
        let lines = drawn(&sent, columns);
        let progress: Vec<&String> = lines.iter().filter(|line| is_progress(line)).collect();
        assert!(!progress.is_empty(), "{columns}: {sent}");
        assert!(sent.contains('\x1b'), "it is drawn anew in place");
        for line in progress {
            let width = console::measure_text_width(line);
            assert!(width < columns, "{columns}: {width} columns: {line}");
            assert!(!line.contains("steps/s") || !has_many_decimals(line), "{line}");
        }
    }
}

/// Whether a number of `line` has more than two decimals.
fn has_many_decimals(line: &str) -> bool {
    let decimals = |part: &str| part.chars().take_while(char::is_ascii_digit).count();
    line.split('.').skip(1).any(|part| decimals(part) > 2)
}

#[test]
fn terminals_that_cannot_show_bars_get_plain_lines() {
    let cases: [(&str, &[(&str, &str)]); 4] = [
        ("stty rows 0 cols 0", &[]),
        ("stty rows 24 cols 12", &[]),
        ("stty rows 24 cols 80", &[("TERM", "dumb")]),
        ("stty rows 24 cols 80", &[("NO_COLOR", "1")]),
    ];
    for (prepare, environment) in cases {
        let sent = on_a_terminal(prepare, environment);
        assert!(!sent.contains('\x1b'), "{prepare} {environment:?}: {sent:?}");
        assert!(sent.contains("4 runs, 4 to do, 2 at a time"), "{sent}");
        assert!(sent.contains("step 400/400"), "{sent}");
        assert!(sent.contains("| all: 4/4 runs"), "{sent}");
    }
}

#[test]
fn a_stopped_run_is_not_done() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().to_str().expect("UTF-8");
    let line = format!("{} --steps 4000000 --out '{out}'", TOY.join(" "));
    let script = format!(
        "'{}' {line} --jobs 4 2> '{out}/said' & pid=$!
         until grep -q success '{out}/said'; do sleep 0.1; done
         kill -TERM $pid; wait $pid",
        env!("CARGO_BIN_EXE_goalbench")
    );
    let output = Command::new("sh").args(["-c", &script]).output().expect("a shell starts");
    let said = std::fs::read_to_string(folder.path().join("said")).expect("it said something");
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert_eq!(said.matches("stopped; goes on another time").count(), 4, "{said}");
    assert_eq!(said.matches("| all: 0/4 runs").count(), said.matches("| all:").count(), "{said}");
}

#[test]
fn run_and_status_give_the_same_speed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().to_str().expect("UTF-8");
    let args: Vec<&str> = TOY.iter().copied().chain(["--out", out, "--jobs", "1"]).collect();
    let said = support::stderr(&goalbench(&args));
    let told = stdout(&goalbench(&["status", out]));
    for run in ["Point/teach/default/seed-0", "Point/her-iid/default/seed-1"] {
        let line = said.lines().find(|line| line.starts_with(run) && line.contains("step 400/400"));
        let line = line.unwrap_or_else(|| panic!("no last evaluation of {run}: {said}"));
        let words: Vec<&str> = line.split_whitespace().collect();
        let at = words.iter().position(|&word| word == "steps/s").expect("a speed");
        let row = told.lines().find(|line| line.starts_with(run)).expect("its row");
        assert_eq!(row.split_whitespace().nth(4), Some(words[at - 1]), "{line}\n{row}");
    }
    assert!(told.contains("4 runs: 4 finished"), "{told}");
}

#[test]
fn one_run_is_called_one_run_and_a_cycle_beyond_the_budget_counts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().to_str().expect("UTF-8");
    let one = ["--out", out, "--seeds", "0", "--steps", "10"];
    let toy = TOY.iter().map(|&arg| if arg == "teach,her-iid" { "her-iid" } else { arg });
    let args: Vec<&str> = toy.chain(one).collect();
    let output = goalbench(&args);
    let said = support::stderr(&output) + &stdout(&output) + &stdout(&goalbench(&["status", out]));
    assert!(output.status.success(), "{said}");
    for expected in
        ["1 run, 1 to do", "step 40/40 ", "| all: 1/1 run\n", "1 run finished; ", "1 run: 1 finished"]
    {
        assert!(said.contains(expected), "{expected}: {said}");
    }
    assert!(!said.contains("1 runs") && !said.contains("40/10"), "{said}");
}
