//! Verdict as `junit.xml` for CI systems.

mod xml;

pub use xml::{JunitCase, JunitCases, JunitSuite, JunitTimes, document, write_document};

use super::summary::{FaultResult, Summary};
use super::verdict::RequirementResult;
use octant_verdict::Verdict;
use std::io;

/// Writes the run as JUnit XML: one suite named after the scenario, one case for each requirement, named by its id, with
/// properties `verifies` and `required`, one for each fault (that it fired), and one for the run itself, which has the
/// time of the run.
///
/// # Errors
/// If the XML can't be written.
pub fn junit(summary: &Summary, times: Option<JunitTimes>) -> io::Result<String> {
    junit_of(
        &summary.scenario,
        summary.seed,
        &summary.requirements,
        &summary.faults,
        (summary.verdict, &summary.reasons),
        times,
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
    times: Option<JunitTimes>,
) -> io::Result<String> {
    let mut cases: Vec<_> = requirements.iter().map(|result| checked(name, result)).collect();
    cases.extend(faults.iter().map(|fault| fired(name, fault)));
    cases.push(JunitCase {
        name: "run".to_owned(),
        class: name.to_owned(),
        properties: Vec::new(),
        times,
        verdict,
        message: reasons.join("; "),
    });
    let properties =
        vec![("seed", seed.to_string()), ("octant", env!("CARGO_PKG_VERSION").to_owned())];
    document("octant", &[JunitSuite { name: name.to_owned(), properties, times, cases }])
}

fn checked(class: &str, result: &RequirementResult) -> JunitCase {
    let (value, limit) = result.figures();
    let sentence = format!("{} {} {limit}", result.measure, result.comparison.sign());
    JunitCase {
        // A name that stays when a limit is changed, so that a CI system has one history of it.
        name: result.id.clone(),
        class: class.to_owned(),
        properties: vec![("verifies", result.id.clone()), ("required", sentence.clone())],
        times: None,
        verdict: result.verdict,
        message: match (result.value, result.reason.as_ref()) {
            (Some(_), _) => format!("found {value}, required {sentence}"),
            (None, Some(reason)) => reason.clone(),
            (None, None) => "nothing found".to_owned(),
        },
    }
}

fn fired(class: &str, fault: &FaultResult) -> JunitCase {
    let (verdict, message) = match fault.fired {
        true => (Verdict::Pass, String::new()),
        false => (Verdict::Inconclusive, format!("fault {} never fired", fault.id)),
    };
    let figures = [
        ("firings", Some(u64::from(fault.firings))),
        ("first_sample", fault.first_sample),
        ("last_sample", fault.last_sample),
        ("samples_altered", Some(fault.samples_altered)),
    ];
    let properties = figures.into_iter().filter_map(|(key, n)| Some((key, n?.to_string())));
    JunitCase {
        name: format!("fault {} ({}) fired", fault.id, fault.kind),
        class: class.to_owned(),
        properties: properties.collect(),
        times: None,
        verdict,
        message,
    }
}
