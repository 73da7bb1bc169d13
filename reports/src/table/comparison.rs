//! Methods against the first method of each environment.

use polars::prelude::DataFrame;

use super::cells::{UNDEFINED, decimal, or_undefined, thousands, with_interval};
use super::{Table, column};
use crate::comparison::{ALPHA, Comparison, TARGET_POWER};
use crate::error::ReportError;
use crate::group::GroupKey;
use crate::methods;
use crate::stats::Resampling;

/// The comparisons as a data frame, unrounded; null where a number is not defined.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn comparison_frame(rows: &[Comparison<'_>]) -> Result<DataFrame, ReportError> {
    let columns = vec![
        column("environment", rows, |row| row.method.environment.as_str()),
        column("curriculum", rows, |row| row.method.curriculum.as_str()),
        column("variant", rows, |row| row.method.variant.as_str()),
        column("reference_curriculum", rows, |row| row.reference.curriculum.as_str()),
        column("reference_variant", rows, |row| row.reference.variant.as_str()),
        column("n_seeds", rows, |row| row.n.0 as u64),
        column("n_reference", rows, |row| row.n.1 as u64),
        column("n_pairs", rows, |row| row.pairs as u64),
        column("difference", rows, |row| row.difference),
        column("difference_ci_low", rows, |row| row.difference_ci.map(|ci| ci.0)),
        column("difference_ci_high", rows, |row| row.difference_ci.map(|ci| ci.1)),
        column("probability_of_improvement", rows, |row| row.probability_of_improvement),
        column("welch_t", rows, |row| row.welch.map(|test| test.t)),
        column("welch_df", rows, |row| row.welch.map(|test| test.df)),
        column("welch_p", rows, |row| row.welch.map(|test| test.p)),
        column("p_holm", rows, |row| row.p_holm),
        column("effect_size", rows, |row| row.effect_size),
        column("power", rows, |row| row.power),
        column("needed_seeds", rows, |row| row.needed_seeds),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 9] = [
    "Environment",
    "Method",
    "Reference",
    "Pairs",
    "Difference",
    "P(improvement)",
    "p (Holm)",
    "Power",
    "Seeds needed",
];

/// The comparisons as a table to read.
pub fn comparison_table(rows: &[Comparison<'_>], resampling: Resampling) -> Table {
    let cells = |row: &Comparison<'_>| {
        [
            row.method.environment.clone(),
            name(row.method),
            name(row.reference),
            row.pairs.to_string(),
            or_undefined(row.difference, |difference| with_interval(difference, row.difference_ci)),
            or_undefined(row.probability_of_improvement, decimal),
            or_undefined(row.p_holm, p_value),
            or_undefined(row.power, decimal),
            or_undefined(row.needed_seeds, thousands),
        ]
    };
    Table::new(caption(resampling), 3, HEADER, rows.iter().map(cells))
}

fn caption(resampling: Resampling) -> String {
    format!(
        "Final success of each method against the first method of its environment. Difference: method minus \
         reference, mean over the seeds that both have, with its {} % paired bootstrap interval. P(improvement): \
         probability that a random run of the method scores above one of the reference, ties counting one half. p: \
         Welch's two-sided t-test, corrected by Holm's method for all tests of this table; {UNDEFINED} where neither \
         side varies. A variant whose runs are those of the reference evaluation by evaluation is left out. Power: to find an effect of the observed size with the seeds at hand at level {ALPHA}; an \
         observed effect makes it optimistic. Seeds needed: on each side, for a power of {TARGET_POWER}; {UNDEFINED} \
         for more than 10,000.",
        resampling.confidence * 100.0,
    )
}

fn name(key: &GroupKey) -> String {
    format!("{}{}", methods::title(&key.curriculum), key.detail())
}

/// Three digits, or how small it is at least.
fn p_value(p: f64) -> String {
    if p < 0.001 { "< 0.001".into() } else { format!("{p:.3}") }
}
