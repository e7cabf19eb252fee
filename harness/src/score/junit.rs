//! `junit.xml`: the verdict for CI systems, in the flavour of nextest.

use super::summary::Summary;
use super::verdict::Verdict;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

/// The run as JUnit XML: one suite named for the scenario, one case for each requirement with a
/// property `verifies`, one for each fault (that it fired), and one for the run itself. JUnit doesn't know "inconclusive": it becomes
/// an error of that type, because it must never count as passed.
///
/// # Errors
/// If the XML can't be written.
pub fn junit(summary: &Summary) -> Result<String, quick_junit::SerializeError> {
    let mut suite = TestSuite::new(summary.scenario.as_str());
    suite.add_property(("seed", summary.seed.to_string().as_str()));
    suite.add_property(("octant", summary.octant.as_str()));
    for result in &summary.requirements {
        let (value, limit) = result.figures();
        let sentence = format!("{} {} {limit}", result.measure, result.comparison.sign());
        let found = match (result.value, result.reason.as_ref()) {
            (Some(_), _) => format!("found {value}"),
            (None, Some(reason)) => reason.clone(),
            (None, None) => "nothing found".to_owned(),
        };
        let mut case =
            TestCase::new(format!("{}: {sentence}", result.id), status(result.verdict, &found));
        case.set_classname(summary.scenario.as_str());
        case.add_property(("verifies", result.id.as_str()));
        suite.add_test_case(case);
    }
    for fault in &summary.faults {
        let (verdict, found) = match fault.fired {
            true => (Verdict::Pass, String::new()),
            false => (Verdict::Inconclusive, format!("fault {} never fired", fault.id)),
        };
        let name = format!("fault {} ({}) fired", fault.id, fault.kind);
        let mut case = TestCase::new(name, status(verdict, &found));
        case.set_classname(summary.scenario.as_str());
        for (name, value) in [
            ("firings", Some(u64::from(fault.firings))),
            ("first_sample", fault.first_sample),
            ("last_sample", fault.last_sample),
            ("samples_altered", Some(fault.samples_altered)),
        ] {
            if let Some(value) = value {
                case.add_property((name, value.to_string().as_str()));
            }
        }
        suite.add_test_case(case);
    }
    let mut run = TestCase::new("run", status(summary.verdict, &summary.reasons.join("; ")));
    run.set_classname(summary.scenario.as_str());
    suite.add_test_case(run);
    let mut report = Report::new("octant");
    report.add_test_suite(suite);
    report.to_string()
}

fn status(verdict: Verdict, message: &str) -> TestCaseStatus {
    let kind = match verdict {
        Verdict::Pass => return TestCaseStatus::success(),
        Verdict::Fail => NonSuccessKind::Failure,
        Verdict::Inconclusive | Verdict::Error => NonSuccessKind::Error,
    };
    let mut status = TestCaseStatus::non_success(kind);
    status.set_type(verdict.name()).set_message(message);
    status
}
