//! The ledger of the paper's claims.

use polars::prelude::DataFrame;

use super::cells::{or_undefined, with_interval};
use super::{Table, column};
use crate::analysis::ledger::{Entry, FEWEST_PAIRS};
use crate::error::ReportError;
use crate::stats::Resampling;

/// The ledger as a data frame, unrounded; null where an effect is not defined.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn ledger_frame(rows: &[Entry]) -> Result<DataFrame, ReportError> {
    let columns = vec![
        column("claim", rows, |row| row.id.as_str()),
        column("source", rows, |row| row.source),
        column("statement", rows, |row| row.statement.as_str()),
        column("verdict", rows, |row| row.verdict.as_str()),
        column("value", rows, |row| row.value.as_deref()),
        column("effect", rows, |row| row.effect.difference),
        column("ci_low", rows, |row| row.effect.interval.map(|ci| ci.0)),
        column("ci_high", rows, |row| row.effect.interval.map(|ci| ci.1)),
        column("confidence", rows, |row| row.confidence),
        column("p", rows, |row| row.effect.p),
        column("environments", rows, |row| row.effect.environments.len() as u64),
        column("environments_ahead", rows, |row| row.effect.ahead as u64),
        column("environments_behind", rows, |row| row.effect.behind as u64),
        column("pairs", rows, |row| row.effect.pairs as u64),
        column("runs_left_out", rows, |row| row.effect.left_out as u64),
        column("evidence", rows, |row| row.evidence.as_str()),
        column("rule", rows, |row| row.rule),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 6] = ["Claim", "Source", "Verdict", "Evidence", "Rule", "Effect"];

/// The ledger as a table to read.
pub fn ledger_table(rows: &[Entry], window: usize, resampling: Resampling) -> Table {
    let effect = |row: &Entry| {
        let value = row.value.as_ref().map_or(String::new(), |value| format!("{value}: "));
        or_undefined(row.effect.difference, |difference| {
            value + &with_interval(difference, row.effect.interval)
        })
    };
    let cells = |row: &Entry| {
        [
            row.statement.clone(),
            row.source.to_owned(),
            row.verdict.as_str().to_owned(),
            row.evidence.clone(),
            row.rule.to_owned(),
            effect(row),
        ]
    };
    let caption = format!(
        "The paper's claims on the data at hand, from finished runs of the same evaluations; others are left out and \
         counted. Effect: difference of success rates (final ones over the last {window} evaluations, or areas under \
         the curve), mean over environments of the mean over pairs of runs with the same seed; of several the one that \
         the verdict hangs on, named. Brackets: what the exact sign-flip test of these pairs does not refuse, at {} % \
         together for claims of one kind (Bonferroni's correction); none where there are too few pairs for the test to \
         refuse anything. Environments with fewer than {FEWEST_PAIRS} pairs are left out. So are values of a setting \
         whose runs are those of the reference evaluation by evaluation: they come to the same in the method, are \
         neither better nor worse, and count for no correction.",
        resampling.confidence * 100.0,
    );
    Table::new(caption, 5, HEADER, rows.iter().map(cells))
}
