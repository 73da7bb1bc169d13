//! How a sweep came out, in words.

use std::path::Path;

use reports::schema::Outcome;
use reports::wording::{counted, is_or_are};

use crate::cli::{complain, print};
use crate::console::word;
use crate::sweep::{Ending, Endings, ExitCode};

/// Says how the sweep came out and gives the exit code. With `json` a good end is left out: the events have
/// told it.
pub(super) fn summarise(endings: &Endings, results: &Path, json: bool) -> ExitCode {
    problems(endings, results);
    let code = endings.exit_code();
    if code == ExitCode::Success && !json {
        let (runs, place) = (counted(endings.total(), "run"), word(results));
        print(&format!("{runs} finished; records in {place}; next: goalbench report {place}\n"));
    }
    code
}

/// Says what went wrong, or is not done.
pub(super) fn problems(endings: &Endings, results: &Path) {
    for (run, ending) in endings.iter() {
        match ending {
            Ending::Ended(Outcome::Failed { step, reason }) => {
                complain(&format!("goalbench: {run}: failed at step {step}: {reason}"));
            }
            Ending::Crashed { reason } => complain(&format!("goalbench: {run}: crashed: {reason}")),
            Ending::Ended(Outcome::Finished { .. }) | Ending::Stopped | Ending::Taken => {}
        }
    }
    let (place, total) = (word(results), endings.total());
    let of_runs = |count: usize, what: &str| {
        if count > 0 {
            complain(&format!("goalbench: {count} of {} {what}", counted(total, "run")));
        }
    };
    of_runs(
        endings.failed(),
        &format!(
            "failed; the records of the others are in {place}; crashed ones go on with the same command, failed ones \
             with --retry-failed"
        ),
    );
    of_runs(endings.stopped(), "stopped; the same command goes on with them");
    of_runs(
        endings.taken(),
        &format!(
            "{} being carried out by another process; see goalbench status {place}",
            is_or_are(endings.taken())
        ),
    );
}
