//! Methods over all environments that they share.

use polars::prelude::DataFrame;

use super::cells::{BOOTSTRAP_COVERAGE, decimal, with_interval};
use super::{Table, column};
use crate::analysis::aggregate::{Aggregate, TARGET};
use crate::analysis::group::GroupKey;
use crate::error::ReportError;
use crate::methods;
use crate::stats::Resampling;

/// The aggregates as a data frame, unrounded; null where an interval is not defined.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn aggregate_frame(rows: &[Aggregate<'_>], environments: usize) -> Result<DataFrame, ReportError> {
    let columns = vec![
        column("curriculum", rows, |row| row.method.curriculum.as_str()),
        column("variant", rows, |row| row.method.variant.as_str()),
        column("environments", rows, |_| environments as u64),
        column("runs", rows, |row| row.runs as u64),
        column("mean", rows, |row| row.mean),
        column("iqm", rows, |row| row.iqm),
        column("iqm_ci_low", rows, |row| row.iqm_ci.map(|ci| ci.0)),
        column("iqm_ci_high", rows, |row| row.iqm_ci.map(|ci| ci.1)),
        column("optimality_gap", rows, |row| row.optimality_gap),
        column("optimality_gap_ci_low", rows, |row| row.optimality_gap_ci.map(|ci| ci.0)),
        column("optimality_gap_ci_high", rows, |row| row.optimality_gap_ci.map(|ci| ci.1)),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

/// `TEACH (n=3)`.
fn names(keys: &[&GroupKey]) -> Vec<String> {
    keys.iter().map(|key| format!("{}{}", methods::title(&key.curriculum), key.detail())).collect()
}

const HEADER: [&str; 6] = ["Curriculum", "Variant", "Runs", "Mean", "IQM", "Optimality gap"];

/// The aggregates as a table to read; `left_out` are methods that lack too many environments.
pub fn aggregate_table(
    rows: &[Aggregate<'_>],
    environments: &[&str],
    left_out: &[&GroupKey],
    resampling: Resampling,
) -> Table {
    let cells = |row: &Aggregate<'_>| {
        [
            methods::title(&row.method.curriculum).to_owned(),
            row.method.variant.clone(),
            row.runs.to_string(),
            decimal(row.mean),
            with_interval(row.iqm, row.iqm_ci),
            with_interval(row.optimality_gap, row.optimality_gap_ci),
        ]
    };
    let caption = format!(
        "Final success of finished runs over the {} environments in which every method here has results: {}.{} Mean: over environments of \
         the mean over seeds. IQM: interquartile mean of all runs. Optimality gap: how far runs fall short of \
         {TARGET} on average, less is better. Brackets: {} % percentile bootstrap intervals, stratified by \
         environment; they describe and decide nothing: {BOOTSTRAP_COVERAGE}.",
        environments.len(),
        environments.join(", "),
        if left_out.is_empty() {
            String::new()
        } else {
            format!(" Left out, for they lack more of them: {}.", names(left_out).join(", "))
        },
        resampling.confidence * 100.0,
    );
    Table::new(caption, 2, HEADER, rows.iter().map(cells))
}
