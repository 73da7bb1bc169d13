//! What keeps runs from being compared.

use std::path::{Path, PathBuf};

use crate::ReportError;
use crate::schema::RunKey;
use crate::store::StoreError;
use crate::wording::counted;

/// Errors of the gate. What failed below is an error's source and not part of its text.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GateError {
    /// A file cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] ReportError),
    /// A run is still to be carried out.
    #[error("{run}: has not ended")]
    NotEnded {
        /// Which run.
        run: RunKey,
    },
    /// A run was evaluated at other training steps than the other seeds of its cell.
    #[error("{run}: evaluated at steps {steps:?}, other seeds at {others:?}")]
    Steps {
        /// Which run.
        run: Box<RunKey>,
        /// Its steps, `[evaluations]`.
        steps: Vec<u64>,
        /// Those of the seeds before it.
        others: Vec<u64>,
    },
    /// A cell without a curve.
    #[error("{cell}: no seed came to its end with two evaluations or more")]
    NoCurve {
        /// Which cell.
        cell: String,
    },
    /// A file that is no JSON, or not that of a baseline.
    #[error("{path}: is no baseline, which `goalbench regress record` writes as JSON")]
    NoBaseline {
        /// The file.
        path: PathBuf,
        /// The first thing wrong with it.
        source: serde_json::Error,
    },
    /// A baseline of another schema, or inconsistent in itself.
    #[error("{path}: {}{reason}{}", prefix(cell), renewal(None, path))]
    Unfit {
        /// The file.
        path: PathBuf,
        /// The cell that it is about, if it is about one.
        cell: Option<String>,
        /// What is wrong.
        reason: String,
    },
    /// A baseline whose protocol resolves to another config than when it was recorded.
    #[error(
        "{path}: was recorded with another config than its protocol has now, so that curves cannot be compared:\n  \
         {}\nIf that is meant{}",
        shortened(differences),
        renewal(Some(source_options), path)
    )]
    OtherConfig {
        /// The file.
        path: PathBuf,
        /// Every field that differs, with its cell.
        differences: Vec<String>,
        /// The options that name the protocol.
        source_options: String,
    },
    /// Seeds with which no test can fail: that gate would be no gate.
    #[error(
        "{now} now against {before} in the baseline: no fall can be significant, since the lowest p-value is 1 in \
         {splits}, corrected for {} {:.2}, above alpha = {alpha}; take more seeds, or fewer cells",
        counted(*tests, "test"),
        // As the correction has it: no p-value exceeds 1.
        (*tests as f64 / splits).min(1.0)
    )]
    TooFewSeeds {
        /// Seeds of the check.
        now: usize,
        /// Seeds of the baseline.
        before: usize,
        /// Tests of the check.
        tests: usize,
        /// Ways to split the seeds.
        splits: f64,
        /// See [`Settings::alpha`](crate::gate::compare::Settings::alpha).
        alpha: f64,
    },
    /// More seeds than an exact test can deal with.
    #[error(
        "{now} now and {before} in the baseline can be split in {splits:.0e} ways, too many for an exact test; take \
         fewer of them"
    )]
    TooManySeeds {
        /// Seeds of the check.
        now: usize,
        /// Seeds of the baseline.
        before: usize,
        /// Ways to split the seeds.
        splits: f64,
    },
    /// Simulated checks that cannot be drawn.
    #[error(
        "{draws} draws of {now} and {before} other seeds; the baseline has {recorded}, at least one draw is needed"
    )]
    Draws {
        /// Simulated checks.
        draws: u64,
        /// Seeds of each.
        now: usize,
        /// Seeds that it is compared with.
        before: usize,
        /// Seeds of the baseline.
        recorded: usize,
    },
}

/// How to make a new baseline at `path`.
fn renewal(source: Option<&str>, path: &Path) -> String {
    let source = source.unwrap_or("--protocol PROTOCOL");
    format!("; renew it with `goalbench regress record {source} --out {}`", path.display())
}

fn prefix(cell: &Option<String>) -> String {
    cell.as_ref().map_or(String::new(), |cell| format!("{cell}: "))
}

/// Differences shown before the rest is counted.
const SHOWN: usize = 12;

fn shortened(lines: &[String]) -> String {
    let mut shown: Vec<String> = lines.iter().take(SHOWN).cloned().collect();
    if lines.len() > SHOWN {
        shown.push(format!("and {} more", lines.len() - SHOWN));
    }
    shown.join("\n  ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_p_value_exceeds_one_and_one_test_is_one() {
        let told =
            |tests| GateError::TooFewSeeds { now: 1, before: 2, tests, splits: 3.0, alpha: 0.05 }.to_string();
        assert!(
            told(22).contains("the lowest p-value is 1 in 3, corrected for 22 tests 1.00, above"),
            "{}",
            told(22)
        );
        assert!(told(1).contains("corrected for 1 test 0.33, above"), "{}", told(1));
    }
}
