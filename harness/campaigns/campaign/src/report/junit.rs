//! `junit.xml` of a campaign: a suite for each combination, with a test case for each requirement that
//! a case checks, and one for the case itself.

use super::combination::Combination;
use super::contents::CampaignReport;
use super::discrepancy::checks_of;
use super::rows::ReportRow;
use octant_score::junit::{JunitCase, JunitCases, JunitSuite, JunitTimes, write_document};
use octant_verdict::Verdict;
use std::io;

/// Cases of a suite: few of the whole campaign, or those of a combination, which are read when they are
/// written.
enum SuiteCases<'a> {
    Listed(Vec<JunitCase>),
    Of { report: &'a CampaignReport<'a>, combination: &'a Combination, name: String },
}

impl JunitCases for SuiteCases<'_> {
    fn each(&self, put: &mut dyn FnMut(&JunitCase) -> io::Result<()>) -> io::Result<()> {
        match self {
            Self::Listed(cases) => cases.each(put),
            Self::Of { report, combination, name } => {
                let mut rows = report.rows.at(combination.cases.iter().copied());
                rows.try_for_each(|row| of_case(report, &row, name).iter().try_for_each(&mut *put))
            }
        }
    }
}

/// Writes the campaign as JUnit XML. Only a pass is a success; a case that hasn't run isn't.
///
/// # Errors
/// If the XML can't be written.
pub fn junit(report: &CampaignReport<'_>, to: impl io::Write) -> io::Result<()> {
    let class = &report.plan.title;
    let [first, last] = report.run_between;
    let times = first.zip(last).map(|(started, ended)| JunitTimes { started, ended });
    let mut cases = Vec::new();
    for requirement in &report.statistics.requirements {
        cases.push(JunitCase {
            name: format!("{}: all cases together", requirement.id),
            class: class.clone(),
            properties: vec![("verifies", requirement.id.clone())],
            times: None,
            verdict: requirement.verdict,
            message: requirement.reason.clone(),
        });
    }
    cases.push(JunitCase {
        name: "campaign".to_owned(),
        class: class.clone(),
        properties: Vec::new(),
        times,
        verdict: report.statistics.verdict,
        message: report.reasons().join("; "),
    });
    let properties = vec![
        ("plan", report.plan.id.clone()),
        ("results_blake3", report.statistics.results_blake3.clone()),
        ("octant", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    let cases = SuiteCases::Listed(cases);
    let mut suites = vec![JunitSuite { name: class.clone(), properties, times, cases }];
    for combination in &report.combinations {
        let name = combination.name();
        let cases = SuiteCases::Of { report, combination, name: name.clone() };
        suites.push(JunitSuite { name, properties: Vec::new(), times: None, cases });
    }
    write_document("octant campaign", &suites, to)
}

fn of_case(report: &CampaignReport<'_>, row: &ReportRow<'_>, class: &str) -> Vec<JunitCase> {
    // The id of a case is another one after any change of its scenario.
    let case = format!("replicate {}", row.case.replicate);
    let id = row.case.id.to_string();
    let mut all = Vec::new();
    for requirement in &report.statistics.requirements {
        let Some(verdict) = checks_of(report.plan, row, &requirement.id) else { continue };
        let check = (row.outcome.iter().flat_map(|outcome| &outcome.checks))
            .find(|check| check.id == requirement.id);
        let found = match (check, verdict) {
            // Nothing is said of a pass, of which there are most.
            (Some(_), Some(Verdict::Pass)) => String::new(),
            (Some(check), _) => check.sentence(),
            (None, None) => "the case has not run".to_owned(),
            (None, Some(_)) => "it was not checked".to_owned(),
        };
        all.push(JunitCase {
            name: format!("{case}: {}", requirement.id),
            class: class.to_owned(),
            properties: vec![("verifies", requirement.id.clone()), ("case", id.clone())],
            times: None,
            verdict: verdict.unwrap_or(Verdict::Inconclusive),
            message: found,
        });
    }
    let (verdict, message) = match &row.outcome {
        None => (Verdict::Inconclusive, "the case has not run".to_owned()),
        Some(outcome) => (
            if outcome.differs { Verdict::Error } else { outcome.verdict },
            match outcome.verdict {
                Verdict::Pass if !outcome.differs => String::new(),
                _ => outcome.error.clone().unwrap_or_else(|| outcome.reasons.join("; ")),
            },
        ),
    };
    all.push(JunitCase {
        name: format!("{case}: case"),
        class: class.to_owned(),
        properties: vec![("case", id), ("seed", row.case.seed.to_string())],
        times: None,
        verdict,
        message,
    });
    all
}
