//! Finds everything in a campaign that isn't a pass.

use super::combination::Combination;
use super::requirement;
use super::rows::{ReportRow, ReportRows, RowOutcome};
use crate::judge::status::CampaignStatus;
use crate::plan::Plan;
use octant_evidence::discrepancy::{Discrepancy, Subject};
use octant_verdict::Verdict;
use std::collections::BTreeMap;

/// Lists everything that isn't a pass. `notes` are other problems, as text.
pub(super) fn find(
    plan: &Plan,
    status: &CampaignStatus,
    combinations: &[Combination],
    rows: &ReportRows<'_>,
    notes: &[String],
) -> Vec<Discrepancy> {
    let mut all = Vec::new();
    if status.cases == 0 || status.requirements.is_empty() {
        let what = if status.cases == 0 { "there is no case" } else { "no requirement is checked" };
        let subject = Subject {
            kind: "nothing shown",
            verdict: Verdict::Inconclusive,
            requirement: None,
            of: what,
        };
        all.push(Discrepancy::whole(&subject, format!("{what}: nothing is shown")));
    }
    for (id, found) in &status.requirements {
        if found.verdict != Verdict::Pass {
            let subject = Subject {
                kind: "requirement",
                verdict: found.verdict,
                requirement: Some(id),
                of: "",
            };
            let how = match found.verdict {
                Verdict::Fail => "is not met",
                Verdict::Error => "could not be judged",
                _ => "is not shown",
            };
            let what = format!("{id} {how}: {}", found.reason);
            all.push(Discrepancy::whole(&subject, what));
        }
    }
    let ids = |wanted: &dyn Fn(&RowOutcome) -> bool| -> Vec<String> {
        let is = |row: &ReportRow<'_>| row.outcome.as_ref().is_some_and(wanted);
        rows.iter().filter(is).map(|row| row.case.id.to_string()).collect()
    };
    let differing = ids(&|outcome| outcome.differs);
    if !differing.is_empty() {
        let subject =
            Subject { kind: "two results", verdict: Verdict::Error, requirement: None, of: "" };
        let what = format!(
            "{} came to two results: the program or the computer is not deterministic",
            counted(differing.len())
        );
        all.push(Discrepancy::of_cases(&subject, what, differing));
    }
    for combination in combinations {
        all.extend(of_combination(plan, combination, rows));
    }
    for found in status.idle_in_words() {
        let subject = Subject {
            kind: "design",
            verdict: Verdict::Inconclusive,
            requirement: None,
            of: &found,
        };
        all.push(Discrepancy::whole(&subject, found.clone()));
    }
    let open = (0..rows.len()).filter(|place| !rows.has_run(*place)).count();
    if open > 0 {
        let subject =
            Subject { kind: "not run", verdict: Verdict::Inconclusive, requirement: None, of: "" };
        let have = if open == 1 { "has" } else { "have" };
        // The set of open cases changes from hour to hour: the trace names them.
        all.push(Discrepancy::whole(&subject, format!("{} {have} no result", counted(open))));
    }
    for note in notes {
        let subject = Subject {
            kind: "evidence",
            verdict: Verdict::Inconclusive,
            requirement: None,
            of: note,
        };
        all.push(Discrepancy::whole(&subject, note.clone()));
    }
    all
}

fn counted(cases: usize) -> String {
    format!("{cases} case{}", if cases == 1 { "" } else { "s" })
}

/// Lists the discrepancies of one combination, each with all of its cases.
fn of_combination(
    plan: &Plan,
    combination: &Combination,
    rows: &ReportRows<'_>,
) -> Vec<Discrepancy> {
    let name = combination.name();
    // Grouped by content, in the order of the names.
    let mut found: BTreeMap<(&'static str, Verdict, Option<String>, String), Vec<String>> =
        BTreeMap::new();
    for row in rows.at(combination.cases.iter().copied()) {
        let Some(outcome) = &row.outcome else { continue };
        for (kind, verdict, requirement, why) in of_case(plan, &row, outcome) {
            let cases = found.entry((kind, verdict, requirement, why)).or_default();
            cases.push(row.case.id.to_string());
        }
    }
    found
        .into_iter()
        .map(|((kind, verdict, requirement, why), cases)| {
            let count = counted(cases.len());
            let what = format!("{why} in {count} of {name}");
            let of = format!("{why}\n{name}");
            let requirement = requirement.as_deref();
            let subject = Subject { kind, verdict, requirement, of: &of };
            Discrepancy::of_cases(&subject, what, cases)
        })
        .collect()
}

type Found = (&'static str, Verdict, Option<String>, String);

/// Lists everything in one case that isn't a pass.
fn of_case(plan: &Plan, row: &ReportRow<'_>, outcome: &RowOutcome) -> Vec<Found> {
    if let Some(error) = &outcome.error {
        return vec![("error", Verdict::Error, None, format!("no summary ({error})"))];
    }
    let mut all: Vec<Found> = Vec::new();
    let planned = plan.scenarios.iter().find(|planned| planned.id == row.case.scenario);
    for id in planned.iter().flat_map(|planned| &planned.requirements) {
        let verdict = outcome.check(id);
        if verdict != Verdict::Pass {
            let word = match verdict {
                Verdict::Fail => "failed",
                _ => "came to nothing",
            };
            all.push(("check", verdict, Some(id.clone()), format!("{id} {word}")));
        }
    }
    if outcome.refused.is_some() {
        let what = "the calibration was refused".to_owned();
        all.push(("refused", Verdict::Fail, None, what));
    }
    for fault in &outcome.unfired {
        let what = format!("fault {fault} never fired");
        all.push(("fault", Verdict::Inconclusive, None, what));
    }
    if outcome.checks.is_empty() {
        let what = "no requirement was checked".to_owned();
        all.push(("nothing shown", Verdict::Inconclusive, None, what));
    }
    // A verdict that none of these explains.
    if all.iter().all(|found| found.1 < outcome.verdict) && outcome.verdict != Verdict::Pass {
        let reason = outcome.reasons.first().map_or("no reason given", String::as_str);
        all.push(("case", outcome.verdict, None, reason.to_owned()));
    }
    all
}

/// Returns the verdict of a case on a requirement, if the case checks it; the inner `None`: it
/// hasn't run.
pub fn checks_of(plan: &Plan, row: &ReportRow<'_>, id: &str) -> Option<Option<Verdict>> {
    requirement::checks(plan, &row.case.scenario, id)
        .then(|| row.outcome.as_ref().map(|outcome| outcome.check(id)))
}
