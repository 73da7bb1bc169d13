//! A comparison on a terminal.

use super::{Check, change, interval, score};

/// Lines of plain text: the outcome first, then what fell.
pub fn text(check: &Check<'_>) -> String {
    let mut text = format!("{}\n", check.headline());
    for note in &check.notes {
        text += &format!("note: {note}\n");
    }
    for failure in &check.comparison.failures {
        text += &format!("{}: {}\n", failure.run, failure.reason);
    }
    if check.exact && !check.comparison.differing.is_empty() {
        text += &format!("cells with runs that differ: {}\n", check.comparison.differing.join(", "));
    }
    if check.comparison.failed().next().is_some() {
        text += &format!(
            "\n{:<36} {:<20} {:>8} {:>8} {:>8} {:>18} {:>9} {:>9}\n",
            "what fell", "measure", "baseline", "now", "change", "95 % interval", "p", "p (Holm)"
        );
    }
    for test in check.comparison.failed() {
        text += &format!(
            "{:<36} {:<20} {:>8} {:>8} {:>8} {:>18} {:>9.2e} {:>9.2e}\n",
            test.scope.to_string(),
            test.measure.title(),
            score(test.measure, test.before),
            score(test.measure, test.now),
            change(test),
            interval(test),
            test.p,
            test.p_holm
        );
    }
    text + "\n" + &check.method() + "\n"
}
