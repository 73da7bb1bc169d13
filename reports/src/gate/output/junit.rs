//! The result of a check in JUnit's XML: a test case per test and per run that broke down.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::{Check, change, score};
use crate::gate::compare::Test;
use crate::wording::counted;

/// The XML that CI systems take for test results.
pub fn junit(check: &Check<'_>) -> String {
    let result = check.result;
    let mut suite = TestSuite::new("goalbench regress");
    for test in &result.tests {
        let message = test.failed.then(|| message(test));
        suite.add_test_case(case(&test.scope.to_string(), test.metric.title(), message));
    }
    for failure in &result.failures {
        suite.add_test_case(case(&failure.run, "run", Some(failure.reason.clone())));
    }
    if check.exact {
        let differ = || format!("{} of {} are identical", result.identical, counted(result.shared, "run"));
        let message = (!result.is_identical()).then(differ);
        suite.add_test_case(case("all runs", "identical to the baseline", message));
    }
    let mut report = Report::unnamed();
    report.add_test_suite(suite);
    report.to_string().expect("names and messages are text")
}

/// A test case, failed if there is a message.
fn case(scope: &str, name: &str, failure: Option<String>) -> TestCase {
    let status = match failure {
        None => TestCaseStatus::success(),
        Some(message) => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(message);
            status
        }
    };
    let mut case = TestCase::new(name, status);
    case.set_classname(scope);
    case
}

fn message(test: &Test) -> String {
    format!(
        "{} before, {} now ({}), p = {:.2e} after Holm's correction",
        score(test.metric, test.before),
        score(test.metric, test.now),
        change(test),
        test.p_holm
    )
}
