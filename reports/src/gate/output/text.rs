//! The result of a check on a terminal.

use super::{Check, change, interval, score};

/// Lines of plain text: the outcome first, then what fell.
pub fn text(check: &Check<'_>) -> String {
    let mut text = format!("{}\n", check.headline());
    for note in &check.notes {
        text += &format!("note: {note}\n");
    }
    for failure in &check.result.failures {
        text += &format!("{}: {}\n", failure.run, failure.reason);
    }
    if check.exact && !check.result.differing.is_empty() {
        text += &format!("cells with runs that differ: {}\n", check.result.differing.join(", "));
    }
    if check.result.failed().next().is_some() {
        text += &format!(
            "\n{:<36} {:<20} {:>8} {:>8} {:>8} {:>18} {:>9} {:>9}\n",
            "what fell", "measure", "baseline", "now", "change", "95 % interval", "p", "p (Holm)"
        );
    }
    for test in check.result.failed() {
        text += &format!(
            "{:<36} {:<20} {:>8} {:>8} {:>8} {:>18} {:>9.2e} {:>9.2e}\n",
            test.scope.to_string(),
            test.metric.title(),
            score(test.metric, test.before),
            score(test.metric, test.now),
            change(test),
            interval(test),
            test.p,
            test.p_holm
        );
    }
    text + "\n" + &check.method() + "\n"
}
