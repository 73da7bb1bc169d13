//! The summary: a row per environment, curriculum and variant.

use polars::prelude::DataFrame;

use super::cells::{
    BOOTSTRAP_COVERAGE, UNDEFINED, decimal, or_undefined, span, thousands, with_interval, with_spread,
};
use super::{Table, column};
use crate::analysis::curves::DDOF;
use crate::analysis::summary::Row;
use crate::error::ReportError;
use crate::methods;
use crate::stats::Resampling;

/// The rows as a data frame: all numbers unrounded, null where a number is not defined (one seed, censored).
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn summary_frame(rows: &[Row]) -> Result<DataFrame, ReportError> {
    let columns = vec![
        column("environment", rows, |row| row.key.environment.as_str()),
        column("curriculum", rows, |row| row.key.curriculum.as_str()),
        column("variant", rows, |row| row.key.variant.as_str()),
        column("n_seeds", rows, |row| row.n_seeds as u64),
        column("final_mean", rows, |row| row.final_mean),
        column("final_std", rows, |row| row.final_std),
        column("final_any_mean", rows, |row| row.final_any_mean),
        column("final_iqm", rows, |row| row.final_iqm),
        column("final_ci_low", rows, |row| row.final_ci.map(|ci| ci.0)),
        column("final_ci_high", rows, |row| row.final_ci.map(|ci| ci.1)),
        column("auc_mean", rows, |row| row.auc_mean),
        column("auc_std", rows, |row| row.auc_std),
        column("steps_to_50", rows, |row| row.steps_to_50),
        column("steps_to_80", rows, |row| row.steps_to_80),
        column("wall_hours", rows, |row| row.cost.wall_hours),
        column("gradient_steps", rows, |row| row.cost.gradient_steps),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 12] = [
    "Environment",
    "Curriculum",
    "Variant",
    "Seeds",
    "Steps",
    "Final success",
    "At any step",
    "IQM",
    "Best mean",
    "AUC",
    "Steps to 50 %",
    "Steps to 80 %",
];

/// The rows as a table to read.
pub fn summary_table(rows: &[Row], window: usize, resampling: Resampling) -> Table {
    let cells = |row: &Row| {
        [
            row.key.environment.clone(),
            methods::title(&row.key.curriculum).to_owned(),
            row.key.variant.clone(),
            seeds(row),
            span(row.cost.steps),
            with_spread(Some(row.final_mean), row.final_std),
            or_undefined(row.final_any_mean, decimal),
            with_interval(row.final_iqm, row.final_ci),
            or_undefined(row.best, |best| format!("{} at {}", decimal(best.mean), thousands(best.step))),
            with_spread(row.auc_mean, row.auc_std),
            steps_to(row.steps_to_50, row.reached_50, row.n_seeds),
            steps_to(row.steps_to_80, row.reached_80, row.n_seeds),
        ]
    };
    Table::new(caption(window, resampling), 3, HEADER, rows.iter().map(cells))
}

fn caption(window: usize, resampling: Resampling) -> String {
    let Resampling { resamples, confidence, .. } = resampling;
    format!(
        "Final success: success rate averaged over the last {window} evaluations of each seed, then mean ± standard \
         deviation over seeds (ddof = {DDOF}). At any step: the same mean of the share of episodes that were successful after \
         at least one of their actions, where the final success counts the last step alone; {UNDEFINED} where a seed has no \
         record of it. IQM: interquartile mean over seeds of the final success, with its \
         {} % percentile bootstrap interval ({} resamples), which describes and decides nothing: \
         {BOOTSTRAP_COVERAGE}. Best mean: highest point of the mean curve. \
         AUC: area under the success rate over training steps divided by those steps, mean ± standard deviation \
         over seeds. Steps to 50 % and 80 %: the step by which at least half of the seeds had a mean success rate \
         of 0.5 or 0.8 over {window} evaluations in a row; {UNDEFINED} where fewer did; in parentheses the seeds that did, \
         where some did not by their last evaluation (censored): these count as later than all others. Steps: training \
         steps at the last evaluation, a range where seeds differ; Seeds: finished runs of all runs where some are \
         not finished.",
        confidence * 100.0,
        thousands(resamples as u64),
    )
}

/// `20,000 (5 of 7)`: the median, and how many seeds reached the rate where not all did.
fn steps_to(median: Option<u64>, reached: usize, n: usize) -> String {
    let text = or_undefined(median, thousands);
    if reached == n { text } else { format!("{text} ({reached} of {n})") }
}

fn seeds(row: &Row) -> String {
    if row.n_finished == row.n_seeds {
        row.n_seeds.to_string()
    } else {
        format!("{} of {}", row.n_finished, row.n_seeds)
    }
}
