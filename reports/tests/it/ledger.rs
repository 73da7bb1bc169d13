//! Verdicts on the paper's claims, from results that leave no doubt and from results that say nothing.

use std::fs;
use std::path::Path;

use super::support::{key, line, options, seal, write_configured, write_run};
use reports::ReportOptions;
use reports::analysis::ablation;
use reports::analysis::group;
use reports::analysis::ledger::{self, LedgerEntry, Verdict};
use reports::schema::Record;
use reports::stats::Resampling;
use reports::store::Store;
use reports::store::layout;
use reports::synthetic::catalogue;
use serde_json::{Value, json};
use tempfile::TempDir;

pub(crate) fn nova(window: u64, interplay: u64, confidence: &str) -> Value {
    json!({"curriculum": {"nova": {"window": window, "interplay": interplay, "confidence": confidence}}})
}

/// Seeds 0 to 6 of a group that end at about `rate`.
pub(crate) fn write_group(
    results: &Path,
    environment: &str,
    curriculum: &str,
    variant: &str,
    rate: f64,
    config: &Value,
) {
    for seed in 0..7_u32 {
        let rate = rate + 0.005 * f64::from(seed % 3);
        let run = key(environment, curriculum, variant, seed.into());
        write_configured(results, &run, &[0.0, rate], config.clone());
    }
}

/// What made-up results are judged by: the last evaluation alone, and few resamples.
pub(crate) fn judging() -> ReportOptions {
    let resampling = Resampling { resamples: 2_000, ..Resampling::default() };
    ReportOptions { window: 1, resampling, ..options() }
}

pub(crate) fn entries(results: &Path) -> Vec<LedgerEntry> {
    let store = Store::read(results).unwrap();
    let groups = group::groups(&store, &catalogue());
    ledger::ledger(&groups, &judging())
}

fn verdict(entries: &[LedgerEntry], id: &str) -> Verdict {
    entries.iter().find(|entry| entry.id == id).unwrap().verdict
}

#[test]
fn clear_results_are_judged() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for environment in ["RoomA", "RoomB"] {
        write_group(path, environment, "nova", "default", 0.6, &nova(10, 1, "online"));
        write_group(path, environment, "wren", "default", 0.3, &json!({"curriculum": {"wren": {}}}));
        write_group(path, environment, "moss", "default", 0.9, &json!({"curriculum": {"moss": {}}}));
        write_group(path, environment, "dull", "default", 0.6, &json!({"curriculum": {"dull": {}}}));
        write_group(path, environment, "nova", "n=3", 0.62, &nova(3, 1, "online"));
        write_group(path, environment, "nova", "n=20", 0.58, &nova(20, 1, "online"));
        write_group(path, environment, "nova", "n=3,target", 0.4, &nova(3, 1, "target"));
        write_group(path, environment, "nova", "n=3,target-critic", 0.5, &nova(3, 1, "target-critic"));
        write_group(path, environment, "nova", "delta=5", 0.75, &nova(10, 5, "online"));
        write_group(path, environment, "nova", "delta=50", 0.1, &nova(10, 50, "online"));
    }
    let entries = entries(path);
    let expected = [
        ("final-wren", Verdict::Confirmed),
        ("final-kite", Verdict::Undecided),
        ("final-moss", Verdict::Refuted),
        ("final-dull", Verdict::Undecided),
        ("area-wren", Verdict::Confirmed),
        ("area-moss", Verdict::Refuted),
        ("target-confidence", Verdict::Confirmed),
        ("window", Verdict::Confirmed),
        ("interplay", Verdict::Confirmed),
    ];
    for (id, expected) in expected {
        assert_eq!(verdict(&entries, id), expected, "{id}: {entries:#?}");
    }
    let wren = &entries.iter().find(|entry| entry.id == "final-wren").unwrap().effect;
    assert!((wren.difference.unwrap() - 0.3).abs() < 1e-9);
    assert_eq!((wren.pairs, wren.ahead(), wren.behind(), wren.places.len()), (14, 2, 0, 2));
    // All 14 differences have one sign.
    assert_eq!(wren.p, Some(2_f64.powi(-13)));
    let area = &entries.iter().find(|entry| entry.id == "area-wren").unwrap();
    assert!((area.effect.difference.unwrap() - 0.15).abs() < 1e-9, "half of it: from 0 in a straight line");
    // Four baselines share a miss of 0.05.
    assert!((area.confidence - 0.9875).abs() < 1e-12);
    // 0.62 with the online networks; the target critic is what the paper speaks of.
    let confidence = entries.iter().find(|entry| entry.id == "target-confidence").unwrap();
    assert_eq!(confidence.value.as_deref(), Some("confidence = target-critic"));
    assert!((confidence.effect.difference.unwrap() + 0.12).abs() < 1e-9);
    assert!(
        (confidence.confidence - 0.975).abs() < 1e-12,
        "one value is tested, on average and by environment"
    );
    let interplay = entries.iter().find(|entry| entry.id == "interplay").unwrap();
    // Δ = 50 differs most, and against the claim; Δ = 5 is what confirms it.
    assert_eq!(interplay.value.as_deref(), Some("Δ = 5"));
    assert!((interplay.effect.difference.unwrap() - 0.15).abs() < 1e-9);
    assert!(interplay.effect.interval.unwrap().0 > 0.0);
    // Two intervals share a miss of 0.05.
    assert!((interplay.confidence - 0.975).abs() < 1e-12);
}

/// The claim on smooth confidence, at n = 3 in two environments: 0.6 with the online networks, and these
/// values.
fn smooth_confidence(values: &[(&str, f64)]) -> LedgerEntry {
    let results = TempDir::new().unwrap();
    for environment in ["RoomA", "RoomB"] {
        for (value, rate) in [&[("online", 0.6)], values].concat() {
            write_group(results.path(), environment, "nova", value, rate, &nova(3, 1, value));
        }
    }
    entries(results.path()).into_iter().find(|entry| entry.id == "target-confidence").unwrap()
}

#[test]
fn smooth_confidence_is_judged_by_the_target_critic() {
    let alone = smooth_confidence(&[("target-critic", 0.5)]);
    // As far above as the other is below: the claim is not about it.
    let both = smooth_confidence(&[("target", 0.7), ("target-critic", 0.5)]);
    let of =
        |entry: &LedgerEntry| (entry.verdict, entry.value.clone(), entry.effect.clone(), entry.confidence);
    assert_eq!(of(&both), of(&alone));
    assert_eq!(both.verdict, Verdict::Confirmed);
    let beside = "; confidence = target, not what the claim is about and not tested: +0.10, ahead in 2 and behind in 0 of 2 \
                  environments";
    assert_eq!(both.evidence, alone.evidence + beside);
}

#[test]
fn without_a_target_critic_the_target_networks_stand_in_for_it() {
    let old = smooth_confidence(&[("target", 0.7)]);
    assert_eq!((old.verdict, old.value.as_deref()), (Verdict::Refuted, Some("confidence = target")));
    let remark = "; no run has confidence = target-critic, so confidence = target is tested in its place";
    assert!(old.evidence.ends_with(remark), "{}", old.evidence);
    let results = TempDir::new().unwrap();
    for (variant, window, confidence) in [("a", 3, "online"), ("b", 3, "target"), ("c", 5, "target-critic")] {
        write_group(results.path(), "RoomA", "nova", variant, 0.6, &nova(window, 1, confidence));
    }
    let entries = entries(results.path());
    let entry = entries.iter().find(|entry| entry.id == "target-confidence").unwrap();
    // There are such runs, but none that differ in it alone.
    assert_eq!((entry.verdict, entry.effect.difference), (Verdict::Undecided, None));
    assert!(entry.evidence.starts_with("confidence = target-critic: no pair of runs with the same seed; "));
}

#[test]
fn runs_that_differ_in_success_at_any_step_are_no_repeats() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for (variant, interplay) in [("default", 1), ("delta=2", 2)] {
        write_group(path, "RoomA", "nova", variant, 0.6, &nova(10, interplay, "online"));
    }
    let records = layout::run_dir(path, &key("RoomA", "nova", "delta=2", 3)).join(layout::RECORDS);
    let rewrite = |rate: Option<f64>| {
        let lines = fs::read_to_string(&records).unwrap();
        let change =
            |text: &str| line(&Record { any_success_rate: rate, ..serde_json::from_str(text).unwrap() });
        fs::write(&records, lines.lines().map(change).collect::<String>()).unwrap();
        seal(records.parent().unwrap());
        let evidence = entries(path).into_iter().find(|entry| entry.id == "interplay").unwrap().evidence;
        evidence.contains("the same runs")
    };
    assert!(!rewrite(Some(0.9)));
    assert!(rewrite(None), "older runs do not tell");
}

#[test]
fn a_value_that_repeats_the_reference_is_not_tested() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    let interplay = || entries(path).into_iter().find(|entry| entry.id == "interplay").unwrap();
    write_group(path, "RoomA", "nova", "default", 0.6, &nova(10, 1, "online"));
    write_group(path, "RoomA", "nova", "delta=2", 0.6, &nova(10, 2, "online"));
    let alone = interplay();
    assert_eq!((alone.verdict, alone.effect.difference), (Verdict::Undecided, None));
    assert_eq!(alone.evidence, "Δ = 2: the same runs as Δ = 1, not tested");
    write_group(path, "RoomA", "nova", "delta=50", 0.1, &nova(10, 50, "online"));
    let entry = interplay();
    // With Δ = 2 in the test, an interval of [0, 0] would never let the claim be refuted.
    assert_eq!(entry.verdict, Verdict::Refuted);
    assert!((entry.confidence - 0.95).abs() < 1e-12, "one interval alone: {}", entry.confidence);
    assert!(entry.evidence.ends_with("; Δ = 2: the same runs as Δ = 1, not tested"), "{}", entry.evidence);
    // In another environment the two differ: then both count.
    write_group(path, "RoomB", "nova", "default", 0.6, &nova(10, 1, "online"));
    write_group(path, "RoomB", "nova", "delta=2", 0.5, &nova(10, 2, "online"));
    assert!((interplay().confidence - 0.975).abs() < 1e-12);
    // The comparisons of the report leave out what repeats its reference, in that environment alone.
    reports::write(path, &options()).unwrap();
    let csv = fs::read_to_string(layout::report_dir(path).join("comparisons.csv")).unwrap();
    let rows = |environment: &str| -> Vec<&str> {
        let of_it = |line: &Vec<&str>| line[1] == environment;
        csv.lines().map(|line| line.split(',').collect()).filter(of_it).map(|line| line[3]).collect()
    };
    assert_eq!((rows("RoomA"), rows("RoomB")), (vec!["delta=50"], vec!["delta=2"]));
}

#[test]
fn few_seeds_decide_nothing() {
    let results = TempDir::new().unwrap();
    for seed in 0..4 {
        write_configured(
            results.path(),
            &key("RoomA", "nova", "default", seed),
            &[0.0, 1.0],
            nova(10, 1, "online"),
        );
        write_configured(results.path(), &key("RoomA", "wren", "default", seed), &[0.0, 0.0], json!({}));
    }
    let entries = entries(results.path());
    assert_eq!(entries.len(), 15);
    assert!(entries.iter().all(|entry| entry.verdict == Verdict::Undecided));
    let expected = "ahead in 1 and behind in 0 of 1 environment, 4 pairs of runs; too few seeds: 4 pairs of runs, 5 are \
                    needed; few pairs: RoomA (4, +1.00)";
    assert_eq!(entries[0].evidence, expected);
}

/// Seeds 0 to 6 of NOVA and of WREN, which is ahead at every step; NOVA goes on for twice as long where WREN
/// has not.
fn race(results: &Path, finished: bool) -> Vec<LedgerEntry> {
    for seed in 0..7 {
        write_run(results, &key("RoomA", "nova", "default", seed), &[0.0, 0.2, 0.6, 0.9]);
        let behind = write_run(results, &key("RoomA", "wren", "default", seed), &[0.0, 0.4, 0.8]);
        if !finished {
            fs::remove_file(behind.join(layout::OUTCOME)).unwrap();
        }
    }
    entries(results)
}

#[test]
fn a_baseline_that_was_cut_off_decides_nothing() {
    for finished in [false, true] {
        let results = TempDir::new().unwrap();
        let entries = race(results.path(), finished);
        for id in ["final-wren", "area-wren"] {
            let entry = entries.iter().find(|entry| entry.id == id).unwrap();
            assert_eq!((entry.verdict, entry.effect.pairs), (Verdict::Undecided, 0), "{entry:#?}");
            let expected = "no pair of runs with the same seed; not judged: RoomA (no seed of both); 7 runs left out, not finished or \
                            with other evaluations";
            assert_eq!(entry.evidence, expected);
        }
        reports::write(results.path(), &options()).unwrap();
        let report = layout::report_dir(results.path());
        let csv = fs::read_to_string(report.join("comparisons.csv")).unwrap();
        let (header, row) = csv.split_once('\n').unwrap();
        let row: Vec<&str> = row.trim().split(',').collect();
        let field = |name: &str| row[header.split(',').position(|other| other == name).unwrap()];
        assert_eq!(["n_seeds", "n_reference", "n_pairs", "runs_left_out"].map(field), ["0", "7", "0", "7"]);
        assert_eq!(["difference", "welch_p", "p_holm", "probability_of_improvement"].map(field), [""; 4]);
    }
}

#[test]
fn what_cannot_reach_the_level_is_undecided_and_said() {
    let results = TempDir::new().unwrap();
    // Seven pairs of one sign have p = 1/64; four baselines ask for 1/80.
    write_group(results.path(), "RoomA", "nova", "default", 0.9, &nova(10, 1, "online"));
    write_group(results.path(), "RoomA", "wren", "default", 0.1, &json!({}));
    let wren = || entries(results.path()).into_iter().find(|entry| entry.id == "final-wren").unwrap();
    let entry = wren();
    assert_eq!((entry.verdict, entry.effect.interval), (Verdict::Undecided, None));
    assert_eq!(entry.effect.p, Some(1.0 / 64.0));
    let expected = "ahead in 1 and behind in 0 of 1 environment, 7 pairs of runs; too few seeds: p of 7 pairs cannot fall \
                    below 0.0156, 0.0125 is needed";
    assert_eq!(entry.evidence, expected);
    for (curriculum, rate, config) in [("nova", 0.9, nova(10, 1, "online")), ("wren", 0.1, json!({}))] {
        write_configured(results.path(), &key("RoomA", curriculum, "default", 7), &[0.0, rate], config);
    }
    assert_eq!(wren().verdict, Verdict::Confirmed, "an eighth pair makes it 1/128");
}

#[test]
fn environments_count_alike_whatever_their_seeds() {
    let results = TempDir::new().unwrap();
    // Ahead by 0.6 with 7 seeds, behind by 0.2 with 5, ahead by 1 with 2.
    for (environment, nova, wren, seeds) in
        [("RoomA", 0.8, 0.2, 7), ("RoomB", 0.4, 0.6, 5), ("RoomC", 1.0, 0.0, 2)]
    {
        for seed in 0..seeds {
            let write = |curriculum: &str, rate: f64| {
                let run = key(environment, curriculum, "default", seed);
                write_configured(results.path(), &run, &[0.0, rate], json!({}));
            };
            write("nova", nova);
            write("wren", wren);
        }
    }
    let entries = entries(results.path());
    let entry = entries.iter().find(|entry| entry.id == "final-wren").unwrap();
    let effect = &entry.effect;
    assert_eq!(effect.environments(), ["RoomA", "RoomB", "RoomC"]);
    assert_eq!((effect.pairs, effect.ahead(), effect.behind()), (14, 2, 1));
    assert!((effect.difference.unwrap() - 1.4 / 3.0).abs() < 1e-9, "(0.6 - 0.2 + 1) / 3: {effect:?}");
    assert!(entry.evidence.ends_with("; few pairs: RoomC (2, +1.00)"), "{}", entry.evidence);
}

#[test]
fn ablations_differ_in_one_field_alone() {
    let results = TempDir::new().unwrap();
    let write = |environment: &str, variant: &str, config: Value| {
        write_configured(results.path(), &key(environment, "nova", variant, 0), &[0.0, 0.5], config);
    };
    write("A", "default", nova(10, 1, "online"));
    write("A", "n=3", nova(3, 1, "online"));
    write("A", "n=20", nova(20, 1, "online"));
    write("A", "n=3,target", nova(3, 1, "target"));
    write("A", "n=3,target-critic", nova(3, 1, "target-critic"));
    write("B", "n=5,delta=2", nova(5, 2, "online"));
    write("B", "default", nova(10, 1, "online"));
    let store = Store::read(results.path()).unwrap();
    let groups = group::groups(&store, &catalogue());
    let found: Vec<Vec<Vec<String>>> = catalogue()
        .paper
        .axes
        .iter()
        .map(|axis| {
            let levels =
                |one: &ablation::Ablation<'_>| one.levels.iter().map(ablation::Level::text).collect();
            ablation::ablations(&groups, axis).iter().map(levels).collect()
        })
        .collect();
    let owned = |texts: &[&str]| texts.iter().map(|&text| text.to_owned()).collect::<Vec<_>>();
    // Values by size; those of B differ in two fields.
    assert_eq!(
        found,
        [vec![owned(&["online", "target", "target-critic"])], vec![owned(&["3", "10", "20"])], vec![]]
    );
}
