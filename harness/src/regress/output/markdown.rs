//! A comparison as the summary of a CI step.

use reports::render::table::{Align, Table};

use super::{Check, change, interval, score};
use crate::regress::compare::Test;

/// Markdown: the outcome, what fell, and all tests to unfold.
pub fn markdown(check: &Check<'_>) -> String {
    let comparison = check.comparison;
    let mut text = format!("### Regression gate\n\n**{}**\n\n", check.headline());
    for note in &check.notes {
        text += &format!("- {note}\n");
    }
    for failure in &comparison.failures {
        text += &format!("- `{}`: {}\n", failure.run, failure.reason.replace('\n', " "));
    }
    let failed: Vec<&Test> = comparison.failed().collect();
    if !failed.is_empty() {
        text += &format!("\n{}\n", table("What fell:", &failed));
    }
    let all: Vec<&Test> = comparison.tests.iter().collect();
    text += &format!("\n<details><summary>All {} tests</summary>\n\n", all.len());
    text += &table(&check.method(), &all);
    text + "\n</details>\n"
}

fn table(caption: &str, tests: &[&Test]) -> String {
    let text = [("Runs", Align::Text), ("Measure", Align::Text)];
    let numbers = ["Baseline", "Now", "Change", "95 % interval", "p", "p (Holm)"];
    let columns = text.into_iter().chain(numbers.map(|title| (title, Align::Number))).collect();
    let row = |test: &&Test| {
        vec![
            test.scope.to_string(),
            test.measure.title().to_owned(),
            score(test.measure, test.before),
            score(test.measure, test.now),
            change(test),
            interval(test),
            format!("{:.2e}", test.p),
            format!("{:.2e}", test.p_holm),
        ]
    };
    Table { caption: caption.to_owned(), columns, rows: tests.iter().map(row).collect() }.markdown()
}
