//! The pages of `goalbench help` are those of `harness/docs`, and those made from the code are up to date.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::PathBuf;

use support::{goalbench, stderr, stdout};

/// Where this variable is set, made pages are written instead of compared.
const UPDATE: &str = "GOALBENCH_UPDATE_DOCS";

/// Pages that are made from the code.
const MADE: [&str; 4] = ["commands", "config", "records", "paper"];

fn help(subject: &[&str]) -> String {
    // The width of help texts follows the terminal's.
    let output = goalbench(&[&["help"], subject].concat());
    assert!(output.status.success(), "{subject:?}: {}", stderr(&output));
    stdout(&output)
}

fn file(id: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs").join(id).with_extension("md")
}

#[test]
fn the_program_prints_the_pages_of_the_repository() {
    let list = help(&["help"]);
    let rows = list.split_once("Pages:\n").expect("a list of pages").1;
    let ids: Vec<&str> = rows.lines().filter_map(|row| row.split_whitespace().next()).collect();
    assert!(ids.len() >= 15 && MADE.iter().all(|id| ids.contains(id)), "{ids:?}");
    for id in ids {
        let printed = help(&[id]);
        if MADE.contains(&id) && std::env::var_os(UPDATE).is_some() {
            std::fs::write(file(id), &printed).expect("the page can be written");
        }
        let page = std::fs::read_to_string(file(id)).expect("a page for every row");
        assert_eq!(page, printed, "harness/docs/{id}.md is old: run this test with {UPDATE}=1 once");
    }
}

#[test]
fn every_command_and_option_is_on_its_page() {
    let page = help(&["commands"]);
    for expected in ["## `goalbench run`", "--lanes", "--smallest-effect", "## `goalbench regress check`"] {
        assert!(page.contains(expected), "{expected}");
    }
    for hidden in ["worker", "try-cuda", "measure-runs"] {
        assert!(!page.contains(&format!("goalbench {hidden}")), "{hidden} is for the program itself");
    }
}

#[test]
fn every_field_of_a_runs_files_is_explained() {
    let folder = tempfile::tempdir().expect("a folder");
    let measured = ["--set", "frontier.every=2", "--set", "frontier.episodes=1", "--shadow", "procurl,plr"];
    support::toy(folder.path(), &measured);
    let run = folder.path().join("runs/Point/teach/default/seed-0");
    let page = help(&["records"]);
    for (name, least) in [
        ("manifest.json", 5),
        ("records.jsonl", 12),
        ("teaching.jsonl", 8),
        ("student.jsonl", 9),
        ("frontier.jsonl", 6),
        ("shadow.jsonl", 4),
        ("timing.jsonl", 6),
        ("outcome.json", 1),
    ] {
        let section = page.split(&format!("\n## {name}\n")).nth(1).expect("a section");
        let section = section.split("\n## ").next().expect("its text");
        let text = std::fs::read_to_string(run.join(name)).expect("the run wrote it");
        let first = if name.ends_with('l') { text.lines().next().unwrap_or_default() } else { &text };
        let object: serde_json::Map<String, serde_json::Value> =
            serde_json::from_str(first).expect("an object");
        assert!(object.len() >= least, "{name}: {}", object.len());
        for field in object.keys().filter(|field| *field != "status") {
            let row = section.lines().find(|line| {
                line.starts_with(&format!("| `{field}` |")) || line.starts_with(&format!("| `{field}."))
            });
            let row = row.unwrap_or_else(|| panic!("{name}: {field} has no row"));
            assert!(row.split('|').nth(3).is_some_and(|meaning| meaning.trim().len() > 3), "{row}");
        }
    }
}

#[test]
fn what_the_paper_claims_and_leaves_open_has_a_row() {
    let page = help(&["paper"]);
    let rows = page.lines().filter(|line| line.starts_with("| ")).count();
    // 18 claims, some 30 deviations, two headings.
    assert!(rows > 40, "{rows}");
    assert!(
        page.contains(
            "| `final` | Figures 2 and 6 | TEACH reaches a higher final success than each baseline"
        )
    );
    assert!(page.contains("| SPaCE's growth of the goal set |"));
}
