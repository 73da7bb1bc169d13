//! What a search was worth, by hand; and that its runs are nowhere else.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::support::{fail, key, line, options, write_configured, write_run};
use reports::schema::{TrialPlace, TrialScore, TunedCurriculum, Tuning, TuningMeasure};
use reports::store::layout;
use serde_json::{Map, Value, json};
use tempfile::TempDir;

/// A trial of two environments, whose two runs in each took 1,000 steps.
fn trial(variant: &str, settings: &Value, scores: [[f64; 2]; 2]) -> TrialScore {
    let place = |(environment, by_seed): (&str, [f64; 2])| TrialPlace {
        environment: environment.into(),
        score: f64::midpoint(by_seed[0], by_seed[1]),
        by_seed: by_seed.to_vec(),
        failed: u64::from(variant == "trial-03"),
        steps: 2_000,
    };
    let places: Vec<TrialPlace> = ["A", "B"].into_iter().zip(scores).map(place).collect();
    let score = places.iter().map(|place| place.score).sum::<f64>() / 2.0;
    let settings: Map<String, Value> = settings.as_object().cloned().unwrap();
    TrialScore { variant: variant.into(), settings, score, places }
}

fn tuning() -> Tuning {
    let untried = |id: &str| TunedCurriculum {
        curriculum: id.into(),
        ranges: vec![],
        chosen: "default".into(),
        reason: "no range is given, so nothing was searched".into(),
        tried: vec![],
    };
    let nova = TunedCurriculum {
        ranges: vec!["curriculum.nova.n: 3, 5 or 10".into()],
        chosen: "trial-02".into(),
        reason: "trial-02 is best".into(),
        tried: vec![
            trial("default", &json!({}), [[0.25, 0.25], [0.5, 0.5]]),
            trial("trial-01", &json!({"curriculum.nova.n": 3}), [[0.0, 0.25], [0.5, 0.5]]),
            trial("trial-02", &json!({"curriculum.nova.n": 10}), [[0.5, 0.75], [0.5, 0.75]]),
            trial("trial-03", &json!({"curriculum.nova.n": 3}), [[0.5, 0.5], [0.0, 0.0]]),
        ],
        ..untried("nova")
    };
    let wren = TunedCurriculum {
        ranges: vec!["student.polyak: 0.5 to 0.9".into()],
        tried: vec![
            trial("default", &json!({}), [[0.5, 0.5], [0.5, 0.5]]),
            trial("trial-01", &json!({"student.polyak": 0.7}), [[0.5, 0.5], [0.25, 0.25]]),
        ],
        ..untried("wren")
    };
    Tuning {
        measure: TuningMeasure::Area,
        search_seed: 0,
        seeds: vec![100, 101],
        trials: 3,
        environments: ["A", "B"].map(String::from).to_vec(),
        curricula: vec![nova, wren, untried("dull")],
    }
}

fn write_choice(results: &Path, text: &str) {
    fs::create_dir_all(layout::tuning_dir(results)).unwrap();
    fs::write(layout::choice_file(results), text).unwrap();
}

/// Fresh runs of three curricula in two environments. Areas of NOVA in A: default 0.25, 0.5, 0.25 and tuned
/// 0.5, 0.75, 0.25.
fn fresh(results: &Path) {
    for environment in ["A", "B"] {
        for (seed, (default, tuned)) in [(0.5, 1.0), (1.0, 1.5), (0.5, 0.5)].into_iter().enumerate() {
            for (curriculum, variant, end) in [
                ("nova", "default", default),
                ("nova", "tuned", tuned),
                ("wren", "default", 0.5),
                ("dull", "default", 0.5),
            ] {
                // Straight up to `end` (at most 1) and flat: 2 · area of two intervals.
                let rates = if end > 1.0 { [0.5, 1.0] } else { [0.0, end] };
                let config = json!({"curriculum": {"nova": {"n": if variant == "tuned" { 10 } else { 5 }}}});
                write_configured(
                    results,
                    &key(environment, curriculum, variant, seed as u64),
                    &rates,
                    config,
                );
            }
        }
    }
}

fn rows(report: &Path, name: &str) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(report.join(name)).unwrap();
    let mut lines = text.lines().map(cells);
    let names = lines.next().unwrap();
    lines.map(|cells| names.iter().cloned().zip(cells).collect()).collect()
}

/// The cells of a line of CSV, where a comma between quotes is text.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            other => cells.last_mut().unwrap().push(other),
        }
    }
    cells
}

#[test]
fn tuned_against_default_by_hand() {
    let results = TempDir::new().unwrap();
    fresh(results.path());
    write_choice(results.path(), &line(&tuning()));
    let written = reports::write(results.path(), &options()).unwrap();
    assert!(written.problems.is_empty(), "{:?}", written.problems);
    let report = layout::report_dir(results.path());
    let table = rows(&report, "tuning.csv");
    let ids: Vec<[&str; 2]> =
        table.iter().map(|row| [row["environment"].as_str(), row["curriculum"].as_str()]).collect();
    assert_eq!(ids.len(), 6);
    let of = |environment: &str, curriculum: &str| {
        table[ids.iter().position(|id| *id == [environment, curriculum]).unwrap()].clone()
    };
    let number = |row: &BTreeMap<String, String>, name: &str| row[name].parse::<f64>().unwrap();
    let nova = of("A", "nova");
    // (0.25 + 0.5 + 0.25) / 3 and (0.5 + 0.75 + 0.25) / 3; differences 0.25, 0.25 and 0.
    assert!((number(&nova, "default_mean") - 1.0 / 3.0).abs() < 1e-12);
    assert!((number(&nova, "tuned_mean") - 0.5).abs() < 1e-12);
    assert!((number(&nova, "tuned_std") - 0.25).abs() < 1e-12);
    assert!((number(&nova, "difference") - 1.0 / 6.0).abs() < 1e-12);
    assert_eq!(
        (nova["n_pairs"].as_str(), nova["chosen"].as_str(), nova["trials"].as_str()),
        ("3", "trial-02", "3")
    );
    // Of 8 sign flips those with a mean as far from 0: both 0.25 of one sign, whatever that of the 0 is.
    assert!((number(&nova, "sign_flip_p") - 0.5).abs() < 1e-12);
    assert_eq!((number(&nova, "difference_ci_low"), number(&nova, "difference_ci_high")), (0.0, 0.25));
    assert_eq!(nova["settings"], "curriculum.nova.n = 10");
    assert_eq!(nova["steps"], "8000", "four settings of two runs of 1,000 steps");
    let wren = of("B", "wren");
    assert_eq!(
        (wren["chosen"].as_str(), wren["tuned_mean"].as_str(), wren["difference"].as_str()),
        ("default", "", "")
    );
    assert_eq!(of("A", "dull")["steps"], "0");
    let spread = rows(&report, "sensitivity.csv");
    assert_eq!(spread.len(), 4, "curricula without ranges have no trials");
    // Trials of NOVA in A: 0.125, 0.625 and 0.5; the default 0.25.
    let nova = spread.iter().find(|row| row["environment"] == "A" && row["curriculum"] == "nova").unwrap();
    let found = ["default", "worst", "median", "best", "share_better"].map(|name| number(nova, name));
    assert_eq!(found, [0.25, 0.125, 0.5, 0.625, 2.0 / 3.0]);
    assert_eq!((nova["distinct"].as_str(), nova["failed"].as_str()), ("2", "1"));
    let trials = rows(&report, "trials.csv");
    assert_eq!(trials.len(), 2 * (4 + 2));
    let chosen: Vec<&str> =
        trials.iter().filter(|row| row["chosen"] == "yes").map(|row| row["trial"].as_str()).collect();
    assert_eq!(chosen, ["trial-02", "default", "trial-02", "default"]);
    for name in ["trials-A.svg", "trials-B.png"] {
        assert!(report.join("figures").join(name).is_file(), "{name}");
    }
    let page = fs::read_to_string(report.join("index.html")).unwrap();
    assert!(page.contains("Tuned against default settings") && page.contains("no trial was better"));
}

#[test]
fn a_failed_run_counts_0_from_its_failure_on_and_an_unfinished_one_not_at_all() {
    let results = TempDir::new().unwrap();
    fresh(results.path());
    write_choice(results.path(), &line(&tuning()));
    let rates = [0.5];
    let config = json!({"curriculum": {"nova": {"n": 10}}});
    fail(&write_configured(results.path(), &key("A", "nova", "tuned", 1), &rates, config));
    let unfinished = layout::run_dir(results.path(), &key("B", "nova", "tuned", 2));
    fs::remove_file(unfinished.join(layout::OUTCOME)).unwrap();
    fs::remove_file(unfinished.join(layout::CHECKSUMS)).unwrap();
    reports::write(results.path(), &options()).unwrap();
    let table = rows(&layout::report_dir(results.path()), "tuning.csv");
    let of = |environment: &str| {
        table.iter().find(|row| row["environment"] == environment && row["curriculum"] == "nova").unwrap()
    };
    // 0.5, then 0: an area of 0.25 in the place of 0.75.
    assert!((of("A")["tuned_mean"].parse::<f64>().unwrap() - 1.0 / 3.0).abs() < 1e-12);
    assert_eq!((of("B")["n_tuned"].as_str(), of("B")["n_pairs"].as_str()), ("2", "2"));
}

/// All files of the report, the tuning's own left out.
fn others(results: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let report = layout::report_dir(results);
    let own = ["tuning", "sensitivity", "trials"];
    // These show everything, the tuning too.
    let whole = ["index.html", "summary.md", "DATA.md", "files.txt"];
    let mut found = BTreeMap::new();
    for entry in walkdir::WalkDir::new(&report).into_iter().map(Result::unwrap) {
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_own = own.iter().any(|own| name.starts_with(own)) || whole.contains(&name.as_str());
        if entry.file_type().is_file() && !is_own {
            found.insert(
                entry.path().strip_prefix(&report).unwrap().to_owned(),
                fs::read(entry.path()).unwrap(),
            );
        }
    }
    found
}

#[test]
fn runs_of_a_search_enter_no_other_table_figure_or_verdict() {
    let results = TempDir::new().unwrap();
    fresh(results.path());
    let before = reports::write(results.path(), &options()).unwrap();
    let without = others(results.path());
    let ledger = |files: &BTreeMap<PathBuf, Vec<u8>>| files[Path::new("ledger.csv")].clone();
    assert!(without.len() > 30 && !ledger(&without).is_empty(), "{}", without.len());
    let folder = layout::tuning_dir(results.path());
    for seed in [100, 101] {
        for variant in ["default", "trial-01", "trial-02", "trial-03"] {
            for environment in ["A", "B"] {
                write_run(&folder, &key(environment, "nova", variant, seed), &[0.0, 0.9, 0.95]);
            }
        }
    }
    let open = reports::write(results.path(), &options()).unwrap();
    assert_eq!((open.runs, open.evaluations), (before.runs, before.evaluations));
    assert_eq!(open.missing.len(), before.missing.len() + 1, "{:?}", open.missing);
    assert!(open.missing.iter().any(|line| line.contains("its trials have not all ended")));
    assert_eq!(others(results.path()), without);
    write_choice(results.path(), &line(&tuning()));
    let chosen = reports::write(results.path(), &options()).unwrap();
    assert_eq!((chosen.runs, chosen.evaluations), (before.runs, before.evaluations));
    assert_eq!(others(results.path()), without);
    // Nor the seeds anywhere but in the tuning's caption and folder.
    let report = layout::report_dir(results.path());
    for name in ["records.csv", "runs.csv", "summary.csv", "comparisons.csv", "trials.csv"] {
        let text = fs::read_to_string(report.join(name)).unwrap();
        assert!(!text.contains(",100,") && !text.contains(",101,"), "{name}");
    }
}

#[test]
fn a_choice_that_is_none_is_named_and_the_rest_reported() {
    let results = TempDir::new().unwrap();
    fresh(results.path());
    let sound = serde_json::to_value(tuning()).unwrap();
    let altered = |pointer: &str, value: Value| {
        let mut json = sound.clone();
        *json.pointer_mut(pointer).unwrap() = value;
        json.to_string()
    };
    for (text, reason) in [
        ("{".to_owned(), "EOF"),
        ("[]".to_owned(), "invalid"),
        (altered("/curricula/0/chosen", json!("trial-09")), "`trial-09` was chosen and not tried"),
        (altered("/curricula/0/tried/1/score", json!(1.5)), "not numbers in [0, 1]"),
        (altered("/curricula/0/tried/1/places/0/by_seed", json!([0.5])), "not numbers in [0, 1]"),
        (altered("/curricula/0/tried/1/places", json!([])), "one for every seed and environment"),
        (altered("/measure", json!("best")), "unknown variant"),
    ] {
        write_choice(results.path(), &text);
        let written = reports::write(results.path(), &options()).unwrap();
        let named: Vec<String> = written.problems.iter().map(ToString::to_string).collect();
        assert_eq!(named.len(), 1, "{named:?}");
        assert!(named[0].starts_with("tuning/choice.json: ") && named[0].contains(reason), "{named:?}");
        assert!(!layout::report_dir(results.path()).join("figures/trials-A.svg").exists());
    }
    let mut empty = tuning();
    empty.curricula.clear();
    write_choice(results.path(), &line(&empty));
    assert!(reports::write(results.path(), &options()).unwrap().problems.is_empty());
}
