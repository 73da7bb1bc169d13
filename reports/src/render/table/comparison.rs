//! Methods against the first method of each environment.

use polars::prelude::DataFrame;

use super::cells::{BOOTSTRAP_COVERAGE, UNDEFINED, decimal, or_undefined, p_value, thousands, with_interval};
use super::{Table, column};
use crate::analysis::comparison::{ALPHA, Comparison, TARGET_POWER};
use crate::analysis::group::GroupKey;
use crate::error::ReportError;
use crate::methods;
use crate::stats::Resampling;

/// The comparisons as a data frame, unrounded; null where a number is not defined.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn comparison_frame(rows: &[Comparison<'_>]) -> Result<DataFrame, ReportError> {
    let columns = vec![
        column("family", rows, |row| row.family.as_str()),
        column("environment", rows, |row| row.method.environment.as_str()),
        column("curriculum", rows, |row| row.method.curriculum.as_str()),
        column("variant", rows, |row| row.method.variant.as_str()),
        column("reference_curriculum", rows, |row| row.reference.curriculum.as_str()),
        column("reference_variant", rows, |row| row.reference.variant.as_str()),
        column("n_seeds", rows, |row| row.n.0 as u64),
        column("n_reference", rows, |row| row.n.1 as u64),
        column("runs_left_out", rows, |row| row.left_out as u64),
        column("n_pairs", rows, |row| row.pairs as u64),
        column("difference", rows, |row| row.difference),
        column("difference_ci_low", rows, |row| row.difference_ci.map(|ci| ci.0)),
        column("difference_ci_high", rows, |row| row.difference_ci.map(|ci| ci.1)),
        column("sign_flip_p", rows, |row| row.sign_flip.map(|test| test.p)),
        column("probability_of_improvement", rows, |row| row.probability_of_improvement),
        column("welch_t", rows, |row| row.welch.map(|test| test.t)),
        column("welch_df", rows, |row| row.welch.map(|test| test.df)),
        column("welch_p", rows, |row| row.welch.map(|test| test.p)),
        column("p_holm", rows, |row| row.p_holm),
        column("effect_size", rows, |row| row.effect_size),
        column("level", rows, |row| row.level),
        column("power", rows, |row| row.power),
        column("needed_seeds", rows, |row| row.needed_seeds),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 10] = [
    "Environment",
    "Method",
    "Reference",
    "Pairs",
    "Difference",
    "p (sign flips)",
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
            or_undefined(row.sign_flip, |test| p_value(test.p)),
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
        "Final success of each method against the first method of its environment, and of each variant of a method \
         against its default, from finished runs of the same evaluations. Difference: method minus reference, mean over \
         the seeds that both have, with its {} % paired bootstrap interval: {BOOTSTRAP_COVERAGE}. p (sign flips): exact \
         test of these pairs, uncorrected; it cannot fall below 0.016 for 7 pairs. P(improvement): probability that a \
         random run of the method scores above one of the reference, ties counting one half. p (Holm): Welch's two-sided \
         t-test, which does not use the pairs, corrected by Holm's method for all comparisons of methods, and for all of \
         variants; {UNDEFINED} where neither side varies. Variants whose runs are those of the reference evaluation by \
         evaluation are left out. Power: to find an effect of the observed size with the seeds at hand at the strictest \
         level of that correction ({ALPHA} over the number of tests); an observed effect makes it optimistic. Seeds \
         needed: on each side, for a power of {TARGET_POWER} at that level; {UNDEFINED} for more than 10,000.",
        resampling.confidence * 100.0,
    )
}

fn name(key: &GroupKey) -> String {
    format!("{}{}", methods::title(&key.curriculum), key.detail())
}
