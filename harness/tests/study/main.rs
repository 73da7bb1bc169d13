//! The laptop study: its archives hold runs of what was registered, and the tables of its page are made from
//! them.

#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on fails")]

mod sheet;
#[path = "../support/mod.rs"]
mod support;
mod tables;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use goalbench::Registry;
use goalbench::archive;
use goalbench::protocol::plan::{Plan, PlannedRun};
use goalbench::protocol::presets::PRESETS;
use reports::store::Run;
use support::{goalbench, stderr};
use tables::remade;

/// The parts of the study: presets, and names of archives.
const PARTS: [&str; 2] = ["laptop", "laptop-ablations"];

fn archive_of(part: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("study").join(part).with_extension("tar.zst")
}

/// The runs of the preset `part` by their ids.
fn plan(part: &str) -> BTreeMap<String, PlannedRun> {
    let registry = Registry::builtin();
    let preset = PRESETS.iter().find(|preset| preset.id == part).expect("a preset for every part");
    let protocol = preset.protocol(&registry).expect("a preset is valid");
    let runs = Plan::new(&protocol, &registry).expect("a preset is a plan").runs;
    runs.into_iter().map(|run| (run.key.to_string(), run)).collect()
}

/// That `run` is the planned one, and came to its end.
fn assert_is_planned(run: &Run, plan: &BTreeMap<String, PlannedRun>) {
    let planned = plan.get(&run.key().to_string()).expect("a run of the plan");
    let config = serde_json::to_value(&planned.config).expect("a config is plain data");
    assert_eq!(run.manifest.config, config, "{}", run.key());
    assert!(run.is_finished(), "{}", run.key());
}

#[test]
fn what_is_there_of_the_study_is_what_was_registered() {
    for part in PARTS.iter().filter(|part| archive_of(part).exists()) {
        let plan = plan(part);
        let unpacked = archive::unpack(&archive_of(part)).expect(part);
        let runs = unpacked.store.runs();
        assert!(!runs.is_empty(), "{part}");
        runs.iter().for_each(|run| assert_is_planned(run, &plan));
        let program = &runs[0].manifest.versions;
        assert!(
            runs.iter().all(|run| run.manifest.versions["executable"] == program["executable"]),
            "{part}: one program"
        );
    }
}

#[test]
fn tables_of_a_page_say_what_the_report_says() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    support::toy(folder.path(), &["--seeds", "0..3"]);
    let output = goalbench(&["report", folder.path().to_str().expect("a test path is UTF-8")]);
    assert!(output.status.success(), "{}", stderr(&output));
    let report = folder.path().join("report");
    let kinds = ["area toy", "final toy", "steps toy", "comparisons toy", "claims toy area-her-iid window"];
    let empty: Vec<String> = kinds
        .iter()
        .map(|kind| format!("Before.\n\n<!-- table: {kind} -->\nold\n<!-- end of table -->\n"))
        .collect();
    let page = remade(&empty.concat(), |part| {
        assert_eq!(part, "toy");
        report.as_path()
    });
    assert!(!page.contains("old") && page.matches("Before.").count() == kinds.len(), "{page}");
    assert_eq!(remade(&page, |_| report.as_path()), page, "made again it is the same");
    // Numbers by hand from the report's files.
    let csv = fs::read_to_string(report.join("summary.csv")).expect("a table of the report");
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    let teach = lines.find(|row| row.contains(&"teach")).expect("a row of TEACH");
    let field = |name: &str| teach[head.iter().position(|column| *column == name).expect("a column")];
    let number = |name: &str| field(name).parse::<f64>().expect("a number");
    for measure in ["auc", "final"] {
        let mean = number(&format!("{measure}_mean"));
        let cell = format!("| TEACH | {mean:.3} ± {:.3} | {mean:.3} |", number(&format!("{measure}_std")));
        assert!(page.contains(&cell), "{cell} in\n{page}");
    }
    assert!(
        page.contains("| `area-her-iid` | **undecided** |") && page.contains("| `window` | **undecided** |"),
        "{page}"
    );
    assert!(page.contains("| HER-IID | TEACH | Point |"), "{page}");
}
