//! A comparison in JUnit's XML: a test case per test and per run that broke down.

use reports::render::table::html_escape;

use super::{Check, change, score};
use crate::regress::compare::Test;

/// The XML that CI systems take for test results.
pub fn junit(check: &Check<'_>) -> String {
    let comparison = check.comparison;
    let mut cases: Vec<(String, &str, Option<String>)> = Vec::new();
    for test in &comparison.tests {
        let message = test.failed.then(|| message(test));
        cases.push((test.scope.to_string(), test.measure.title(), message));
    }
    for failure in &comparison.failures {
        cases.push((failure.run.clone(), "run", Some(failure.reason.clone())));
    }
    let differing = (check.exact && !comparison.is_identical())
        .then(|| format!("{} of {} runs are identical", comparison.identical, comparison.shared));
    if check.exact {
        cases.push(("all runs".to_owned(), "identical to the baseline", differing));
    }
    let failures = cases.iter().filter(|(_, _, message)| message.is_some()).count();
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites tests=\"{0}\" failures=\"{failures}\">\n  \
         <testsuite name=\"goalbench regress\" tests=\"{0}\" failures=\"{failures}\">\n",
        cases.len()
    );
    for (scope, name, message) in &cases {
        let case =
            format!("    <testcase classname=\"{}\" name=\"{}\"", html_escape(scope), html_escape(name));
        xml += &match message {
            None => format!("{case}/>\n"),
            Some(message) => {
                format!("{case}>\n      <failure message=\"{}\"/>\n    </testcase>\n", html_escape(message))
            }
        };
    }
    xml + "  </testsuite>\n</testsuites>\n"
}

fn message(test: &Test) -> String {
    format!(
        "{} before, {} now ({}), p = {:.2e} after Holm's correction",
        score(test.measure, test.before),
        score(test.measure, test.now),
        change(test),
        test.p_holm
    )
}
