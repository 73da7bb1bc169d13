//! Counts as Markdown, for the docs.

use reports::analysis::ledger::Verdict;
use reports::analysis::options::MARGIN;

use super::tally::{Tally, Verdicts};
use super::truth::{Design, TRUTHS, Truth};

/// Counts of every truth under every design, `[designs][truths]`.
pub(crate) type Counts = [Vec<Tally>];

/// What a table shows of a truth: which verdict is right, and a cell per design.
type Row<'a> = (&'a dyn Fn(Truth) -> Option<Verdict>, &'a dyn Fn(&Tally, Truth) -> String);

/// All tables.
pub(crate) fn markdown(designs: &[Design], counts: &Counts) -> String {
    let verdicts = |verdicts: Verdicts| {
        let share = |count| percent(count, verdicts.all());
        let Verdicts { confirmed, undecided, refuted } = verdicts;
        format!("{} / {} / {}", share(confirmed), share(undecided), share(refuted))
    };
    let above = |tally: &Tally, _| verdicts(tally.above);
    let above_false = |tally: &Tally, _| percent(tally.above_false, tally.experiments);
    let invariance = |tally: &Tally, _| verdicts(tally.invariance);
    let invariance_false = |tally: &Tally, truth| percent(tally.invariance_false(truth), tally.experiments);
    let found = |tally: &Tally, _| {
        if tally.different == 0 { "–".to_owned() } else { percent(tally.found, tally.different) }
    };
    let found_false = |tally: &Tally, _| percent(tally.found_false, tally.experiments);
    let is_above = |truth: Truth| truth.above(0);
    let is_invariant = |truth: Truth| truth.invariance(MARGIN);
    let tables: [(&str, Row<'_>); 6] = [
        (
            "\"The method ends above a baseline\": confirmed / undecided / refuted, in % of verdicts on the \
             baselines that it is above, or on all where it is above none",
            (&is_above, &above),
        ),
        ("The same: % of experiments with a false verdict on any baseline", (&is_above, &above_false)),
        (
            "\"The setting makes no difference\": confirmed / undecided / refuted, in % of experiments",
            (&is_invariant, &invariance),
        ),
        ("The same: % of experiments with a false verdict", (&is_invariant, &invariance_false)),
        (
            "Table of comparisons, p (Holm) ≤ 0.05: % of true differences in single environments that are found",
            (&is_above, &found),
        ),
        ("The same: % of experiments with any false one", (&is_above, &found_false)),
    ];
    tables.iter().map(|(caption, row)| format!("{caption}:\n\n{}\n", table(designs, counts, *row))).collect()
}

fn table(designs: &[Design], counts: &Counts, (right, cell): Row<'_>) -> String {
    let mut text = "| What is true | Right |".to_owned();
    text.extend(designs.iter().map(|design| format!(" {} |", design.title())));
    text += &format!("\n| --- | --- |{}\n", " --- |".repeat(designs.len()));
    for (index, truth) in TRUTHS.into_iter().enumerate() {
        let right = right(truth).map_or("none", Verdict::as_str);
        text += &format!("| {} | {right} |", truth.title());
        text.extend(counts.iter().map(|row| format!(" {} |", cell(&row[index], truth))));
        text.push('\n');
    }
    text
}

/// A share as a percentage with a digit after the point.
fn percent(count: u64, all: u64) -> String {
    format!("{:.1}", 100.0 * count as f64 / all as f64)
}
