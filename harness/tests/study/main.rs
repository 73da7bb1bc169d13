//! The laptop study: its archives hold runs of what was registered, and the tables of its page are made from
//! them.

#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

mod beside;
mod cells;
mod differences;
mod part;
mod sheet;
#[path = "../support/mod.rs"]
mod support;
mod tables;
mod verdicts;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use part::{PARTS, Part, report_of};
use reports::store::layout;
use support::{goalbench, stderr};
use tables::{BEGIN, remade};

/// Where this variable is set, the page's tables and its figure are written instead of compared.
const UPDATE: &str = "GOALBENCH_UPDATE_DOCS";

/// The archive of the hard task's runs, one of each method.
const HARD: &str = "push";

/// The page's figures: the part, its report's figure, the page's copy.
const FIGURES: [(&str, &str, &str); 5] = [
    ("laptop", "grid.png", "study.png"),
    ("laptop-ablations", "ablation-window.png", "study-window.png"),
    ("laptop-ablations", "ablation-interplay.png", "study-interplay.png"),
    ("laptop-ablations", "ablation-confidence.png", "study-confidence.png"),
    (HARD, "success-FetchPush.png", "study-push.png"),
];

/// The commit of the program that makes the runs.
const PROGRAM: &str = "6923874e6af0";

/// What the page says as long as runs are missing.
const UNFINISHED: &str = "its runs are being made";

fn doc(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name)
}

#[test]
fn what_is_there_of_the_study_is_what_was_registered() {
    for (name, part) in PARTS.iter().filter_map(|name| Some((name, Part::unpack(name)?))) {
        let runs = part.store.runs();
        assert!(!runs.is_empty(), "{name}");
        runs.iter().for_each(|run| part.assert_is_planned(run));
        for run in runs {
            assert_eq!(run.manifest.versions["commit"], PROGRAM, "{name}: {}", run.key());
        }
    }
}

/// Runs that both parts have are the same, byte for byte.
#[test]
fn both_parts_were_made_by_the_same_program_on_the_same_kind_of_processor() {
    let [Some(one), Some(other)] = PARTS.map(Part::unpack) else { return };
    let mut shared = 0;
    for run in one.store.runs().iter().filter(|run| other.has(run)) {
        let records = |part: &Part| {
            let file = layout::run_dir(&part.results(), run.key()).join(layout::RECORDS);
            fs::read(file).expect("every run has records")
        };
        assert!(records(&one) == records(&other), "{}", run.key());
        shared += 1;
    }
    assert!(shared > 0, "both parts have default runs");
}

/// Before all runs have ended the page reports nothing; then its tables and its figure are those of the data,
/// and an independent program agrees with the numbers.
#[test]
fn the_page_says_what_the_data_say() {
    let page = fs::read_to_string(doc("study.md")).expect("the study's page");
    let parts: Vec<Part> = PARTS.iter().filter_map(|name| Part::unpack(name)).collect();
    if parts.len() < PARTS.len() || !parts.iter().all(Part::is_whole) {
        assert!(page.contains(UNFINISHED) && !page.contains(BEGIN), "a part of the study is not reported");
        return;
    }
    assert!(!page.contains(UNFINISHED) && page.contains(BEGIN), "all runs have ended");
    assert!(parts.iter().map(|part| part.bytes).sum::<u64>() < 10_000_000, "they fit into the repository");
    let reports: Vec<PathBuf> = parts.iter().map(Part::report).collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (hard, hard_sha256) = report_of(HARD, folder.path());
    let report = |name: &str| {
        let part = PARTS.iter().position(|part| *part == name);
        part.map_or_else(
            || {
                assert_eq!(name, HARD, "tables are about a part of the study");
                hard.as_path()
            },
            |index| reports[index].as_path(),
        )
    };
    let remade = remade(&page, report);
    let figures =
        FIGURES.map(|(part, figure, shown)| (report(part).join("figures").join(figure), doc(shown)));
    if std::env::var_os(UPDATE).is_some() {
        fs::write(doc("study.md"), &remade).expect("the page can be written");
        for (drawn, shown) in &figures {
            fs::copy(drawn, shown).expect("the figure can be written");
        }
    }
    let page = fs::read_to_string(doc("study.md")).expect("the study's page");
    assert_eq!(page, remade, "the page is old: run this test with {UPDATE}=1 once");
    for (drawn, shown) in figures {
        let same = fs::read(&drawn).expect("a figure") == fs::read(&shown).expect("a figure");
        assert!(same, "{} is old: run this test with {UPDATE}=1 once", shown.display());
    }
    for sha256 in parts.iter().map(|part| &part.sha256).chain([&hard_sha256]) {
        assert!(page.contains(sha256), "the page names the archives by their checksums: {sha256}");
    }
    parts.iter().for_each(recomputed);
}

/// Compares the numbers of a report with those of a program that shares nothing with it.
fn recomputed(part: &Part) {
    let Some(python) = std::env::var_os("GOALBENCH_POLICY_PYTHON") else {
        println!("skipped: set GOALBENCH_POLICY_PYTHON to a Python that has NumPy");
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("study/check.py");
    let output = Command::new(python).arg(script).arg(part.results()).output().expect("Python starts");
    assert!(output.status.success(), "{}{}", support::stdout(&output), stderr(&output));
}

#[test]
fn tables_of_a_page_say_what_the_report_says() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    support::toy(folder.path(), &["--seeds", "0..3"]);
    let output = goalbench(&["report", folder.path().to_str().expect("a test path is UTF-8")]);
    assert!(output.status.success(), "{}", stderr(&output));
    let report = folder.path().join("report");
    let kinds = [
        "area toy",
        "final toy",
        "steps toy",
        "single toy",
        "choice toy",
        "mastery toy",
        "price toy",
        "comparisons toy",
        "claims toy area-her-iid window",
        "beside toy teach her-iid",
        "pairs toy her-iid teach",
        "each toy teach her-iid",
        "across toy toy her-iid default",
    ];
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
    let csv = fs::read_to_string(report.join("runs.csv")).expect("a table of the report");
    assert_eq!(page.matches("| 400 |").count(), csv.lines().count() - 1, "every run has its row\n{page}");
    assert!(
        page.contains("| `area-her-iid`: TEACH learns faster than HER-IID")
            && page.contains("| `window`: Final"),
        "{page}"
    );
    assert!(page.contains("| HER-IID | Point |"), "{page}");
    // The same pairs, whichever table they are in; the difference changes its sign with the order.
    let ours = page.split("| HER-IID | all pairs | ").nth(1).and_then(|rest| rest.split(' ').next());
    let ours = ours.expect("a difference");
    assert!(page.contains(&format!("| `default` | {ours} |")), "{ours} in\n{page}");
    assert!(page.contains(&format!("| HER-IID | {ours} ")), "{ours} in\n{page}");
    let theirs = -ours.parse::<f64>().expect("a number");
    assert!(page.contains(&format!("| HER-IID | TEACH | {theirs:+.3} |")), "{ours} in\n{page}");
    assert!(page.contains("| HER-IID | all pairs |") && page.contains("| HER-IID | whole seeds |"), "{page}");
}
