//! Verdict as `junit.xml` for CI systems, in the flavour of nextest.

use super::summary::{FaultResult, Summary};
use super::verdict::RequirementResult;
use octant_requirements::Verdict;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

/// Writes the run as JUnit XML: one suite named after the scenario, one case for each requirement with
/// a property `verifies`, one for each fault (that it fired), and one for the run itself. JUnit has no
/// "inconclusive": it becomes an error of that type, because it must never count as passed.
///
/// # Errors
/// If the XML can't be written.
pub fn junit(summary: &Summary) -> Result<String, quick_junit::SerializeError> {
    junit_of(
        &summary.scenario,
        summary.seed,
        &summary.requirements,
        &summary.faults,
        (summary.verdict, &summary.reasons),
    )
}

/// Writes JUnit XML as [`junit`] does, from the parts of a summary that it needs, also for other runs.
///
/// # Errors
/// If the XML can't be written.
pub fn junit_of(
    name: &str,
    seed: u64,
    requirements: &[RequirementResult],
    faults: &[FaultResult],
    (verdict, reasons): (Verdict, &[String]),
) -> Result<String, quick_junit::SerializeError> {
    let mut suite = TestSuite::new(name);
    suite.add_property(("seed", seed.to_string().as_str()));
    suite.add_property(("octant", env!("CARGO_PKG_VERSION")));
    for result in requirements {
        let (value, limit) = result.figures();
        let sentence = format!("{} {} {limit}", result.measure, result.comparison.sign());
        let found = match (result.value, result.reason.as_ref()) {
            (Some(_), _) => format!("found {value}"),
            (None, Some(reason)) => reason.clone(),
            (None, None) => "nothing found".to_owned(),
        };
        let mut case =
            TestCase::new(format!("{}: {sentence}", result.id), status(result.verdict, &found));
        case.set_classname(name);
        case.add_property(("verifies", result.id.as_str()));
        suite.add_test_case(case);
    }
    for fault in faults {
        let (verdict, found) = match fault.fired {
            true => (Verdict::Pass, String::new()),
            false => (Verdict::Inconclusive, format!("fault {} never fired", fault.id)),
        };
        let case_name = format!("fault {} ({}) fired", fault.id, fault.kind);
        let mut case = TestCase::new(case_name, status(verdict, &found));
        case.set_classname(name);
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
    let mut run = TestCase::new("run", status(verdict, &reasons.join("; ")));
    run.set_classname(name);
    suite.add_test_case(run);
    let mut report = Report::new("octant");
    report.add_test_suite(suite);
    report.to_string()
}

/// Status of a verdict. JUnit has no "inconclusive": it becomes an error of that type.
pub fn status(verdict: Verdict, message: &str) -> TestCaseStatus {
    let kind = match verdict {
        Verdict::None => {
            let mut skipped = TestCaseStatus::skipped();
            skipped.set_message(message);
            return skipped;
        }
        Verdict::Pass => return TestCaseStatus::success(),
        Verdict::Fail => NonSuccessKind::Failure,
        Verdict::Inconclusive | Verdict::Error => NonSuccessKind::Error,
    };
    let mut status = TestCaseStatus::non_success(kind);
    status.set_type(verdict.name()).set_message(message);
    status
}
