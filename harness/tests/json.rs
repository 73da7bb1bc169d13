//! The page `harness/docs/json.md` against what commands print with `--json`.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::Path;

use serde_json::Value;
use support::{goalbench, stderr, stdout, toy};

const PAGE: &str = include_str!("../docs/json.md");

/// A row of the page.
struct Row {
    path: String,
    types: Vec<String>,
    always: bool,
}

impl Row {
    fn is_of(&self, path: &str) -> bool {
        let (ours, theirs): (Vec<_>, Vec<_>) = (self.path.split('.').collect(), path.split('.').collect());
        let fits = |(ours, theirs): (&&str, &&str)| {
            ours == theirs || ours.strip_prefix('*').is_some_and(|end| end == list_ends(theirs))
        };
        ours.len() == theirs.len() && ours.iter().zip(&theirs).all(fits)
    }
}

/// The `[]` at the end of a name.
fn list_ends(name: &str) -> &str {
    name.find("[]").map_or("", |at| &name[at..])
}

/// The rows of the section under `heading`.
fn rows(heading: &str) -> Vec<Row> {
    let (_, section) = PAGE.split_once(&format!("\n## {heading}\n")).expect(heading);
    let section = section.split("\n## ").next().expect("a first part");
    let rows: Vec<Row> = section
        .lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line.strip_prefix("| `")?.split(" | ").collect();
            let types = cells[1].trim_matches(['[', ']']);
            Some(Row {
                path: cells[0].trim_end_matches('`').to_owned(),
                types: types.replace("true or false", "flag").split(" or ").map(str::to_owned).collect(),
                always: !cells[1].starts_with('['),
            })
        })
        .collect();
    assert!(!rows.is_empty(), "{heading}");
    rows
}

/// Every field in `value` with its type.
fn fields(value: &Value, path: &str, found: &mut Vec<(String, &'static str)>) {
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "flag",
        Value::Number(_) => "number",
        Value::String(_) => "text",
        Value::Array(_) => "list",
        Value::Object(_) => "object",
    };
    if !path.is_empty() {
        found.push((path.to_owned(), kind));
    }
    match value {
        Value::Array(items) => items.iter().for_each(|item| fields(item, &format!("{path}[]"), found)),
        Value::Object(object) => {
            for (name, value) in object {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                fields(value, &path, found);
            }
        }
        _ => {}
    }
}

/// Checks that the page names every field of `outputs` with its type, and that every field that it says is
/// always there is there.
fn check(heading: &str, outputs: &[Value]) {
    let rows = rows(heading);
    for output in outputs {
        let mut found = Vec::new();
        fields(output, "", &mut found);
        for (path, kind) in &found {
            // What lies within a value of any type is not the page's business.
            let is_inner = |row: &&Row| row.types == ["any"] && path.starts_with(row.path.as_str());
            if rows.iter().any(|row| is_inner(&row)) {
                continue;
            }
            // A list item that is an object, and the list itself, stand in rows of their own or of their
            // fields.
            let row = rows.iter().find(|row| row.is_of(path));
            let Some(row) = row else {
                let has_fields = rows.iter().any(|row| row.path.starts_with(&format!("{path}.")));
                assert!(*kind == "object" && has_fields, "{heading}: `{path}` ({kind}) is not on the page");
                continue;
            };
            let fits = row.types.iter().any(|known| known == kind || known == "any");
            assert!(fits, "{heading}: `{path}` is {kind}, and on the page {:?}", row.types);
        }
        for row in rows.iter().filter(|row| row.always) {
            assert!(
                found.iter().any(|(path, _)| row.is_of(path)),
                "{heading}: `{}` is on the page and not printed",
                row.path
            );
        }
    }
}

/// The JSON that `args` print: one value, or one for each line.
fn printed(args: &[&str]) -> Vec<Value> {
    let output = goalbench(args);
    let text = stdout(&output);
    let whole = serde_json::from_str(&text).map(|value| vec![value]);
    whole.unwrap_or_else(|_| {
        let each = text.lines().map(|line| {
            serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}; {}", stderr(&output)))
        });
        each.collect()
    })
}

#[test]
fn the_page_tells_what_commands_print() {
    check("goalbench list --json", &printed(&["list", "--json"]));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results");
    let out = results.to_str().expect("a test path is UTF-8");
    toy(&results, &["--seeds", "0"]);
    check("goalbench status --json", &printed(&["status", out, "--json"]));
    check("goalbench evaluate --json", &printed(&["evaluate", out, "--episodes", "5", "--json"]));
    let other = folder.path().join("other");
    let events = printed(&support::toy_args(&other, &["--seeds", "0", "--json"]));
    assert!(events.iter().any(|event| event["event"] == "evaluated") && events.len() > 6);
    check("goalbench run --json", &events);
    let traces = folder.path().join("traces");
    std::fs::create_dir(&traces).expect("a folder can be made");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../envs/tests/golden/FetchReach.json.gz");
    std::fs::copy(golden, traces.join("FetchReach.json.gz")).expect("a trace can be copied");
    std::fs::write(traces.join("Broken.json.gz"), "no trace").expect("a file can be written");
    let traces = traces.to_str().expect("a test path is UTF-8");
    check("goalbench verify --json", &printed(&["verify", traces, "--json"]));
}

#[test]
fn the_page_tells_what_profiles_and_the_gate_print() {
    let profile = ["profile", "--env", "Point", "--curriculum", "teach", "--cycles", "1", "--json"];
    let small = ["--set", "student.batch=8", "--set", "student.width=8"];
    let profile = [&profile[..], &small].concat();
    check("goalbench profile --json", &printed(&profile));
    let beside = [&profile[..], &["--beside", "2", "--rounds", "1"]].concat();
    check("goalbench profile --beside --json", &printed(&beside));
    let lanes = [&profile[..], &["--lanes", "2", "--rounds", "1"]].concat();
    check("goalbench profile --lanes --json", &printed(&lanes));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name).to_str().expect("a test path is UTF-8").to_owned();
    let (protocol, baseline) = (place("p.toml"), place("b.json"));
    let text = "name = 'x'\nenvironments = ['Point']\ncurricula = ['her-iid']\nseeds = '0..2'\n\
                budget.steps = 400\nstudent = { batch = 8, width = 8 }\n";
    std::fs::write(&protocol, text).expect("a protocol can be written");
    let output = goalbench(&["regress", "record", &protocol, "--out", &baseline]);
    assert!(output.status.success(), "{}", stderr(&output));
    check(
        "goalbench regress check --json",
        &printed(&["regress", "check", "--baseline", &baseline, "--exact", "--json"]),
    );
}
