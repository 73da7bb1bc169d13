//! Verdicts under several readings of the paper: which groups are readings, what they are set against, what
//! is said.

use std::fs;
use std::path::Path;

use super::ledger::judging;
use super::support::{key, options, write_configured};
use reports::ReportOptions;
use reports::analysis::group;
use reports::analysis::ledger::{LedgerEntry, Verdict};
use reports::analysis::readings::{JudgedClaim, ReadingFamily, Readings};
use reports::store::Store;
use reports::store::layout;
use reports::synthetic::catalogue;
use serde_json::{Value, json};
use tempfile::TempDir;

/// A config of NOVA with these settings, and the goals of its evaluations.
fn nova(settings: &Value, goals: &str) -> Value {
    json!({"evaluation": {"goals": goals}, "curriculum": {"nova": settings}})
}

fn baseline(curriculum: &str, goals: &str) -> Value {
    json!({"evaluation": {"goals": goals}, "curriculum": {curriculum: {}}})
}

/// Seeds 0 to 6 of a group that end at about `rate`.
pub(crate) fn write(
    results: &Path,
    environment: &str,
    curriculum: &str,
    variant: &str,
    rate: f64,
    config: &Value,
) {
    for seed in 0..7_u32 {
        let run = key(environment, curriculum, variant, seed.into());
        write_configured(results, &run, &[0.0, rate + 0.005 * f64::from(seed % 3)], config.clone());
    }
}

/// NOVA with two ways to select, DULL, and both on evaluation goals of the environment and of the pool.
fn write_four(results: &Path, environment: &str) {
    let select = |selection: &str| json!({"window": 10, "selection": selection});
    for (goals, variant, easier) in [("environment", "", 0.0), ("pool", ",pool", 0.1)] {
        let label = |name: &str| format!("{name}{variant}").trim_start_matches("default,").to_owned();
        let write = |curriculum: &str, name: &str, rate: f64, config: &Value| {
            write(results, environment, curriculum, &label(name), rate + easier, config);
        };
        write("nova", "default", 0.7, &nova(&select("proportional"), goals));
        write("nova", "argmax", 0.4, &nova(&select("argmax"), goals));
        write("dull", "default", 0.4, &baseline("dull", goals));
    }
}

pub(crate) fn readings(results: &Path) -> Readings {
    let store = Store::read(results).unwrap();
    Readings::of(&group::groups(&store, &catalogue()), &judging())
}

/// The one family that there is, that of the default settings.
pub(crate) fn family(results: &Path) -> ReadingFamily {
    let [family] = <[ReadingFamily; 1]>::try_from(readings(results).families).unwrap();
    assert_eq!((family.name.as_str(), family.at()), ("", None));
    family
}

pub(crate) fn claim<'a>(family: &'a ReadingFamily, id: &str) -> &'a JudgedClaim {
    family.claims.iter().find(|claim| claim.judged[0].1.id == id).unwrap()
}

pub(crate) fn names(family: &ReadingFamily) -> Vec<String> {
    (1..=family.readings.len()).map(|number| family.reading(number)).collect()
}

#[test]
fn a_verdict_that_hangs_on_a_choice_is_named_by_it() {
    let results = TempDir::new().unwrap();
    for environment in ["RoomA", "RoomB"] {
        write_four(results.path(), environment);
    }
    let found = family(results.path());
    // The window is the same everywhere and no choice of the paper's reader: not named.
    let expected = [
        "selection = proportional, evaluation goals = environment",
        "selection = argmax, evaluation goals = environment",
        "selection = argmax, evaluation goals = pool",
        "selection = proportional, evaluation goals = pool",
    ];
    assert_eq!(names(&found), expected);
    let ids: Vec<&str> = found.claims.iter().map(|claim| claim.judged[0].1.id.as_str()).collect();
    assert_eq!(ids, ["final-dull", "area-dull"], "baselines that are there");
    let claim = claim(&found, "final-dull");
    let verdicts: Vec<(usize, Verdict)> = claim.judged.iter().map(|(n, entry)| (*n, entry.verdict)).collect();
    let (yes, open) = (Verdict::Confirmed, Verdict::Undecided);
    assert_eq!(verdicts, [(1, yes), (2, open), (3, open), (4, yes)]);
    // Against the runs with the same goals: against the others it would be 0.4 and 0.1, or 0.2 and -0.1.
    let differences: Vec<f64> =
        claim.judged.iter().map(|(_, entry)| entry.effect.difference.unwrap()).collect();
    for (difference, expected) in differences.iter().zip([0.3, 0.0, 0.0, 0.3]) {
        assert!((difference - expected).abs() < 1e-9, "{differences:?}");
    }
    // Four readings share a miss of 0.05; two environments of seven pairs, all of one sign.
    assert!(claim.judged.iter().all(|(_, entry)| (entry.confidence - 0.9875).abs() < 1e-12));
    assert_eq!(claim.judged[0].1.effect.p, Some(2_f64.powi(-13)));
    let expected =
        "hangs on the reading: confirmed under selection = proportional, undecided under selection = argmax";
    assert_eq!(claim.conclusion, expected);
    assert!(claim.hangs());
}

#[test]
fn readings_are_judged_as_the_ledger_judges() {
    let results = TempDir::new().unwrap();
    write_four(results.path(), "RoomA");
    let store = Store::read(results.path()).unwrap();
    let groups = group::groups(&store, &catalogue());
    let ledger: Vec<LedgerEntry> = reports::analysis::ledger::ledger(&groups, &judging());
    let found = family(results.path());
    for id in ["final-dull", "area-dull"] {
        // Four baselines there and four readings here: the same level.
        let default = ledger.iter().find(|entry| entry.id == id).unwrap();
        assert_eq!(claim(&found, id).judged[0].1, *default);
    }
}

#[test]
fn verdicts_that_agree_are_said_to() {
    let results = TempDir::new().unwrap();
    for environment in ["RoomA", "RoomB"] {
        write(
            results.path(),
            environment,
            "nova",
            "default",
            0.8,
            &nova(&json!({"states": "reference"}), "pool"),
        );
        write(
            results.path(),
            environment,
            "nova",
            "replay",
            0.7,
            &nova(&json!({"states": "replay"}), "pool"),
        );
        write(results.path(), environment, "dull-pool", "default", 0.3, &baseline("dull-pool", "pool"));
    }
    let found = family(results.path());
    let claim = claim(&found, "final-dull-pool");
    assert_eq!(claim.conclusion, "the same under all 2 readings: confirmed");
    assert!(!claim.hangs());
    assert!(claim.judged[0].1.statement.contains("DULL-pool"), "the control counts as a baseline here");
}

#[test]
fn verdicts_that_no_single_choice_decides_are_named_by_number() {
    let results = TempDir::new().unwrap();
    for environment in ["RoomA", "RoomB"] {
        for (variant, states, selection, rate) in [
            ("default", "reference", "proportional", 0.8),
            ("v2", "reference", "argmax", 0.3),
            ("v3", "replay", "argmax", 0.85),
            ("v4", "replay", "proportional", 0.1),
        ] {
            let config = nova(&json!({"states": states, "selection": selection}), "environment");
            write(results.path(), environment, "nova", variant, rate, &config);
        }
        write(results.path(), environment, "dull", "default", 0.3, &baseline("dull", "environment"));
    }
    let conclusion = claim(&family(results.path()), "final-dull").conclusion.clone();
    let expected = "hangs on the reading: confirmed under readings 1, 3, refuted under reading 4, undecided under reading 2";
    assert_eq!(conclusion, expected);
}

#[test]
fn readings_with_the_same_runs_are_one() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    let write_record = |environment: &str, variant: &str, record: &str, states: &str, rate: f64| {
        let config = nova(&json!({"record": record, "states": states, "interplay": 1}), "environment");
        write(path, environment, "nova", variant, rate, &config);
    };
    for environment in ["RoomA", "RoomB"] {
        write_record(environment, "default", "cycle", "reference", 0.6);
        write_record(environment, "record", "evaluation", "reference", 0.6);
        write(path, environment, "dull", "default", 0.3, &baseline("dull", "environment"));
    }
    assert_eq!(readings(path), Readings::default(), "one reading under two names is one");
    for environment in ["RoomA", "RoomB"] {
        write_record(environment, "record,states=initial", "evaluation", "initial", 0.5);
        write_record(environment, "record,states=replay", "evaluation", "replay", 0.1);
    }
    let found = family(path);
    let expected = [
        "states = reference, record = cycle (the same runs: states = reference, record = evaluation)",
        "states = initial, record = evaluation",
        "states = replay, record = evaluation",
    ];
    assert_eq!(names(&found), expected);
    let claim = claim(&found, "final-dull");
    let expected =
        "hangs on the reading: confirmed under states = reference or initial, refuted under states = replay";
    assert_eq!(claim.conclusion, expected);
    let miss = 1.0 - claim.judged[0].1.confidence;
    assert!((miss - 0.05 / 3.0).abs() < 1e-12, "three readings, not four");
}

#[test]
fn only_environments_with_all_readings_count() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for environment in ["RoomA", "RoomC"] {
        write_four(path, environment);
    }
    // Here the default alone was run, and it is far behind.
    write(
        path,
        "RoomB",
        "nova",
        "default",
        0.1,
        &nova(&json!({"window": 10, "selection": "proportional"}), "pool"),
    );
    write(path, "RoomB", "dull", "default", 0.9, &baseline("dull", "pool"));
    let found = family(path);
    assert_eq!(
        (found.environments.join(" "), found.left_out.join(" ")),
        ("RoomA RoomC".into(), "RoomB".into())
    );
    for (_, entry) in claim(&found, "final-dull").judged.iter() {
        assert_eq!(entry.effect.environments(), ["RoomA", "RoomC"]);
    }
}

#[test]
fn a_baseline_without_some_settings_is_set_against_the_others() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for environment in ["RoomA", "RoomB"] {
        write_four(path, environment);
        write(path, environment, "wren", "default", 0.2, &baseline("wren", "environment"));
        // With other settings of the student: set against nothing.
        let mut other = baseline("moss", "environment");
        other["student"] = json!({"width": 64});
        write(path, environment, "moss", "default", 0.2, &other);
    }
    let found = family(path);
    let wren = claim(&found, "final-wren");
    let numbers: Vec<usize> = wren.judged.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, [1, 2]);
    let expected =
        "the same under all 2 readings: confirmed; no runs of WREN with the same settings under 2 more";
    assert_eq!(wren.conclusion, expected);
    assert!((wren.judged[0].1.confidence - 0.975).abs() < 1e-12, "two are tested");
    assert!(found.claims.iter().all(|claim| claim.judged[0].1.id != "final-moss"));
}

#[test]
fn other_settings_of_teach_are_no_readings() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for (variant, window) in [("default", 10), ("n=3", 3)] {
        let config = nova(&json!({"window": window, "selection": "proportional"}), "environment");
        write(path, "RoomA", "nova", variant, 0.5, &config);
    }
    write(path, "RoomA", "dull", "default", 0.3, &baseline("dull", "environment"));
    assert_eq!(readings(path), Readings::default());
    let written = reports::write(path, &options()).unwrap();
    let folder = layout::report_dir(path);
    assert!(!folder.join("tables/readings.tex").exists());
    assert_eq!(fs::read_to_string(folder.join("readings.csv")).unwrap().lines().count(), 1, "a header alone");
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    assert!(!page.contains("<section id=\"readings\">"));
    assert!(written.missing.iter().all(|text| !text.contains("reading")), "{:?}", written.missing);
}

#[test]
fn the_report_shows_every_claim_with_its_conclusion() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for environment in ["RoomA", "RoomB"] {
        write_four(path, environment);
    }
    reports::write(path, &ReportOptions { window: 1, ..options() }).unwrap();
    let folder = layout::report_dir(path);
    let csv = fs::read_to_string(folder.join("readings.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 2 * 4, "a row per claim and reading");
    let summary = fs::read_to_string(folder.join("summary.md")).unwrap();
    let (_, section) = summary.split_once("## Does a claim's verdict hang on the reading?").unwrap();
    let row = "| NOVA reaches a higher final success than DULL on average over environments | all together | hangs on it | \
               hangs on the reading: confirmed under selection = proportional, undecided under selection = argmax |  |  |";
    assert!(section.contains(row), "{section}");
    assert!(section.contains("| 1: selection = proportional, evaluation goals = environment | confirmed |"));
    assert!(section.contains("at 95 % together for the readings of one claim (Bonferroni's correction"));
    for place in ["tables/readings.tex", "DATA.md", "index.html"] {
        let text = fs::read_to_string(folder.join(place)).unwrap();
        assert!(text.contains("eading"), "{place}");
    }
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    let at = |id: &str| page.find(&format!("<section id=\"{id}\">")).unwrap();
    assert!(at("ledger") < at("readings") && at("readings") < at("comparisons"));
}
