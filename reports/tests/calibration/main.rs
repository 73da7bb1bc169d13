//! How often verdicts are wrong, and how often they find what is there: experiments whose truth is known are
//! simulated and judged by the public path from runs to the ledger and the comparisons.
//!
//! Tests keep the false verdicts of a few designs below what the rules promise. The tables of the docs come
//! from a longer simulation, which takes minutes:
//!
//! ```sh
//! cargo test --release --workspace --test calibration -- tables --ignored --nocapture
//! ```
//!
//! `CALIBRATION_REPETITIONS` sets its number of experiments per design and truth.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod curve;
mod experiment;
mod fixture;
mod table;
mod tally;
mod truth;

use tally::{Effort, Tally};
use truth::{Design, TRUTHS, Truth};

/// Environments × seeds: a few environments, those of the paper, the paper's with three seeds, and the
/// paper's with a family of ten methods.
const DESIGNS: [Design; 5] = [
    Design::new(2, 7, 4),
    Design::new(4, 7, 4),
    Design::new(11, 7, 4),
    Design::new(11, 3, 4),
    Design::new(11, 7, 9),
];

#[test]
#[ignore = "minutes; prints the tables of harness/docs/reports.md"]
#[expect(clippy::print_stdout, reason = "the tables are what it is for")]
fn tables() {
    let repetitions = std::env::var("CALIBRATION_REPETITIONS").map_or(1_000, |text| text.parse().unwrap());
    let effort = Effort { repetitions, flips: 2_000 };
    let mut counts = Vec::new();
    for (row, &design) in DESIGNS.iter().enumerate() {
        let tally = |(index, &truth)| Tally::of(design, truth, (100 * row + index) as u64, effort);
        counts.push(TRUTHS.iter().enumerate().map(tally).collect());
    }
    println!("{repetitions} experiments per cell.\n\n{}", table::markdown(&DESIGNS, &counts));
}

/// Experiments per design and truth of the tests below.
const QUICK: Effort = Effort { repetitions: 200, flips: 1_000 };

/// What may be false in so many of [`QUICK`]: `level`, and three standard errors of the simulation.
fn most(level: f64) -> u64 {
    let all = QUICK.repetitions as f64;
    (level * all + 3.0 * (level * (1.0 - level) * all).sqrt()).floor() as u64
}

/// The designs of the tests: few environments, and many with few seeds.
const FEW: Design = Design::new(2, 7, 4);
const MANY: Design = Design::new(11, 3, 4);

#[test]
fn false_verdicts_are_no_more_frequent_than_promised() {
    for (seed, design) in [(1_000, FEW), (2_000, MANY)] {
        for truth in [Truth::Equal, Truth::Mixed(0.2), Truth::AboveOne(0.1)] {
            let tally = Tally::of(design, truth, seed, QUICK);
            let falsities = [tally.above_false, tally.invariance_false(truth), tally.found_false];
            assert!(falsities.iter().all(|count| *count <= most(0.05)), "{design:?}, {truth:?}: {tally:?}");
        }
    }
}

#[test]
fn rare_collapses_turn_few_verdicts_on_means() {
    // Whoever saw no collapse cannot know of any: the verdict rests on the pairs being exchangeable.
    let tally = Tally::of(FEW, Truth::Collapses, 3_000, QUICK);
    assert!(tally.above_false <= most(0.05), "{tally:?}");
    assert!(tally.invariance_false(Truth::Collapses) <= most(0.05), "{tally:?}");
}

#[test]
fn what_is_there_is_found() {
    let share = |count: u64, all: u64| count as f64 / all as f64;
    for (seed, design, by, least) in
        [(4_000, FEW, 0.2, 0.6), (5_000, MANY, 0.1, 0.4), (6_000, MANY, 0.2, 0.9)]
    {
        let tally = Tally::of(design, Truth::Above(by), seed, QUICK);
        let power = share(tally.above.confirmed, tally.above.all());
        assert!(power >= least, "{design:?}, {by}: {power} of {tally:?}");
    }
}
