//! The ledger of the paper's claims.

use super::{Artefact, Section, columns};
use crate::analysis::ledger::LedgerEntry;
use crate::analysis::options::ReportOptions;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{decimal, or_undefined, p_value, thousands, with_interval};
use crate::render::table::{Column, Sheet};
use crate::stats::MOST_ENUMERATED;
use crate::wording::counted;

const SECTION: Section = Section::Named { id: "ledger", title: "Claims of the paper" };

pub(super) const ROW: Artefact = Artefact::table("ledger", SECTION, "claim of the paper", sheet);

const ELSEWHERE: Section =
    Section::Named { id: "ledger-elsewhere", title: "The same claims in environments outside the paper" };

pub(super) const ROW_ELSEWHERE: Artefact = Artefact::table(
    "ledger-elsewhere",
    ELSEWHERE,
    "claim of the paper on environments that are none of its tasks",
    sheet_elsewhere,
);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    Sheet::of(caption(analysis.options), &analysis.ledger, &columns())
}

fn sheet_elsewhere(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let caption = "The paper's claims judged by the same rules on the environments here that are none of its tasks. The \
                   paper says nothing of them: no verdict of its ledger rests on these. Claims without any runs are left \
                   out.";
    Sheet::of(caption.to_owned(), &analysis.ledger_elsewhere, &columns())
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
        Column::text(
            "verdict",
            "`confirmed`, `refuted`, `undecided` or `not testable`",
            |row: &LedgerEntry| row.verdict.as_str().to_owned(),
        )
        .named("Verdict", |row| row.verdict.as_str().to_owned()),
        Column::text(
            "value",
            "the value whose effect decides, with its environment where each is judged; else empty",
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
            row.rule.clone()
        })
        .named("Rule", |row| row.rule.clone()),
        Column::only_shown("Effect", effect),
        Column::only_shown("Pairs ahead", |row: &LedgerEntry| {
            let shares = row.effect.improvement.zip(row.effect.improvement_p);
            or_undefined(shares, |(share, p)| format!("{} (p = {})", decimal(share), p_value(p)))
        }),
    ]);
    columns
}

/// `Δ = 5: 0.15 [0.10, 0.20]`.
fn effect(row: &LedgerEntry) -> String {
    let value = row.value.as_ref().map_or(String::new(), |value| format!("{value}: "));
    or_undefined(row.effect.difference, |difference| value + &with_interval(difference, row.effect.interval))
}

fn caption(options: &ReportOptions) -> String {
    let ReportOptions { window, resampling, margin, fewest_pairs, .. } = options;
    let window = counted(*window, "evaluation");
    format!(
        "The paper's claims on the data at hand, from comparable runs on the paper's tasks; others are left out and counted. \
         Effect: difference of success rates (final ones over the last {window}, or areas under the curve), \
         mean over environments of the mean over pairs of runs with the same seed; of several the one that the verdict \
         hangs on, named, with its environment where a claim is judged in each. Brackets: what the sign-flip test of these \
         pairs does not refuse, at {} % together for claims of one kind (Bonferroni's correction); none where there are \
         too few pairs for the test to refuse anything. Its null is that the two runs of a pair are exchangeable; it is \
         exact up to {MOST_ENUMERATED} pairs, of more it draws {} flips. Pairs ahead: the share of pairs in which the first \
         side is ahead, ties one half, and p of the same test of these signs. A verdict on an average needs means and \
         signs to agree. No difference: within ±{margin} in every environment, by \
         two one-sided tests, whose interval covers 1 minus twice the level. All pairs count in the test, at least \
         {fewest_pairs} in all are needed, and environments with fewer are named. Values of a setting whose runs are those \
         of the reference evaluation by evaluation come to the same in the method: they are not tested and count for no \
         correction.",
        columns::percent(resampling.confidence),
        thousands(resampling.resamples as u64),
    )
}
