//! `junit.xml` of a campaign, in the form of nextest: a suite for each combination, with a test
//! case for each requirement that a case checks, and one for the case itself.

use super::contents::CampaignReport;
use super::discrepancy::checks_of;
use super::rows::ReportRow;
use octant_requirements::Verdict;
use octant_score::junit::status;
use quick_junit::{TestCase, TestSuite};

/// Renders the campaign as JUnit XML. Only a pass is a success; a case that hasn't run isn't.
///
/// # Errors
/// If the XML can't be written.
pub fn junit(report: &CampaignReport<'_>) -> Result<String, quick_junit::SerializeError> {
    let mut all = quick_junit::Report::new("octant campaign");
    let mut suite = TestSuite::new(report.plan.title.clone());
    suite.add_property(("plan", report.plan.id.as_str()));
    suite.add_property(("results_blake3", report.statistics.results_blake3.as_str()));
    suite.add_property(("octant", env!("CARGO_PKG_VERSION")));
    for requirement in &report.statistics.requirements {
        let mut case = TestCase::new(
            format!("{}: all cases together", requirement.id),
            status(requirement.verdict, &requirement.reason),
        );
        case.set_classname(report.plan.title.clone());
        case.add_property(("verifies", requirement.id.as_str()));
        suite.add_test_case(case);
    }
    let reasons = report.reasons().join("; ");
    let mut campaign = TestCase::new("campaign", status(report.statistics.verdict, &reasons));
    campaign.set_classname(report.plan.title.clone());
    suite.add_test_case(campaign);
    all.add_test_suite(suite);
    for combination in &report.combinations {
        let name = combination.name();
        let mut suite = TestSuite::new(name.clone());
        for row in combination.cases.iter().filter_map(|case| report.rows.get(*case)) {
            for mut case in of_case(report, row) {
                case.set_classname(name.clone());
                suite.add_test_case(case);
            }
        }
        all.add_test_suite(suite);
    }
    all.to_string()
}

fn of_case(report: &CampaignReport<'_>, row: &ReportRow<'_>) -> Vec<TestCase> {
    let id = &row.case.id;
    let mut all = Vec::new();
    for requirement in &report.statistics.requirements {
        let Some(verdict) = checks_of(report.plan, row, &requirement.id) else { continue };
        let check = (row.outcome.iter().flat_map(|outcome| &outcome.checks))
            .find(|check| check.id == requirement.id);
        let found = match (check, verdict) {
            (Some(check), _) => check.sentence(),
            (None, None) => "the case has not run".to_owned(),
            (None, Some(_)) => "it was not checked".to_owned(),
        };
        let verdict = verdict.unwrap_or(Verdict::Inconclusive);
        let mut case = TestCase::new(format!("{id}: {}", requirement.id), status(verdict, &found));
        case.add_property(("verifies", requirement.id.as_str()));
        all.push(case);
    }
    let (verdict, message) = match &row.outcome {
        None => (Verdict::Inconclusive, "the case has not run".to_owned()),
        Some(outcome) => (
            if outcome.differs { Verdict::Error } else { outcome.verdict },
            outcome.error.clone().unwrap_or_else(|| outcome.reasons.join("; ")),
        ),
    };
    let mut case = TestCase::new(format!("{id}: case"), status(verdict, &message));
    case.add_property(("seed", row.case.seed.to_string().as_str()));
    all.push(case);
    all
}
