//! The noise of learning curves, and that a run which failed has none.

use std::path::Path;

use super::ledger::nova;
use super::support::{fail, key, write_configured};
use super::verdicts::{claims, judged, values, write};
use reports::analysis::catalogue::{Measure, Rule};
use reports::analysis::ledger::{LedgerEntry, Verdict};
use tempfile::TempDir;

fn noise(results: &Path, rule: Rule) -> LedgerEntry {
    judged(results, &claims(&[values("window", Measure::Noise, rule)])).remove(0)
}

#[test]
fn noise_is_the_change_from_an_evaluation_to_the_next() {
    let results = TempDir::new().unwrap();
    for environment in ["RoomA", "RoomB"] {
        let rough = |seed: u64| vec![0.0, 0.9, 0.3 + 0.05 * (seed % 3) as f64, 0.8];
        write(results.path(), (environment, "nova", "default"), 7, &nova(10, 1, "online"), rough);
        let smooth = |_: u64| vec![0.0, 0.3, 0.6, 0.8];
        write(results.path(), (environment, "nova", "n=20"), 7, &nova(20, 1, "online"), smooth);
    }
    let entry = noise(results.path(), Rule::SomeBelow);
    assert_eq!(entry.verdict, Verdict::Confirmed, "{entry:#?}");
}

/// Seeds 0 to 6 of NOVA with this window in two rooms, all with the same changes, of which the first `failed`
/// seeds fail after evaluation 5. The changes of one that does not are 0.6 and nineteen times 0.1, 2.5 / 20
/// in the mean; with zeros after the failure they would be 0.6, four times 0.1 and 0.6, 1.6 / 20.
fn write_window(results: &Path, variant: &str, window: u64, failed: u64) {
    let rates: Vec<f64> = (0..=20).map(|i| if i == 0 { 0.0 } else { [0.5, 0.6][i % 2] }).collect();
    for environment in ["RoomA", "RoomB"] {
        for seed in 0..7 {
            let run = key(environment, "nova", variant, seed);
            let length = if seed < failed { 6 } else { rates.len() };
            let folder = write_configured(results, &run, &rates[..length], nova(window, 1, "online"));
            if seed < failed {
                fail(&folder);
            }
        }
    }
}

#[test]
fn a_run_that_failed_is_not_the_least_noisy() {
    // By their zeros the larger window would be less noisy where it fails, the smaller one noisier where
    // n = 10 does: six pairs of fourteen, all of one sign.
    for (failed_default, variant, window, failed, rule) in
        [(0, "n=20", 20, 3, Rule::SomeBelow), (3, "n=3", 3, 0, Rule::SomeAbove)]
    {
        let results = TempDir::new().unwrap();
        write_window(results.path(), "default", 10, failed_default);
        write_window(results.path(), variant, window, failed);
        let entry = noise(results.path(), rule);
        assert_eq!(entry.verdict, Verdict::Undecided, "{entry:#?}");
        assert_eq!((entry.effect.pairs, entry.effect.failed), (8, 0));
        assert_eq!(entry.effect.difference, Some(0.0));
        let expected = "; no pair, for a run of it failed: RoomA (seeds 0, 1, 2), RoomB (seeds 0, 1, 2)";
        assert!(entry.evidence.contains(expected), "{}", entry.evidence);
    }
}

#[test]
fn where_every_pair_has_a_failed_run_none_is_left() {
    let results = TempDir::new().unwrap();
    write_window(results.path(), "default", 10, 0);
    write_window(results.path(), "n=20", 20, 7);
    let entry = noise(results.path(), Rule::SomeBelow);
    assert_eq!((entry.verdict, entry.effect.pairs), (Verdict::Undecided, 0));
    let expected = "n = 20: too few seeds: 0 pairs of runs, 5 are needed; no pair, for a run of it failed: RoomA (seeds 0, 1, \
                    2, 3, 4, 5, 6), RoomB (seeds 0, 1, 2, 3, 4, 5, 6)";
    assert!(entry.evidence.starts_with(expected), "{}", entry.evidence);
}
