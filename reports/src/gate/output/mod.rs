//! The result of a check for people and for CI systems.

mod figure;
mod junit;
mod markdown;
mod text;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::cells::Cell;
use super::compare::{CheckResult, Test};
use super::error::GateError;
use super::metric::Metric;
use crate::analysis::catalogue::Catalogue;
use crate::render::figure as draw;
use crate::store::StoreError;
use crate::wording::{counted, is_or_are};

pub use figure::figure;
pub use junit::junit;
pub use markdown::markdown;
pub use text::text;

/// Names of the files of [`write()`].
pub const JSON: &str = "regression.json";
/// JUnit's XML, which most CI systems show.
pub const JUNIT: &str = "junit.xml";
/// The summary of a CI step.
pub const SUMMARY: &str = "summary.md";
/// Curves old and new, as vectors.
pub const SVG: &str = "regression.svg";
/// The same in pixels.
pub const PNG: &str = "regression.png";

/// What a check compared, for every form of output.
#[derive(Clone, Debug)]
pub struct Check<'a> {
    /// What came out.
    pub result: &'a CheckResult,
    /// Cells of the baseline.
    pub before: &'a [Cell],
    /// The same cells now.
    pub now: &'a [Cell],
    /// Whether any differing curve fails the check.
    pub exact: bool,
    /// Further lines worth saying: other versions, cells left out.
    pub notes: Vec<String>,
    /// Titles and order of curricula in figures.
    pub catalogue: &'a Catalogue,
}

impl Check<'_> {
    /// Whether the check passed.
    pub fn passed(&self) -> bool {
        self.result.passed(self.exact)
    }

    /// The outcome in one sentence.
    pub fn headline(&self) -> String {
        let c = self.result;
        let failed = c.failed().count();
        let runs = self.now.iter().map(|cell| cell.curves.len()).sum::<usize>();
        let tests = || counted(c.tests.len(), "test");
        if !c.failures.is_empty() {
            return format!(
                "FAILED: {} of {} broke down, {failed} of {} failed",
                c.failures.len(),
                counted(runs, "run"),
                tests()
            );
        }
        if c.is_identical() {
            return format!(
                "passed: all {} {} identical to the baseline's, byte for byte",
                counted(runs, "run"),
                is_or_are(runs)
            );
        }
        let curves = format!(
            "{} of {} that the baseline has too are identical",
            c.identical,
            counted(c.shared, "run")
        );
        if failed > 0 {
            return format!("FAILED: {failed} of {} failed; {curves}", tests());
        }
        if self.exact {
            return format!("FAILED: {curves}, and --exact asks for all of them");
        }
        format!("passed: none of {} failed; {curves}", tests())
    }

    /// How was compared.
    pub fn method(&self) -> String {
        let CheckResult { settings: s, seeds_before, seeds_now, tests, .. } = self.result;
        format!(
            "Seeds: {} now, {} in the baseline. A group of runs fell where its mean over seeds is lower by {} or more and \
             p <= {}: exact one-sided permutation test over seeds, Holm's correction for {}. Final success: mean \
             of the last {}. Effective goals, exp(entropy) of the teacher's choice, and what it picked: \
             two-sided, a change of {} % or more.",
            seeds_now.len(),
            seeds_before.len(),
            s.smallest_effect,
            s.alpha,
            counted(tests.len(), "test"),
            counted(s.window, "evaluation"),
            s.smallest_effect * 100.0
        )
    }
}

/// The whole result as JSON.
pub fn json(check: &Check<'_>) -> Value {
    let mut value = serde_json::to_value(check.result).expect("a result is plain data");
    value["passed"] = check.passed().into();
    value["exact"] = check.exact.into();
    value["headline"] = check.headline().into();
    value["notes"] = json!(check.notes);
    value
}

/// Writes every form of output into `folder` and names the files.
///
/// # Errors
/// [`GateError`] if a file cannot be written or the figure not be drawn.
pub fn write(check: &Check<'_>, folder: &Path) -> Result<Vec<PathBuf>, GateError> {
    fs::create_dir_all(folder).map_err(StoreError::io(folder, "create this folder"))?;
    guard::fresh::sweep(folder);
    let svg = figure(check)?;
    let files = [
        (JSON, format!("{:#}\n", json(check)).into_bytes()),
        (JUNIT, junit(check).into_bytes()),
        (SUMMARY, markdown(check).into_bytes()),
        (PNG, draw::png("regression", &svg)?),
        (SVG, draw::outlined("regression", &svg)?.into_bytes()),
    ];
    let write = |(name, bytes): (&str, Vec<u8>)| {
        let path = folder.join(name);
        guard::fresh::write(&path, &bytes).map_err(StoreError::io(&path, "write this file"))?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}

/// A score as tables show it.
fn score(metric: Metric, value: f64) -> String {
    if metric.is_success() { format!("{value:.3}") } else { format!("{value:.1}") }
}

/// A change as tables show it.
fn change(test: &Test) -> String {
    if test.metric.is_success() {
        format!("{:+.3}", test.change)
    } else {
        format!("{:+.0} %", test.change * 100.0)
    }
}

/// The bootstrap interval of the difference as tables show it.
fn interval(test: &Test) -> String {
    test.interval.map_or("-".to_owned(), |(low, high)| {
        if test.metric.is_success() {
            format!("[{low:+.3}, {high:+.3}]")
        } else {
            format!("[{low:+.1}, {high:+.1}]")
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::MethodInfo;
    use crate::gate::cells::Failure;
    use crate::gate::compare::{Settings, compare};
    use crate::gate::testing::cell;

    /// A check in which all seeds of one of two curricula fell, and one run broke down, in words of trouble.
    fn with_check(see: impl FnOnce(&Check<'_>)) {
        let before = [cell("A", "x", &[8, 9, 10, 8, 9, 10]), cell("A", "y", &[5, 5, 5, 5, 5, 5])];
        let now = [cell("A", "x", &[3, 2, 4]), cell("A", "y", &[5, 5, 5])];
        let failure = Failure { run: "A/x/default/seed-1".into(), reason: "<not & finite>".into() };
        let settings = Settings { alpha: 0.1, smallest_effect: 0.1, window: 1 };
        let result = compare(&before, &now, vec![failure], settings);
        let catalogue = Catalogue::of([MethodInfo::new("y", "Why", None)]);
        let notes = vec!["left out: B".to_owned()];
        see(&Check {
            result: &result,
            before: &before,
            now: &now,
            exact: false,
            notes,
            catalogue: &catalogue,
        });
    }

    #[test]
    fn junit_counts_what_fell_and_escapes_what_runs_say() {
        with_check(|check| {
            let xml = junit(check);
            let failed = check.result.failed().count() + 1;
            assert!(
                xml.contains(&format!("tests=\"7\" skipped=\"0\" errors=\"0\" failures=\"{failed}\"")),
                "{xml}"
            );
            assert!(xml.contains("<failure message=\"&lt;not &amp; finite&gt;\"/>"), "{xml}");
            assert!(xml.contains("<testcase name=\"final success\" classname=\"A/y/default\"/>"), "{xml}");
        });
    }

    #[test]
    fn every_form_says_what_fell() {
        with_check(|check| {
            let headline = format!(
                "FAILED: 1 of 6 runs broke down, {} of 6 tests failed",
                check.result.failed().count()
            );
            for form in [text(check), markdown(check), json(check).to_string()] {
                assert!(form.contains(&headline) && form.contains("left out: B"), "{form}");
            }
            let json = json(check);
            assert_eq!(json["tests"][0]["measure"], "area");
            assert_eq!(
                (&json["passed"], &json["failures"][0]["run"]),
                (&false.into(), &"A/x/default/seed-1".into())
            );
        });
    }

    #[test]
    fn known_curricula_come_first_in_the_figure() {
        with_check(|check| {
            let svg = figure(check).expect("drawn");
            let place = |title: &str| svg.find(title).unwrap_or_else(|| panic!("{title} in {svg}"));
            assert!(place("A, Why") < place("A, x"));
        });
    }
}
