//! The summary: a row per environment, curriculum and variant.

use super::{Artefact, RESULTS, Repeated, columns};
use crate::analysis::curves::DDOF;
use crate::analysis::options::{Failures, ReportOptions};
use crate::analysis::summary::GroupSummary;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{
    BOOTSTRAP_COVERAGE, UNDEFINED, decimal, or_undefined, span, thousands, with_interval, with_spread,
};
use crate::render::table::{Column, Sheet};
use crate::stats::Resampling;
use crate::wording::counted;

pub(super) const ROW: Artefact =
    Artefact::table("summary", RESULTS, "environment, curriculum and variant", sheet)
        .repeated(Repeated::Open);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    Sheet::of(
        caption(analysis.options),
        &analysis.summaries,
        &columns(analysis.summaries.iter().any(|row| row.n_failed > 0)),
    )
}

/// `any_failed`: whether the analysis without failed runs is to be read beside the other.
fn columns(any_failed: bool) -> Vec<Column<'static, GroupSummary>> {
    vec![
        columns::environment(|row| &row.key),
        columns::curriculum(|row| &row.key),
        columns::variant(|row| &row.key),
        columns::seeds(|row: &GroupSummary| row.n_seeds).shown("Seeds", seeds),
        columns::finished(),
        columns::failed(),
        Column::only_shown("Steps", |row: &GroupSummary| span(row.cost.steps)),
        Column::real("final_mean", "mean over seeds of the final success", |row: &GroupSummary| row.final_mean)
            .shown("Final success", |row| with_spread(row.final_mean, row.final_std)),
        Column::real("final_std", "its standard deviation over seeds, ddof = 1; empty for one seed", |row: &GroupSummary| {
            row.final_std
        }),
        without_failed(any_failed),
        Column::real("final_finished_std", "its standard deviation over seeds", |row: &GroupSummary| {
            row.final_of_finished.and_then(|of| of.1)
        }),
        Column::real(
            "final_any_mean",
            "mean over seeds of the final success at any step of an episode; empty where a seed has no record of it",
            |row: &GroupSummary| row.final_any_mean,
        )
        .shown("At any step", |row| or_undefined(row.final_any_mean, decimal)),
        Column::real("final_iqm", "interquartile mean over seeds of the final success", |row: &GroupSummary| row.final_iqm)
            .shown("IQM", |row| or_undefined(row.final_iqm, |iqm| with_interval(iqm, row.final_ci))),
        Column::real(
            "final_ci_low",
            "lower end of the bootstrap interval of final_iqm; empty for one seed",
            |row: &GroupSummary| row.final_ci.map(|ci| ci.0),
        ),
        Column::real("final_ci_high", "its upper end", |row: &GroupSummary| row.final_ci.map(|ci| ci.1)),
        Column::only_shown("Best mean", |row: &GroupSummary| {
            or_undefined(row.best, |best| format!("{} at {}", decimal(best.mean), thousands(best.step)))
        }),
        Column::real(
            "auc_mean",
            "mean over seeds of the area under the success rate, divided by the steps it spans",
            |row: &GroupSummary| row.auc_mean,
        )
        .shown("AUC", |row| with_spread(row.auc_mean, row.auc_std)),
        Column::real("auc_std", "its standard deviation over seeds, ddof = 1", |row: &GroupSummary| row.auc_std),
        Column::count(
            "steps_to_50",
            "step by which half of the seeds had come to a success of 0.5 and kept it in the mean; empty where censored",
            |row: &GroupSummary| row.steps_to_50,
        )
        .shown("Steps to 50 %", |row| steps_to(row.steps_to_50, row.reached_50, row.n_counted)),
        Column::count("steps_to_80", "the same for 0.8", |row: &GroupSummary| row.steps_to_80)
            .shown("Steps to 80 %", |row| steps_to(row.steps_to_80, row.reached_80, row.n_counted)),
        Column::real(
            "wall_hours",
            "mean over finished runs of the hours of wall-clock time up to the last evaluation",
            |row: &GroupSummary| row.cost.wall_hours,
        ),
        Column::real("gradient_steps", "mean over finished runs of the student's gradient steps", |row: &GroupSummary| {
            row.cost.gradient_steps
        }),
    ]
}

/// The final success of finished runs alone.
fn without_failed(shown: bool) -> Column<'static, GroupSummary> {
    let column = Column::real(
        "final_finished_mean",
        "the same mean without failed runs; empty where none failed, or none finished",
        |row: &GroupSummary| row.final_of_finished.map(|of| of.0),
    );
    let text =
        |row: &GroupSummary| or_undefined(row.final_of_finished, |(mean, std)| with_spread(Some(mean), std));
    if shown { column.shown("Without failed", text) } else { column }
}

fn caption(options: &ReportOptions) -> String {
    let window = counted(options.window, "evaluation");
    let Resampling { resamples, confidence, .. } = options.resampling;
    format!(
        "Numbers of runs that have ended{}; where none has, of all as far as they got. \
         Final success: success rate averaged over the last {window} of each seed, that of the untrained \
         student never among them, then mean ± standard deviation over seeds (ddof = {DDOF}). Without failed: the same \
         of finished runs alone, where some failed. At any step: the same mean of the share of episodes that were successful after \
         at least one of their actions, where the final success counts the last step alone; {UNDEFINED} where a seed has no \
         record of it. IQM: interquartile mean over seeds of the final success, with its \
         {} % percentile bootstrap interval ({} resamples), which describes and decides nothing: \
         {BOOTSTRAP_COVERAGE}. Best mean: highest point of the mean curve. \
         AUC: area under the success rate over training steps divided by those steps, mean ± standard deviation \
         over seeds. Steps to 50 % and 80 %: the step by which at least half of the seeds had come to a success rate \
         of 0.5 or 0.8: their first evaluation of at least that, from which on the mean of {window} is no lower; \
         {UNDEFINED} where fewer did; in parentheses the seeds that did, \
         where some did not by their last evaluation (censored): these count as later than all others. Steps: training \
         steps at the last evaluation, a range where seeds differ; Seeds: finished runs of all runs where some are \
         not finished, and how many failed.",
        failures_in_words(options.failures),
        columns::percent(confidence),
        thousands(resamples as u64),
    )
}

/// `20,000 (5 of 7)`: the median, and how many seeds reached the rate where not all did.
fn steps_to(median: Option<u64>, reached: usize, n: usize) -> String {
    let text = or_undefined(median, thousands);
    if reached == n { text } else { format!("{text} ({reached} of {n})") }
}

/// `5 of 7, 2 failed`.
fn seeds(row: &GroupSummary) -> String {
    let failed = if row.n_failed == 0 { String::new() } else { format!(", {} failed", row.n_failed) };
    if row.n_finished == row.n_seeds {
        row.n_seeds.to_string()
    } else {
        format!("{} of {}{failed}", row.n_finished, row.n_seeds)
    }
}

fn failures_in_words(failures: Failures) -> &'static str {
    match failures {
        Failures::Zero => ": failed ones count 0 from their failure on",
        Failures::Apart => " and did not fail",
    }
}
