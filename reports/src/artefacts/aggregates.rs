//! Methods over all environments that they share.

use super::{ACROSS, Artefact, columns};
use crate::analysis::aggregate::{Aggregate, TARGET};
use crate::analysis::group::GroupKey;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{BOOTSTRAP_COVERAGE, decimal, with_interval};
use crate::render::table::{Column, Sheet};
use crate::wording::counted;

pub(super) const ROW: Artefact =
    Artefact::table("aggregates", ACROSS, "method over the shared environments", sheet);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let across = &analysis.across;
    Sheet::of(caption(analysis), &across.aggregates, &columns(across.environments.len()))
}

fn columns<'a>(environments: usize) -> [Column<'a, Aggregate<'a>>; 12] {
    [
        columns::curriculum(|row: &Aggregate<'_>| row.method),
        columns::variant(|row: &Aggregate<'_>| row.method),
        Column::count("environments", "environments that all methods of the file have", move |_| {
            environments as u64
        }),
        Column::count("runs", "runs in them of the seeds that all methods have", |row: &Aggregate<'_>| {
            row.runs as u64
        })
        .shown("Runs", |row| match row.failed {
            0 => row.runs.to_string(),
            failed => format!("{} ({failed} failed)", row.runs),
        }),
        Column::count(
            "runs_failed",
            "those of them that failed, and count 0 from their failure on",
            |row: &Aggregate<'_>| row.failed as u64,
        ),
        Column::real(
            "mean",
            "mean over environments of the mean final success over seeds",
            |row: &Aggregate<'_>| row.mean,
        )
        .shown("Mean", |row| decimal(row.mean)),
        Column::real("iqm", "interquartile mean of the final success of all runs", |row: &Aggregate<'_>| {
            row.iqm
        })
        .shown("IQM", |row| with_interval(row.iqm, row.iqm_ci)),
        Column::real(
            "iqm_ci_low",
            "lower end of its bootstrap interval, stratified by environment",
            |row: &Aggregate<'_>| row.iqm_ci.map(|ci| ci.0),
        ),
        Column::real("iqm_ci_high", "its upper end", |row: &Aggregate<'_>| row.iqm_ci.map(|ci| ci.1)),
        Column::real(
            "optimality_gap",
            "mean over runs of what the final success lacks to 1",
            |row: &Aggregate<'_>| row.optimality_gap,
        )
        .shown("Optimality gap", |row| with_interval(row.optimality_gap, row.optimality_gap_ci)),
        Column::real(
            "optimality_gap_ci_low",
            "lower end of its bootstrap interval, stratified by environment",
            |row: &Aggregate<'_>| row.optimality_gap_ci.map(|ci| ci.0),
        ),
        Column::real("optimality_gap_ci_high", "its upper end", |row: &Aggregate<'_>| {
            row.optimality_gap_ci.map(|ci| ci.1)
        }),
    ]
}

/// ` 2 runs failed: they count 0 from their failure on.`
fn failed_in_words(failed: usize) -> String {
    match failed {
        0 => String::new(),
        1 => " 1 run failed: it counts 0 from its failure on.".to_owned(),
        k => format!(" {k} runs failed: they count 0 from their failure on."),
    }
}

fn caption(analysis: &Analysis<'_>) -> String {
    let across = &analysis.across;
    let left_out: Vec<String> = across.left_out.iter().copied().map(GroupKey::name).collect();
    format!(
        "Final success {} over the {} in which every method here has results: {}.{}{} Mean: \
         over environments of the mean over seeds. IQM: interquartile mean of all runs. Optimality gap: how far runs \
         fall short of {TARGET} on average, less is better. Brackets: {} % percentile bootstrap intervals, stratified \
         by environment; they describe and decide nothing: {BOOTSTRAP_COVERAGE}.",
        across.seeds,
        counted(across.environments.len(), "environment"),
        across.environments.join(", "),
        failed_in_words(across.failed),
        if left_out.is_empty() {
            String::new()
        } else {
            format!(" Left out, for they lack more of them: {}.", left_out.join(", "))
        },
        columns::percent(analysis.options.resampling.confidence),
    )
}
