//! The ledger of the paper's claims.

use super::{Artefact, Section, columns};
use crate::analysis::ledger::{FEWEST_PAIRS, LedgerEntry};
use crate::analysis::options::ReportOptions;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{or_undefined, with_interval};
use crate::render::table::{Column, Sheet};

const SECTION: Section = Section::Named { id: "ledger", title: "Claims of the paper" };

pub(super) const ROW: Artefact = Artefact::table("ledger", SECTION, "claim of the paper", sheet);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    Sheet::of(caption(analysis.options), &analysis.ledger, &columns())
}

fn columns() -> Vec<Column<'static, LedgerEntry>> {
    let mut columns = vec![
        Column::text("claim", "short name", |row: &LedgerEntry| row.id.clone())
            .named("Claim", |row| row.statement.clone()),
        Column::text("source", "figure of the paper", |row: &LedgerEntry| row.source.to_owned())
            .named("Source", |row| row.source.to_owned()),
        Column::text("statement", "the claim as a testable statement", |row: &LedgerEntry| {
            row.statement.clone()
        }),
        Column::text("verdict", "`confirmed`, `refuted` or `undecided`", |row: &LedgerEntry| {
            row.verdict.as_str().to_owned()
        })
        .named("Verdict", |row| row.verdict.as_str().to_owned()),
        Column::text(
            "value",
            "the value whose effect decides, where the claim is about several; else empty",
            |row: &LedgerEntry| row.value.clone(),
        ),
    ];
    columns.extend(columns::effect(
        |row: &LedgerEntry| Some(row),
        "difference of success rates that decides, mean over environments",
        "coverage of that interval after Bonferroni's correction",
    ));
    columns.extend([
        Column::text("evidence", "all effects in words, or what is missing", |row: &LedgerEntry| {
            row.evidence.clone()
        })
        .named("Evidence", |row| row.evidence.clone()),
        Column::text("rule", "when the claim counts as confirmed or refuted", |row: &LedgerEntry| {
            row.rule.to_owned()
        })
        .named("Rule", |row| row.rule.to_owned()),
        Column::only_shown("Effect", effect),
    ]);
    columns
}

/// `Δ = 5: 0.15 [0.10, 0.20]`.
fn effect(row: &LedgerEntry) -> String {
    let value = row.value.as_ref().map_or(String::new(), |value| format!("{value}: "));
    or_undefined(row.effect.difference, |difference| value + &with_interval(difference, row.effect.interval))
}

fn caption(options: &ReportOptions) -> String {
    let ReportOptions { window, resampling, .. } = options;
    format!(
        "The paper's claims on the data at hand, from finished runs of the same evaluations; others are left out and \
         counted. Effect: difference of success rates (final ones over the last {window} evaluations, or areas under \
         the curve), mean over environments of the mean over pairs of runs with the same seed; of several the one that \
         the verdict hangs on, named. Brackets: what the exact sign-flip test of these pairs does not refuse, at {} % \
         together for claims of one kind (Bonferroni's correction); none where there are too few pairs for the test to \
         refuse anything. Environments with fewer than {FEWEST_PAIRS} pairs are left out. So are values of a setting \
         whose runs are those of the reference evaluation by evaluation: they come to the same in the method, are \
         neither better nor worse, and count for no correction.",
        columns::percent(resampling.confidence),
    )
}
