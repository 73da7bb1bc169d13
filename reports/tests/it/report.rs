//! Reports as a whole: what is written, from complete and from partial results, and always the same bytes.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::support::{key, options, seal, write_run};
use reports::ReportError;
use reports::ReportOptions;
use reports::analysis::options::Bands;
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
    write_run(path, &key("RoomA", "nova", "default", 0), &[0.0, 0.5, 1.0, 1.0]);
    write_run(path, &key("RoomA", "nova", "default", 1), &[0.0, 0.25, 0.5, 0.75]);
    write_run(path, &key("RoomA", "dull", "default", 0), &[0.0, 0.0, 0.25, 0.25]);
    write_run(path, &key("RoomB", "nova", "n=3", 0), &[0.1, 0.4, 0.9]);
    let running = write_run(path, &key("RoomB", "nova", "n=3", 1), &[0.3, 0.6]);
    fs::remove_file(running.join(layout::OUTCOME)).unwrap();
    write_run(path, &key("RoomB", "my|own *teacher*", "default", 0), &[0.05]);
    results
}

#[test]
fn tables_by_hand() {
    let results = small_results();
    reports::write(results.path(), &ReportOptions { window: 2, ..options() }).unwrap();
    let report = layout::report_dir(results.path());
    insta::assert_snapshot!("summary.md", fs::read_to_string(report.join("summary.md")).unwrap());
    insta::assert_snapshot!("summary.csv", fs::read_to_string(report.join("summary.csv")).unwrap());
}

#[test]
fn all_files_are_written_and_returned() {
    let results = small_results();
    let written = reports::write(results.path(), &options()).unwrap();
    let report = layout::report_dir(results.path());
    let mut names: Vec<&str> =
        written.files.iter().map(|file| file.strip_prefix(&report).unwrap().to_str().unwrap()).collect();
    names.sort_unstable();
    let expected = [
        "DATA.md",
        "aggregates.csv",
        "agreement.csv",
        "calibration.csv",
        "comparisons.csv",
        "costs.csv",
        "coverage.csv",
        "environments.csv",
        "figures/gradient-steps-RoomA.png",
        "figures/gradient-steps-RoomA.svg",
        "figures/gradient-steps-RoomB.png",
        "figures/gradient-steps-RoomB.svg",
        "figures/grid-gradient-steps.png",
        "figures/grid-gradient-steps.svg",
        "figures/grid-hours.png",
        "figures/grid-hours.svg",
        "figures/grid.png",
        "figures/grid.svg",
        "figures/hours-RoomA.png",
        "figures/hours-RoomA.svg",
        "figures/hours-RoomB.png",
        "figures/hours-RoomB.svg",
        "figures/success-RoomA.png",
        "figures/success-RoomA.svg",
        "figures/success-RoomB.png",
        "figures/success-RoomB.svg",
        "files.txt",
        "frontier.csv",
        "index.html",
        "judgements.csv",
        "judgements.parquet",
        "ledger-elsewhere.csv",
        "ledger.csv",
        "measures.csv",
        "measures.parquet",
        "progress.csv",
        "readings.csv",
        "records.csv",
        "records.parquet",
        "reliability.csv",
        "reliability.parquet",
        "runs.csv",
        "runs.parquet",
        "sensitivity.csv",
        "shadows.csv",
        "shadows.parquet",
        "student.csv",
        "student.parquet",
        "summary.csv",
        "summary.md",
        "tables/citations.tex",
        "tables/comparisons.tex",
        "tables/costs.tex",
        "tables/deviations.tex",
        "tables/ledger.tex",
        "tables/options.tex",
        "tables/summary.tex",
        "tables/variants.tex",
        "teaching.csv",
        "trials.csv",
        "trials.parquet",
        "tuning.csv",
        "tuning.parquet",
        "variants.csv",
    ];
    assert_eq!(names, expected);
    assert_eq!(content(results.path()).keys().collect::<Vec<_>>(), expected);
    assert_eq!((written.runs, written.evaluations, written.problems.len()), (6, 18, 0));
}

#[test]
fn methods_are_summed_up_over_environments_that_all_share() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for (environment, nova, wren) in
        [("RoomA", [0.9, 0.8, 1.0], [0.5, 0.2, 0.3]), ("RoomB", [0.4, 0.4, 0.4], [0.6, 0.4, 0.2])]
    {
        for (seed, (nova, wren)) in (0..).zip(nova.into_iter().zip(wren)) {
            write_run(path, &key(environment, "nova", "default", seed), &[0.0, nova]);
            write_run(path, &key(environment, "wren", "default", seed), &[0.0, wren]);
        }
    }
    write_run(path, &key("RoomC", "nova", "default", 0), &[0.0, 1.0]);
    reports::write(path, &ReportOptions { window: 1, ..options() }).unwrap();
    let report = layout::report_dir(path);
    insta::assert_snapshot!("shared summary.md", fs::read_to_string(report.join("summary.md")).unwrap());
    assert!(report.join("figures/profiles.svg").is_file() && report.join("figures/profiles.png").is_file());
    insta::assert_snapshot!("aggregates.csv", fs::read_to_string(report.join("aggregates.csv")).unwrap());
    insta::assert_snapshot!("comparisons.csv", fs::read_to_string(report.join("comparisons.csv")).unwrap());
}

/// Leaves a copy of a protocol in the results.
fn copy_protocol(results: &Path, name: &str, text: &str) {
    let folder = layout::protocols_dir(results);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), text).unwrap();
}

#[test]
fn only_results_of_the_papers_protocols_owe_it_something() {
    let results = small_results();
    let of_the_paper = |options: &ReportOptions| {
        let written = reports::write(results.path(), options).unwrap();
        written.missing.iter().filter(|line| line.contains("of the paper")).count()
    };
    assert_eq!(of_the_paper(&options()), 0, "made by nobody knows what");
    copy_protocol(results.path(), "own.toml", "name = 'own'\ndescription = 'Of my own.'");
    assert_eq!(of_the_paper(&options()), 0);
    copy_protocol(results.path(), "paper.toml", "name = 'made-up paper'");
    // Methods, environments and two ablations: RoomB has a level of n, but no other one beside it.
    assert_eq!(of_the_paper(&options()), 5);
    let part = ReportOptions { environments: vec!["RoomA".into()], ..options() };
    assert_eq!(of_the_paper(&part), 0, "a part of the results");
}

#[test]
fn reports_are_named_after_their_protocols_and_say_of_what_they_are() {
    let results = small_results();
    copy_protocol(results.path(), "a.toml", "name = 'rooms <&>'\ndescription = 'Two rooms.'\nseeds = [0]");
    copy_protocol(results.path(), "a-2.toml", "name = 'rooms <&>'\ndescription = 'Two rooms.'\nseeds = [1]");
    copy_protocol(results.path(), "b.toml", "name = 'second'");
    copy_protocol(results.path(), "c.toml", "name = ");
    let written = reports::write(results.path(), &options()).unwrap();
    let report = layout::report_dir(results.path());
    let read = |name: &str| fs::read_to_string(report.join(name)).unwrap();
    assert!(
        read("index.html").contains(
            "<h1>rooms &lt;&amp;&gt;, second</h1>\n<p>Protocol rooms &lt;&amp;&gt;: Two rooms.</p>"
        )
    );
    assert!(
        read("summary.md").starts_with("# rooms \\<\\&\\>, second\n\nProtocol rooms"),
        "{}",
        read("summary.md")
    );
    let [problem] = &written.problems[..] else { panic!("{:?}", written.problems) };
    assert!(problem.to_string().starts_with("protocols/c.toml: "), "{problem}");

    let part = ReportOptions {
        environments: vec!["RoomA".into()],
        curricula: vec!["nova".into()],
        title: Some("My rooms".into()),
        zoom: true,
        ..options()
    };
    let written = reports::write(results.path(), &part).unwrap();
    assert_eq!(written.runs, 2);
    let said = "Only the environments RoomA and the curricula nova: 2 of the 6 runs of the results.";
    for text in [read("index.html"), read("summary.md")] {
        assert!(text.contains(said) && text.contains("My rooms") && !text.contains("RoomB"), "{text}");
    }
    let missing = ReportOptions { curricula: vec!["nova".into(), "Nova".into()], ..options() };
    let error = reports::write(results.path(), &missing).unwrap_err().to_string();
    assert_eq!(error, "--curricula: no run of the results has Nova; accepted: dull, my|own *teacher*, nova");
}

#[test]
fn the_report_says_what_each_variant_is() {
    let results = TempDir::new().unwrap();
    for (variants, seed) in
        [(vec!["default", "n=3", "n=3,confidence=target-critic"], 0), (vec!["delta=1"], 1)]
    {
        let experiment = Experiment {
            environments: vec!["RoomA".into(), "RoomB".into()],
            curricula: vec!["nova".into()],
            variants: variants.into_iter().map(String::from).collect(),
            seeds: 2,
            evaluations: 3,
            seed,
            ..Experiment::default()
        };
        experiment.write(results.path()).unwrap();
    }
    reports::write(results.path(), &options()).unwrap();
    let report = layout::report_dir(results.path());
    let expected = "variant,settings,curricula,environments\n\
                    delta=1,nothing: the same as default,NOVA,\"RoomA, RoomB\"\n\
                    n=3,curriculum.nova.window = 3 (10),NOVA,\"RoomA, RoomB\"\n\
                    \"n=3,confidence=target-critic\",curriculum.nova.confidence = target-critic (online); \
                    curriculum.nova.window = 3 (10),NOVA,\"RoomA, RoomB\"\n";
    assert_eq!(fs::read_to_string(report.join("variants.csv")).unwrap(), expected);
    let page = fs::read_to_string(report.join("index.html")).unwrap();
    assert!(page.contains("<section id=\"variants\">") && page.contains("curriculum.nova.window = 3 (10)"));
}

#[test]
fn what_is_missing_is_said() {
    let results = small_results();
    copy_protocol(results.path(), "paper.toml", "name = 'made-up paper'");
    let missing = reports::write(results.path(), &options()).unwrap().missing;
    let expected = [
        "RoomA: NOVA (n=3) has no evaluation",
        "RoomA: my|own *teacher* has no evaluation",
        "RoomB: NOVA has no evaluation",
        "RoomB: NOVA (n=3): 1 of 2 runs not finished",
        "RoomB: DULL has no evaluation",
    ];
    for text in expected {
        assert!(missing.iter().any(|other| other == text), "{text}: {missing:#?}");
    }
    assert!(missing.contains(&"RoomA: DULL lacks seed 1".to_owned()), "{missing:#?}");
    assert!(
        missing.contains(
            &"Figure 4 of the paper: no variants differ in curriculum.nova.window alone".to_owned()
        )
    );
}

#[test]
fn runs_without_an_evaluation_are_counted() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    write_run(path, &key("RoomA", "nova", "default", 0), &[0.0, 1.0]);
    let begun = [("nova", 1, 1), ("nova", 2, 0), ("nova", 3, 0), ("nova", 4, 0), ("wren", 0, 0)];
    for (curriculum, seed, evaluations) in begun {
        let folder = write_run(path, &key("RoomA", curriculum, "default", seed), &[0.0][..evaluations]);
        for name in [layout::OUTCOME, layout::CHECKSUMS] {
            fs::remove_file(folder.join(name)).unwrap();
        }
    }
    let missing = reports::write(path, &options()).unwrap().missing;
    for text in [
        "RoomA: NOVA: 4 of 5 runs not finished",
        "RoomA: NOVA: no evaluation yet of seeds 2, 3, 4",
        "RoomA: WREN has no evaluation",
    ] {
        assert!(missing.iter().any(|other| other == text), "{text}: {missing:#?}");
    }
    assert!(!missing.iter().any(|text| text.contains("lacks seed")), "{missing:#?}");
}

#[test]
fn the_same_results_give_the_same_bytes() {
    let experiment = Experiment {
        environments: vec!["RoomB".into(), "RoomA".into()],
        evaluations: 11,
        seeds: 3,
        ..Experiment::default()
    };
    let (first, second) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    for results in [&first, &second] {
        experiment.write(results.path()).unwrap();
        reports::write(results.path(), &options()).unwrap();
    }
    let once = content(first.path());
    assert_eq!(once, content(second.path()));
    reports::write(first.path(), &options()).unwrap();
    assert_eq!(once, content(first.path()));
}

#[test]
fn figures_of_environments_that_are_gone_do_not_stay() {
    let results = small_results();
    reports::write(results.path(), &options()).unwrap();
    let figures = layout::report_dir(results.path()).join("figures");
    assert!(figures.join("success-RoomB.svg").exists());
    fs::remove_dir_all(layout::runs_dir(results.path()).join("RoomB")).unwrap();
    reports::write(results.path(), &options()).unwrap();
    let left = fs::read_dir(figures).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let left: Vec<String> = left.collect();
    assert!(left.contains(&"success-RoomA.svg".to_owned()), "{left:?}");
    assert!(left.iter().all(|name| !name.contains("RoomB")), "{left:?}");
}

#[test]
fn bands_are_those_that_were_asked_for() {
    let results = small_results();
    let grid = |bands| {
        reports::write(results.path(), &ReportOptions { bands, ..options() }).unwrap();
        content(results.path())["figures/success-RoomA.svg"].clone()
    };
    let drawn = Bands::ALL.map(grid);
    assert!(drawn[0] != drawn[1] && drawn[1] != drawn[2] && drawn[2] != drawn[0]);
    assert_eq!(drawn[0], grid(Bands::default()));
}

#[test]
fn problems_are_returned_and_listed() {
    let results = small_results();
    let folder = layout::run_dir(results.path(), &key("RoomA", "nova", "default", 0));
    let records = folder.join(layout::RECORDS);
    fs::write(&records, fs::read_to_string(&records).unwrap() + "{\"half").unwrap();
    seal(&folder);
    let written = reports::write(results.path(), &options()).unwrap();
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
    write_run(results.path(), &key("E", "nova", "default", 0), &[]);
    let error = reports::write(results.path(), &options()).unwrap_err();
    assert!(matches!(error, ReportError::NoRecords { runs: 1, .. }), "{error}");
    assert!(!layout::report_dir(results.path()).exists());
}
