//! Which runs are compared, with what, and what is said of the others.

use std::fs;
use std::path::Path;

use super::ledger::judging;
use super::support::{fail, key, options, seal, write_configured, write_run};
use reports::ReportOptions;
use reports::analysis::comparison::{self, TestFamily};
use reports::analysis::complete::{self, Pair};
use reports::analysis::curves::Curve;
use reports::analysis::group::{self, GroupKey};
use reports::analysis::options::Failures;
use reports::stats;
use reports::store::Store;
use reports::store::layout;
use reports::synthetic::catalogue;
use serde_json::json;
use tempfile::TempDir;

fn write(results: &Path, curriculum: &str, variant: &str, by_seed: &[(u64, f64)]) {
    for &(seed, rate) in by_seed {
        write_run(results, &key("A", curriculum, variant, seed), &[0.0, rate]);
    }
}

fn unfinish(results: &Path, environment: &str, curriculum: &str, variant: &str, seed: u64) {
    let folder = layout::run_dir(results, &key(environment, curriculum, variant, seed));
    fs::remove_file(folder.join(layout::OUTCOME)).unwrap();
}

#[test]
fn finished_runs_of_the_commonest_steps_are_comparable() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    write(path, "nova", "default", &[(0, 0.5), (1, 0.5), (2, 0.5)]);
    write(path, "wren", "default", &[(0, 0.5)]);
    unfinish(path, "A", "nova", "default", 1);
    // Twice as long, as often as the others are short: in a pair of equals the longer ones stay.
    for seed in 1..3 {
        write_run(path, &key("A", "wren", "default", seed), &[0.0, 0.5, 0.5]);
    }
    let store = Store::read(path).unwrap();
    let groups = group::groups(&store, &catalogue());
    let seeds = |group: &group::Group<'_>| group.runs.iter().map(|run| run.key().seed).collect::<Vec<_>>();
    let cut = complete::comparable(&groups.iter().collect::<Vec<_>>());
    assert_eq!(cut.iter().map(seeds).collect::<Vec<_>>(), [vec![0, 2], vec![0]]);
    let pair = Pair::of(&groups[0], &groups[1]);
    assert_eq!((seeds(&pair.a), seeds(&pair.b), pair.left_out), (vec![0, 2], vec![0], 3));
    let pair = Pair::of(&groups[1], &groups[1]);
    assert_eq!((seeds(&pair.a), pair.left_out), (vec![1, 2], 2));
}

#[test]
fn every_method_is_compared_with_its_reference() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    write(path, "nova", "default", &[(0, 0.9), (1, 0.8), (2, 1.0)]);
    write(path, "nova", "n=3", &[(0, 0.6), (1, 0.7), (2, 0.7)]);
    write(path, "wren", "default", &[(1, 0.2), (2, 0.5), (3, 0.4)]);
    write(path, "dull", "default", &[(0, 0.7), (1, 0.9)]);
    let store = Store::read(path).unwrap();
    let groups = group::groups(&store, &catalogue());
    let compared = group::compared(&groups.iter().map(|group| &group.key).collect::<Vec<_>>());
    let found = comparison::comparisons(&groups, &compared, &judging());
    let name = |key: &GroupKey| format!("{} {}", key.curriculum.id, key.variant);
    let names: Vec<_> = found.iter().map(|c| (c.family, name(c.method), name(c.reference))).collect();
    let row = |family, method: &str| (family, method.to_owned(), "nova default".to_owned());
    let expected = [
        row(TestFamily::Variants, "nova n=3"),
        row(TestFamily::Methods, "wren default"),
        row(TestFamily::Methods, "dull default"),
    ];
    assert_eq!(names, expected);
    // Seeds 1 and 2: (0.2 - 0.8 + 0.5 - 1.0) / 2. No run of WREN is above any of NOVA.
    let (variant, wren, her) = (&found[0], &found[1], &found[2]);
    assert_eq!((wren.n, wren.pairs), ((3, 3), 2));
    assert!((wren.difference.unwrap() + 0.55).abs() < 1e-12);
    assert_eq!(wren.sign_flip.unwrap().p, 0.5, "two pairs of one sign");
    assert_eq!(wren.probability_of_improvement, Some(0.0));
    // Of six pairs, 0.7 wins none; 0.9 wins one and ties one.
    assert_eq!(her.probability_of_improvement, Some(1.5 / 6.0));
    // Two tests of methods share the level, the one of a variant has it alone.
    let p = [wren, her].map(|c| c.welch.unwrap().p).into_iter().fold(f64::INFINITY, f64::min);
    assert!([wren, her].iter().any(|c| c.p_holm == Some(2.0 * p)));
    assert_eq!(variant.p_holm, Some(variant.welch.unwrap().p));
    assert_eq!((wren.level, her.level, variant.level), (0.025, 0.025, 0.05));
    // The standard deviation of 0.2, 0.5, 0.4, and that of 0.9, 0.8, 1.0, which is 0.1.
    let spread = f64::midpoint(0.07 / 3.0, 0.01).sqrt();
    let detectable = spread * stats::detectable_effect(3, 0.025, 0.8).unwrap();
    assert!((wren.detectable.unwrap() - detectable).abs() < 1e-9);
    assert_eq!((wren.improvement, wren.improvement_p), (Some(0.0), Some(0.5)));
}

#[test]
fn sums_and_tables_leave_out_what_is_incomplete_and_say_so() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for environment in ["RoomA", "RoomB", "RoomC"] {
        for curriculum in ["nova", "wren"] {
            for seed in 0..3 {
                write_run(path, &key(environment, curriculum, "default", seed), &[0.0, 0.5]);
            }
        }
    }
    write_run(path, &key("RoomA", "kite", "default", 0), &[0.0, 0.5]);
    unfinish(path, "RoomB", "wren", "default", 1);
    fs::create_dir_all(layout::protocols_dir(path)).unwrap();
    fs::write(layout::protocols_dir(path).join("paper.toml"), "name = 'made-up paper'").unwrap();
    let written = reports::write(path, &options()).unwrap();
    let csv = fs::read_to_string(layout::report_dir(path).join("aggregates.csv")).unwrap();
    let rows: Vec<String> =
        csv.lines().skip(1).map(|line| line.split(',').take(4).collect::<Vec<_>>().join(" ")).collect();
    assert_eq!(rows, ["nova default 3 8", "wren default 3 8"]);
    let summary = fs::read_to_string(layout::report_dir(path).join("summary.md")).unwrap();
    assert!(summary.contains("Left out, for they lack more of them: KiTe."), "{summary}");
    for expected in [
        "sums over environments leave out KiTe, which lacks too many of them",
        "comparisons, ledger and sums over environments rest on finished runs of the same evaluations; left out of all runs \
         of methods: 1",
        "no evaluation of these methods of the paper: MoSS, DULL",
        "no evaluation of these environments of the paper: ArmReach, ArmPush, ArmSlide, ArmPickAndPlace, \
         ClawReach, ClawManipulateBlock, ClawManipulatePen, ClawManipulateEgg",
    ] {
        assert!(written.missing.iter().any(|other| other == expected), "{expected}: {:#?}", written.missing);
    }
}

#[test]
fn gaps_in_ablations_are_missing_too() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    let write = |environment: &str, variant: &str, seed: u64| {
        let config = json!({"curriculum": {"nova": {"variant": variant}}});
        write_configured(path, &key(environment, "nova", variant, seed), &[0.0, 0.5], config);
    };
    for (environment, variants) in
        [("RoomA", &["default", "n=3", "n=5"][..]), ("RoomB", &["default", "n=3"]), ("RoomC", &["default"])]
    {
        variants.iter().for_each(|variant| (0..2).for_each(|seed| write(environment, variant, seed)));
    }
    fs::remove_dir_all(layout::run_dir(path, &key("RoomB", "nova", "n=3", 1))).unwrap();
    unfinish(path, "RoomA", "nova", "n=5", 0);
    let missing = reports::write(path, &options()).unwrap().missing;
    let of_ablations: Vec<&str> =
        missing.iter().map(String::as_str).filter(|line| line.contains("NOVA (n=")).collect();
    // RoomC has no ablation at all, and lacks none.
    let expected = [
        "RoomA: NOVA (n=5): 1 of 2 runs not finished",
        "RoomB: NOVA (n=3) lacks seed 1",
        "RoomB: NOVA (n=5) has no evaluation",
    ];
    assert_eq!(of_ablations, expected);
}

/// Six runs of each of two methods in two rooms; of NOVA's, which reach more, two broke down halfway in each.
fn broken_down() -> TempDir {
    let results = TempDir::new().unwrap();
    for environment in ["RoomA", "RoomB"] {
        for seed in 0..6 {
            write_run(results.path(), &key(environment, "wren", "default", seed), &[0.0, 0.5, 0.5, 0.5]);
            let nova = key(environment, "nova", "default", seed);
            if seed < 4 {
                write_run(results.path(), &nova, &[0.0, 0.8, 0.8, 0.8]);
            } else {
                fail(&write_run(results.path(), &nova, &[0.0, 0.8]));
            }
        }
    }
    results
}

/// The column `name` of a CSV file of the report, for the rows of NOVA.
fn of_nova(results: &Path, file: &str, name: &str) -> Vec<String> {
    of_curriculum("nova", results, file, name)
}

/// Column `name` of the rows of a curriculum in a file of a report.
fn of_curriculum(id: &str, results: &Path, file: &str, name: &str) -> Vec<String> {
    let csv = fs::read_to_string(layout::report_dir(results).join(file)).unwrap();
    let mut rows = csv.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let column = |name: &str| header.iter().position(|other| other == name).unwrap();
    let (curriculum, column) = (column("curriculum"), column(name));
    rows.filter(|row| row[curriculum] == id).map(|row| row[column].clone()).collect()
}

#[test]
fn methods_that_end_alike_differ_in_their_areas() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for (seed, early) in [(0, 0.2), (1, 0.2), (2, 0.3)] {
        write_run(path, &key("A", "nova", "default", seed), &[0.0, early, 0.8]);
        write_run(path, &key("A", "wren", "default", seed), &[0.0, 0.5, 0.8]);
    }
    write_run(path, &key("A", "wren", "default", 3), &[0.0, 1.0, 0.8]);
    reports::write(path, &ReportOptions { window: 1, ..options() }).unwrap();
    let number = |name: &str| of_curriculum("wren", path, "comparisons.csv", name)[0].parse::<f64>().unwrap();
    assert_eq!(number("difference"), 0.0);
    // Areas: NOVA (0.1 + 0.5) / 2 = 0.3 twice and (0.15 + 0.55) / 2 = 0.35, WREN (0.25 + 0.65) / 2 = 0.45.
    let expected = [
        ("area_difference", (0.15 + 0.15 + 0.1) / 3.0),
        ("area_difference_ci_low", 0.1),
        ("area_difference_ci_high", 0.15),
        // Of 8 flips, the one found and its opposite are as far from 0.
        ("area_sign_flip_p", 0.25),
    ];
    for (name, value) in expected {
        assert!((number(name) - value).abs() < 1e-12, "{name}: {} and not {value}", number(name));
    }
}

#[test]
fn failed_runs_count_0_from_their_failure_on() {
    let results = broken_down();
    let path = results.path();
    let one = ReportOptions { window: 1, ..options() };
    let written = reports::write(path, &one).unwrap();
    let number = |file, name| of_nova(path, file, name)[0].parse::<f64>().unwrap();
    // (4 * 0.8 + 2 * 0) / 6, and the four that finished beside it.
    assert!((number("summary.csv", "final_mean") - 3.2 / 6.0).abs() < 1e-12);
    assert!((number("summary.csv", "final_finished_mean") - 0.8).abs() < 1e-12);
    assert_eq!(
        ["n_seeds", "n_finished", "n_failed"].map(|name| number("summary.csv", name)),
        [6.0, 4.0, 2.0]
    );
    assert!((number("aggregates.csv", "mean") - 3.2 / 6.0).abs() < 1e-12);
    assert_eq!(["runs", "runs_failed"].map(|name| number("aggregates.csv", name)), [12.0, 4.0]);
    assert_eq!(number("costs.csv", "steps_min"), 3_000.0, "what finished runs took");
    let csv = fs::read_to_string(layout::report_dir(path).join("comparisons.csv")).unwrap();
    let row = csv.lines().nth(1).unwrap();
    assert!(row.starts_with("methods,RoomA,wren,default,nova,default,6,6,0,2,6,"), "{row}");
    let summary = fs::read_to_string(layout::report_dir(path).join("summary.md")).unwrap();
    assert!(summary.contains("| 4 of 6, 2 failed |") && summary.contains("| 6 (2 failed) |"), "{summary}");
    assert!(
        summary.contains("; 4 failed runs count 0 from their failure on"),
        "the ledger's evidence: {summary}"
    );
    assert!(summary.contains(" 4 runs failed: they count 0 from their failure on."), "{summary}");
    for expected in [
        "RoomA: NOVA: 2 of 6 runs failed",
        "comparisons, ledger and sums over environments count failed runs as 0 from their failure on; runs of methods \
         that failed: 4",
    ] {
        assert!(written.missing.iter().any(|line| line == expected), "{expected}: {:#?}", written.missing);
    }

    reports::write(path, &ReportOptions { failures: Failures::Apart, ..one }).unwrap();
    assert!((number("summary.csv", "final_mean") - 0.8).abs() < 1e-12);
    assert_eq!(of_nova(path, "summary.csv", "final_finished_mean"), ["", ""]);
    assert_eq!(["runs", "runs_failed"].map(|name| number("aggregates.csv", name)), [8.0, 0.0]);
}

#[test]
fn unfinished_runs_are_not_mixed_into_finished_ones() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    write(path, "nova", "default", &[(0, 0.5), (1, 0.75)]);
    write_run(path, &key("A", "nova", "default", 2), &[0.0]);
    unfinish(path, "A", "nova", "default", 2);
    write(path, "wren", "default", &[(0, 0.25)]);
    unfinish(path, "A", "wren", "default", 0);
    reports::write(path, &options()).unwrap();
    for file in ["summary.csv", "costs.csv"] {
        assert_eq!(of_nova(path, file, "n_seeds"), ["3"]);
        assert_eq!(of_nova(path, file, "n_finished"), ["2"]);
        assert_eq!(of_nova(path, file, "gradient_steps"), ["400.0"], "{file}: of the two that finished");
    }
    assert_eq!(of_nova(path, "summary.csv", "final_mean"), ["0.625"]);
    // A method of which nothing has finished is shown as far as it got.
    let csv = fs::read_to_string(layout::report_dir(path).join("summary.csv")).unwrap();
    assert!(csv.contains("\nA,wren,default,1,0,0,0.25,"), "{csv}");
}

#[test]
fn equal_methods_do_not_differ_for_lack_of_seeds() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for (environment, rate, seeds) in
        [("RoomA", 0.9, 7), ("RoomB", 0.9, 7), ("ArmPush", 0.1, 2), ("ArmSlide", 0.1, 2)]
    {
        for seed in 0..7 {
            write_run(path, &key(environment, "nova", "default", seed), &[0.0, rate]);
            if seed < seeds {
                write_run(path, &key(environment, "wren", "default", seed), &[0.0, rate]);
            }
        }
    }
    reports::write(path, &options()).unwrap();
    let csv = fs::read_to_string(layout::report_dir(path).join("aggregates.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().skip(1).map(|row| row.split_once("default,").unwrap().1).collect();
    assert_eq!(rows[0], rows[1]);
    let summary = fs::read_to_string(layout::report_dir(path).join("summary.md")).unwrap();
    assert!(
        summary.contains("Final success of the 2 to 7 seeds that all of them have in each over"),
        "{summary}"
    );
}

#[test]
fn runs_on_different_grids_give_one_smooth_curve() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for seed in 0..6 {
        let rate = if seed < 4 { 0.7 } else { 0.3 };
        let folder = write_run(path, &key("A", "nova", "default", seed), &[0.0, rate, rate, rate]);
        if seed >= 4 {
            // As if each cycle of training were a little longer.
            for file in [layout::RECORDS, layout::TIMING, layout::OUTCOME] {
                let text = fs::read_to_string(folder.join(file)).unwrap();
                let later = ["1000", "2000", "3000"].iter().fold(text, |text, step| {
                    text.replace(&format!(":{step}"), &format!(":{}50", &step[..2]))
                });
                fs::write(folder.join(file), later).unwrap();
            }
            seal(&folder);
        }
    }
    let store = Store::read(path).unwrap();
    assert_eq!(store.problems(), []);
    let groups = group::groups(&store, &catalogue());
    let curve = Curve::of(&groups[0]);
    assert!(curve.interpolated);
    let points: Vec<(u64, usize, f64)> =
        curve.points.iter().map(|point| (point.step, point.n, (point.mean * 1e3).round() / 1e3)).collect();
    // At 1,000 steps the others are at 1,000 of 1,050 steps of the way to 0.3: (4 * 0.7 + 2 * 0.286) / 6.
    // That they alone go on for 50 steps more gives no point, which would drop to 0.3.
    assert_eq!(points, [(0, 6, 0.0), (1_000, 6, 0.562), (2_000, 6, 0.567), (3_000, 6, 0.567)]);
    let times: Vec<f64> = curve.points.iter().map(|point| point.hours.unwrap()).collect();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
}
