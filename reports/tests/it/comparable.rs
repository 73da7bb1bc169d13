//! Which runs are compared, with what, and what is said of the others.

use std::fs;
use std::path::Path;

use super::support::{key, write_configured, write_run};
use reports::analysis::comparison::{self, Family};
use reports::analysis::complete::{self, Pair};
use reports::analysis::group::{self, GroupKey};
use reports::report::{self, Options};
use reports::stats::{self, Resampling};
use reports::store::Store;
use reports::store::layout;
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
    write(path, "teach", "default", &[(0, 0.5), (1, 0.5), (2, 0.5)]);
    write(path, "vds", "default", &[(0, 0.5)]);
    unfinish(path, "A", "teach", "default", 1);
    // Twice as long, as often as the others are short: in a pair of equals the longer ones stay.
    for seed in 1..3 {
        write_run(path, &key("A", "vds", "default", seed), &[0.0, 0.5, 0.5]);
    }
    let store = Store::read(path).unwrap();
    let groups = group::groups(&store);
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
    write(path, "teach", "default", &[(0, 0.9), (1, 0.8), (2, 1.0)]);
    write(path, "teach", "n=3", &[(0, 0.6), (1, 0.7), (2, 0.7)]);
    write(path, "vds", "default", &[(1, 0.2), (2, 0.5), (3, 0.4)]);
    write(path, "her-iid", "default", &[(0, 0.7), (1, 0.9)]);
    let store = Store::read(path).unwrap();
    let groups = group::groups(&store);
    let compared = group::compared(&groups.iter().map(|group| &group.key).collect::<Vec<_>>());
    let resampling = Resampling { resamples: 100, ..Resampling::default() };
    let found = comparison::comparisons(&groups, &compared, 1, resampling);
    let name = |key: &GroupKey| format!("{} {}", key.curriculum, key.variant);
    let names: Vec<_> = found.iter().map(|c| (c.family, name(c.method), name(c.reference))).collect();
    let row = |family, method: &str| (family, method.to_owned(), "teach default".to_owned());
    let expected = [
        row(Family::Variants, "teach n=3"),
        row(Family::Methods, "vds default"),
        row(Family::Methods, "her-iid default"),
    ];
    assert_eq!(names, expected);
    // Seeds 1 and 2: (0.2 - 0.8 + 0.5 - 1.0) / 2. No run of VDS is above any of TEACH.
    let (variant, vds, her) = (&found[0], &found[1], &found[2]);
    assert_eq!((vds.n, vds.pairs), ((3, 3), 2));
    assert!((vds.difference.unwrap() + 0.55).abs() < 1e-12);
    assert_eq!(vds.sign_flip.unwrap().p, 0.5, "two pairs of one sign");
    assert_eq!(vds.probability_of_improvement, Some(0.0));
    // Of six pairs, 0.7 wins none; 0.9 wins one and ties one.
    assert_eq!(her.probability_of_improvement, Some(1.5 / 6.0));
    // Two tests of methods share the level, the one of a variant has it alone.
    let p = [vds, her].map(|c| c.welch.unwrap().p).into_iter().fold(f64::INFINITY, f64::min);
    assert!([vds, her].iter().any(|c| c.p_holm == Some(2.0 * p)));
    assert_eq!(variant.p_holm, Some(variant.welch.unwrap().p));
    assert_eq!((vds.level, her.level, variant.level), (0.025, 0.025, 0.05));
    assert_eq!(vds.power, stats::power(vds.effect_size.unwrap(), 3, 0.025));
    assert_eq!(vds.needed_seeds, stats::needed_seeds(vds.effect_size.unwrap(), 0.025, 0.8));
}

#[test]
fn sums_and_tables_leave_out_what_is_incomplete_and_say_so() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    for environment in ["MazeA", "MazeB", "MazeC"] {
        for curriculum in ["teach", "vds"] {
            for seed in 0..3 {
                write_run(path, &key(environment, curriculum, "default", seed), &[0.0, 0.5]);
            }
        }
    }
    write_run(path, &key("MazeA", "procurl", "default", 0), &[0.0, 0.5]);
    unfinish(path, "MazeB", "vds", "default", 1);
    let written = report::write(path, &Options::default()).unwrap();
    let csv = fs::read_to_string(layout::report_dir(path).join("aggregates.csv")).unwrap();
    let rows: Vec<String> =
        csv.lines().skip(1).map(|line| line.split(',').take(4).collect::<Vec<_>>().join(" ")).collect();
    assert_eq!(rows, ["teach default 3 9", "vds default 3 8"]);
    let summary = fs::read_to_string(layout::report_dir(path).join("summary.md")).unwrap();
    assert!(summary.contains("Left out, for they lack more of them: ProCuRL."), "{summary}");
    for expected in [
        "sums over environments leave out ProCuRL, which lacks too many of them",
        "comparisons, ledger and sums over environments rest on finished runs of the same evaluations; left out of all runs \
         of methods: 1",
        "no evaluation of these methods of the paper: SPaCE, HER-IID",
        "no evaluation of these environments of the paper: FetchReach, FetchPush, FetchSlide, FetchPickAndPlace, \
         HandReach, HandManipulateBlock, HandManipulatePen, HandManipulateEgg",
    ] {
        assert!(written.missing.iter().any(|other| other == expected), "{expected}: {:#?}", written.missing);
    }
}

#[test]
fn gaps_in_ablations_are_missing_too() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    let write = |environment: &str, variant: &str, seed: u64| {
        let config = json!({"curriculum": {"teach": {"variant": variant}}});
        write_configured(path, &key(environment, "teach", variant, seed), &[0.0, 0.5], config);
    };
    for (environment, variants) in
        [("MazeA", &["default", "n=3", "n=5"][..]), ("MazeB", &["default", "n=3"]), ("MazeC", &["default"])]
    {
        variants.iter().for_each(|variant| (0..2).for_each(|seed| write(environment, variant, seed)));
    }
    fs::remove_dir_all(layout::run_dir(path, &key("MazeB", "teach", "n=3", 1))).unwrap();
    unfinish(path, "MazeA", "teach", "n=5", 0);
    let missing = report::write(path, &Options::default()).unwrap().missing;
    let of_ablations: Vec<&str> =
        missing.iter().map(String::as_str).filter(|line| line.contains("TEACH (n=")).collect();
    // MazeC has no ablation at all, and lacks none.
    let expected = [
        "MazeA: TEACH (n=5): 1 of 2 runs not finished",
        "MazeB: TEACH (n=3) lacks seed 1",
        "MazeB: TEACH (n=5) has no evaluation",
    ];
    assert_eq!(of_ablations, expected);
}
