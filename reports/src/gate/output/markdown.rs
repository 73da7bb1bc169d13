//! The result of a check as the summary of a CI step.

use super::{Check, change, interval, score};
use crate::gate::compare::Test;
use crate::render::table::{Align, Table};
use crate::wording::counted;

/// Markdown: the outcome, what fell, and all tests to unfold.
pub fn markdown(check: &Check<'_>) -> String {
    let result = check.result;
    let mut text = format!("### Regression gate\n\n**{}**\n\n", check.headline());
    for note in &check.notes {
        text += &format!("- {note}\n");
    }
    for failure in &result.failures {
        text += &format!("- `{}`: {}\n", failure.run, failure.reason.replace('\n', " "));
    }
    let failed: Vec<&Test> = result.failed().collect();
    if !failed.is_empty() {
        text += &format!("\n{}\n", table("What fell:", &failed));
    }
    let all: Vec<&Test> = result.tests.iter().collect();
    text += &format!("\n<details><summary>{} in all</summary>\n\n", counted(all.len(), "test"));
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
            test.metric.title().to_owned(),
            score(test.metric, test.before),
            score(test.metric, test.now),
            change(test),
            interval(test),
            format!("{:.2e}", test.p),
            format!("{:.2e}", test.p_holm),
        ]
    };
    Table { caption: caption.to_owned(), columns, rows: tests.iter().map(row).collect() }.markdown()
}
