//! How often verdicts are wrong, and how often they find what is there: experiments whose truth is known are
//! simulated and judged by the public path from runs to the ledger and the comparisons.
//!
//! Tests keep the false verdicts of a few designs below what the rules promise. The tables of the docs come
//! from a longer simulation, which takes minutes:
//!
//! ```sh
//! cargo test --release -p reports --test calibration -- tables --ignored --nocapture
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
use truth::{Design, TRUTHS};

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
