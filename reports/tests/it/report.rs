//! Reports as a whole: what is written, from complete and from partial results, and always the same bytes.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::support::{key, write_run};
use reports::ReportError;
use reports::report::{self, Options};
use reports::store::layout;
use reports::synthetic::Experiment;
use tempfile::TempDir;

/// Content of every file of the report, by path within it.
fn content(results: &Path) -> BTreeMap<String, Vec<u8>> {
    let report = layout::report_dir(results);
    let mut files = BTreeMap::new();
    for folder in [report.clone(), report.join("figures"), report.join("tables")] {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                let name = path.strip_prefix(&report).unwrap().to_str().unwrap().to_owned();
                files.insert(name, fs::read(path).unwrap());
            }
        }
    }
    files
}

/// Two environments, of which one has a curve with runs of different length.
fn small_results() -> TempDir {
    let results = TempDir::new().unwrap();
    let path = results.path();
    write_run(path, &key("MazeA", "teach", "default", 0), &[0.0, 0.5, 1.0, 1.0]);
    write_run(path, &key("MazeA", "teach", "default", 1), &[0.0, 0.25, 0.5, 0.75]);
    write_run(path, &key("MazeA", "her-iid", "default", 0), &[0.0, 0.0, 0.25, 0.25]);
    write_run(path, &key("MazeB", "teach", "n=3", 0), &[0.1, 0.4, 0.9]);
    let running = write_run(path, &key("MazeB", "teach", "n=3", 1), &[0.3, 0.6]);
    fs::remove_file(running.join(layout::OUTCOME)).unwrap();
    write_run(path, &key("MazeB", "my|own *teacher*", "default", 0), &[0.05]);
    results
}

#[test]
fn tables_by_hand() {
    let results = small_results();
    report::write(results.path(), &Options { window: 2, ..Options::default() }).unwrap();
    let report = layout::report_dir(results.path());
    insta::assert_snapshot!("summary.md", fs::read_to_string(report.join("summary.md")).unwrap());
    insta::assert_snapshot!("summary.csv", fs::read_to_string(report.join("summary.csv")).unwrap());
}

#[test]
fn all_files_are_written_and_returned() {
    let results = small_results();
    let written = report::write(results.path(), &Options::default()).unwrap();
    let report = layout::report_dir(results.path());
    let mut names: Vec<&str> =
        written.files.iter().map(|file| file.strip_prefix(&report).unwrap().to_str().unwrap()).collect();
    names.sort_unstable();
    let expected = [
        "DATA.md",
        "aggregates.csv",
        "comparisons.csv",
        "costs.csv",
        "environments.csv",
        "figures/gradient-steps-MazeA.png",
        "figures/gradient-steps-MazeA.svg",
        "figures/gradient-steps-MazeB.png",
        "figures/gradient-steps-MazeB.svg",
        "figures/grid-gradient-steps.png",
        "figures/grid-gradient-steps.svg",
        "figures/grid-hours.png",
        "figures/grid-hours.svg",
        "figures/grid.png",
        "figures/grid.svg",
        "figures/hours-MazeA.png",
        "figures/hours-MazeA.svg",
        "figures/hours-MazeB.png",
        "figures/hours-MazeB.svg",
        "figures/success-MazeA.png",
        "figures/success-MazeA.svg",
        "figures/success-MazeB.png",
        "figures/success-MazeB.svg",
        "files.txt",
        "index.html",
        "ledger.csv",
        "readings.csv",
        "records.csv",
        "records.parquet",
        "runs.csv",
        "runs.parquet",
        "summary.csv",
        "summary.md",
        "tables/comparisons.tex",
        "tables/costs.tex",
        "tables/deviations.tex",
        "tables/ledger.tex",
        "tables/summary.tex",
        "teaching.csv",
    ];
    assert_eq!(names, expected);
    assert_eq!(content(results.path()).keys().collect::<Vec<_>>(), expected);
    assert_eq!((written.runs, written.evaluations, written.problems.len()), (6, 18, 0));
}

#[test]
fn methods_are_summed_up_over_environments_that_all_share() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for (environment, teach, vds) in
        [("MazeA", [0.9, 0.8, 1.0], [0.5, 0.2, 0.3]), ("MazeB", [0.4, 0.4, 0.4], [0.6, 0.4, 0.2])]
    {
        for (seed, (teach, vds)) in (0..).zip(teach.into_iter().zip(vds)) {
            write_run(path, &key(environment, "teach", "default", seed), &[0.0, teach]);
            write_run(path, &key(environment, "vds", "default", seed), &[0.0, vds]);
        }
    }
    write_run(path, &key("MazeC", "teach", "default", 0), &[0.0, 1.0]);
    report::write(path, &Options { window: 1, ..Options::default() }).unwrap();
    let report = layout::report_dir(path);
    insta::assert_snapshot!("shared summary.md", fs::read_to_string(report.join("summary.md")).unwrap());
    assert!(report.join("figures/profiles.svg").is_file() && report.join("figures/profiles.png").is_file());
    insta::assert_snapshot!("aggregates.csv", fs::read_to_string(report.join("aggregates.csv")).unwrap());
    insta::assert_snapshot!("comparisons.csv", fs::read_to_string(report.join("comparisons.csv")).unwrap());
}

#[test]
fn what_is_missing_is_said() {
    let results = small_results();
    let missing = report::write(results.path(), &Options::default()).unwrap().missing;
    let expected = [
        "MazeA: TEACH (n=3) has no evaluation",
        "MazeA: my|own *teacher* has no evaluation",
        "MazeB: TEACH has no evaluation",
        "MazeB: TEACH (n=3): 1 of 2 runs not finished",
        "MazeB: HER-IID has no evaluation",
    ];
    for text in expected {
        assert!(missing.iter().any(|other| other == text), "{text}: {missing:#?}");
    }
    assert!(missing.contains(&"MazeA: HER-IID lacks seed 1".to_owned()), "{missing:#?}");
    assert!(
        missing.contains(
            &"Figure 4 of the paper: no variants differ in curriculum.teach.window alone".to_owned()
        )
    );
}

#[test]
fn the_same_results_give_the_same_bytes() {
    let experiment = Experiment {
        environments: vec!["MazeB".into(), "MazeA".into()],
        evaluations: 11,
        seeds: 3,
        ..Experiment::default()
    };
    let (first, second) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    for results in [&first, &second] {
        experiment.write(results.path()).unwrap();
        report::write(results.path(), &Options::default()).unwrap();
    }
    let once = content(first.path());
    assert_eq!(once, content(second.path()));
    report::write(first.path(), &Options::default()).unwrap();
    assert_eq!(once, content(first.path()));
}

#[test]
fn figures_of_environments_that_are_gone_do_not_stay() {
    let results = small_results();
    report::write(results.path(), &Options::default()).unwrap();
    let figures = layout::report_dir(results.path()).join("figures");
    assert!(figures.join("success-MazeB.svg").exists());
    fs::remove_dir_all(layout::runs_dir(results.path()).join("MazeB")).unwrap();
    report::write(results.path(), &Options::default()).unwrap();
    let left = fs::read_dir(figures).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let left: Vec<String> = left.collect();
    assert!(left.contains(&"success-MazeA.svg".to_owned()), "{left:?}");
    assert!(left.iter().all(|name| !name.contains("MazeB")), "{left:?}");
}

#[test]
fn problems_are_returned_and_listed() {
    let results = small_results();
    let records = layout::run_dir(results.path(), &key("MazeA", "teach", "default", 0)).join(layout::RECORDS);
    fs::write(&records, fs::read_to_string(&records).unwrap() + "{\"half").unwrap();
    let written = report::write(results.path(), &Options::default()).unwrap();
    assert_eq!(written.problems.len(), 1);
    let summary = fs::read_to_string(layout::report_dir(results.path()).join("summary.md")).unwrap();
    assert!(
        summary.contains("## Problems (1)")
            && summary.contains("seed-0/records.jsonl:5: incomplete last line")
    );
}

#[test]
fn nothing_to_report_is_an_error_that_says_so() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "teach", "default", 0), &[]);
    let error = report::write(results.path(), &Options::default()).unwrap_err();
    assert!(matches!(error, ReportError::NoRecords { runs: 1, .. }), "{error}");
    assert!(!layout::report_dir(results.path()).exists());
}
