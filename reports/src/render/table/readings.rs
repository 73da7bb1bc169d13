//! The claims about baselines under every reading of the paper.

use polars::prelude::DataFrame;

use super::cells::{or_undefined, p_value, with_interval};
use super::{Table, column};
use crate::analysis::ledger::{Entry, FEWEST_PAIRS};
use crate::analysis::readings::{Claim, Family, Readings};
use crate::error::ReportError;
use crate::stats::Resampling;

/// A row of the data: a claim under a reading.
struct Judged<'a> {
    family: &'a Family,
    claim: &'a Claim,
    number: usize,
    entry: &'a Entry,
}

/// All of a family, claim by claim.
fn judged(family: &Family) -> impl Iterator<Item = Judged<'_>> {
    family.claims.iter().flat_map(move |claim| {
        claim.judged.iter().map(move |(number, entry)| Judged { family, claim, number: *number, entry })
    })
}

/// The verdicts as a data frame, unrounded; null where an effect is not defined.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn readings_frame(readings: &Readings) -> Result<DataFrame, ReportError> {
    let rows: Vec<Judged<'_>> = readings.families.iter().flat_map(judged).collect();
    let columns = vec![
        column("claim", &rows, |row| row.entry.id.as_str()),
        column("family", &rows, |row| Some(row.family.name.as_str()).filter(|name| !name.is_empty())),
        column("reading", &rows, |row| row.number as u64),
        column("settings", &rows, |row| row.family.reading(row.number)),
        column("verdict", &rows, |row| row.entry.verdict.as_str()),
        column("effect", &rows, |row| row.entry.effect.difference),
        column("ci_low", &rows, |row| row.entry.effect.interval.map(|ci| ci.0)),
        column("ci_high", &rows, |row| row.entry.effect.interval.map(|ci| ci.1)),
        column("confidence", &rows, |row| row.entry.confidence),
        column("p", &rows, |row| row.entry.effect.p),
        column("environments", &rows, |row| row.entry.effect.environments.len() as u64),
        column("environments_ahead", &rows, |row| row.entry.effect.ahead as u64),
        column("environments_behind", &rows, |row| row.entry.effect.behind as u64),
        column("pairs", &rows, |row| row.entry.effect.pairs as u64),
        column("runs_left_out", &rows, |row| row.entry.effect.left_out as u64),
        column("evidence", &rows, |row| row.entry.evidence.as_str()),
        column("conclusion", &rows, |row| row.claim.conclusion.as_str()),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 6] = ["Claim", "Reading", "Verdict", "Evidence", "p", "Effect"];

/// The verdicts as a table to read: after the rows of a claim one that says whether its verdict hangs on the reading.
pub fn readings_table(readings: &Readings, window: usize, resampling: Resampling) -> Table {
    let rows = readings.families.iter().flat_map(|family| {
        family.claims.iter().flat_map(move |claim| {
            let judged = claim.judged.iter().map(move |(number, entry)| row(family, *number, entry));
            judged.chain(std::iter::once(last(family, claim)))
        })
    });
    Table::new(caption(readings, window, resampling), 4, HEADER, rows)
}

/// A claim under one reading.
fn row(family: &Family, number: usize, entry: &Entry) -> [String; 6] {
    let effect = &entry.effect;
    [
        statement(family, entry),
        format!("{number}: {}", family.reading(number)),
        entry.verdict.as_str().to_owned(),
        entry.evidence.clone(),
        or_undefined(effect.p, p_value),
        or_undefined(effect.difference, |difference| with_interval(difference, effect.interval)),
    ]
}

/// What a claim comes to.
fn last(family: &Family, claim: &Claim) -> [String; 6] {
    let first = claim.judged.first().map(|(_, entry)| statement(family, entry));
    [
        first.unwrap_or_default(),
        "all together".to_owned(),
        if claim.hangs() { "hangs on it" } else { "the same" }.to_owned(),
        claim.conclusion.clone(),
        String::new(),
        String::new(),
    ]
}

/// The claim, `at Δ = 10` where TEACH's other settings are not the default ones.
fn statement(family: &Family, entry: &Entry) -> String {
    let at = family.at().map_or_else(String::new, |at| format!(", {at}"));
    format!("{}{at}", entry.statement)
}

/// `MazeA, MazeB; at Δ = 10: MazeA`: environments by family, those without any left out.
fn by_family(readings: &Readings, environments: impl Fn(&Family) -> &[String]) -> String {
    let part = |family: &Family| {
        let at = family.at().map_or_else(String::new, |at| format!("{at}: "));
        let names = environments(family).join(", ");
        (!names.is_empty()).then(|| format!("{at}{names}"))
    };
    readings.families.iter().filter_map(part).collect::<Vec<_>>().join("; ")
}

fn caption(readings: &Readings, window: usize, resampling: Resampling) -> String {
    let left_out = match by_family(readings, |family| &family.left_out) {
        names if names.is_empty() => names,
        names => format!(" Left out, for they lack some of these readings: {names}."),
    };
    format!(
        "The claims about baselines under every reading of the paper that TEACH was run with, from the environments that \
         have all of them: {}.{left_out} A reading is named by the settings that differ between readings; readings whose \
         runs are the same evaluation by evaluation are one. TEACH's other settings are the same for all readings of a \
         claim, which names those that are not the default ones. TEACH under each is set against the baseline's runs of \
         the same settings outside the curriculum, evaluation goals included, by the rule and the test of the ledger: \
         final success over the last {window} evaluations or area under the curve, finished runs of the same evaluations, \
         environments with at least {FEWEST_PAIRS} pairs. p: of the exact sign-flip test, uncorrected. Brackets: what the \
         test does not refuse, at {} % together for the readings of one claim (Bonferroni's correction: the level over the \
         number of readings). Readings with different verdicts need not differ from each other: one that is undecided may \
         only lack runs.",
        by_family(readings, |family| &family.environments),
        resampling.confidence * 100.0,
    )
}
