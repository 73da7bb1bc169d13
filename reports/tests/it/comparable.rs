//! Which runs are compared, with what, and what is said of the others.

use std::fs;
use std::path::Path;

use super::ledger::judging;
use super::support::{key, options, write_configured, write_run};
use reports::analysis::comparison::{self, TestFamily};
use reports::analysis::complete::{self, Pair};
use reports::analysis::group::{self, GroupKey};
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
    let written = reports::write(path, &options()).unwrap();
    let csv = fs::read_to_string(layout::report_dir(path).join("aggregates.csv")).unwrap();
    let rows: Vec<String> =
        csv.lines().skip(1).map(|line| line.split(',').take(4).collect::<Vec<_>>().join(" ")).collect();
    assert_eq!(rows, ["nova default 3 9", "wren default 3 8"]);
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
