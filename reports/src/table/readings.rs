//! The claims about baselines under every reading of the paper.

use polars::prelude::DataFrame;

use super::cells::{or_undefined, p_value, with_interval};
use super::{Table, column};
use crate::error::ReportError;
use crate::ledger::{Entry, FEWEST_PAIRS};
use crate::readings::{Claim, Readings};
use crate::stats::Resampling;

/// A row of the data: a claim under a reading.
type Judged<'a> = (&'a Claim, usize, &'a Entry);

/// The verdicts as a data frame, unrounded; null where an effect is not defined.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn readings_frame(readings: &Readings) -> Result<DataFrame, ReportError> {
    let rows: Vec<Judged<'_>> = readings
        .claims
        .iter()
        .flat_map(|claim| claim.judged.iter().map(move |(number, entry)| (claim, *number, entry)))
        .collect();
    let columns = vec![
        column("claim", &rows, |row| row.2.id.as_str()),
        column("reading", &rows, |row| row.1 as u64),
        column("settings", &rows, |row| readings.name(row.1)),
        column("verdict", &rows, |row| row.2.verdict.as_str()),
        column("effect", &rows, |row| row.2.effect.difference),
        column("ci_low", &rows, |row| row.2.effect.interval.map(|ci| ci.0)),
        column("ci_high", &rows, |row| row.2.effect.interval.map(|ci| ci.1)),
        column("confidence", &rows, |row| row.2.confidence),
        column("p", &rows, |row| row.2.effect.p),
        column("environments", &rows, |row| row.2.effect.environments.len() as u64),
        column("environments_ahead", &rows, |row| row.2.effect.ahead as u64),
        column("environments_behind", &rows, |row| row.2.effect.behind as u64),
        column("pairs", &rows, |row| row.2.effect.pairs as u64),
        column("runs_left_out", &rows, |row| row.2.effect.left_out as u64),
        column("evidence", &rows, |row| row.2.evidence.as_str()),
        column("conclusion", &rows, |row| row.0.conclusion.as_str()),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 6] = ["Claim", "Reading", "Verdict", "Evidence", "p", "Effect"];

/// The verdicts as a table to read: after the rows of a claim one that says whether its verdict hangs on the reading.
pub fn readings_table(readings: &Readings, window: usize, resampling: Resampling) -> Table {
    let row = |number: usize, entry: &Entry| {
        let effect = &entry.effect;
        [
            entry.statement.clone(),
            format!("{number}: {}", readings.name(number)),
            entry.verdict.as_str().to_owned(),
            entry.evidence.clone(),
            or_undefined(effect.p, p_value),
            or_undefined(effect.difference, |difference| with_interval(difference, effect.interval)),
        ]
    };
    let last = |claim: &Claim| {
        let statement = claim.judged.first().map(|(_, entry)| entry.statement.clone());
        [
            statement.unwrap_or_default(),
            "all together".to_owned(),
            if claim.hangs() { "hangs on it" } else { "the same" }.to_owned(),
            claim.conclusion.clone(),
            String::new(),
            String::new(),
        ]
    };
    let rows = readings.claims.iter().flat_map(|claim| {
        let judged = claim.judged.iter().map(|(number, entry)| row(*number, entry));
        judged.chain(std::iter::once(last(claim)))
    });
    Table::new(caption(readings, window, resampling), 4, HEADER, rows)
}

fn caption(readings: &Readings, window: usize, resampling: Resampling) -> String {
    let left_out = if readings.left_out.is_empty() {
        String::new()
    } else {
        format!(" Left out, for they lack some of these readings: {}.", readings.left_out.join(", "))
    };
    format!(
        "The claims about baselines under every reading of the paper that TEACH was run with, from the environments that \
         have all of them: {}.{left_out} A reading is named by the settings that differ between readings; readings whose \
         runs are the same evaluation by evaluation are one. TEACH under each is set against the baseline's runs of the \
         same settings outside the curriculum, evaluation goals included, by the rule and the test of the ledger: final \
         success over the last {window} evaluations or area under the curve, finished runs of the same evaluations, \
         environments with at least {FEWEST_PAIRS} pairs. p: of the exact sign-flip test, uncorrected. Brackets: what the \
         test does not refuse, at {} % together for the readings of one claim (Bonferroni's correction: the level over the \
         number of readings). Readings with different verdicts need not differ from each other: one that is undecided may \
         only lack runs.",
        readings.environments.join(", "),
        resampling.confidence * 100.0,
    )
}
