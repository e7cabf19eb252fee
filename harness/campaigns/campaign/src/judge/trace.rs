//! Traces the requirements of a campaign to its cases and their results, and back.

use super::independence;
use super::status::CampaignStatus;
use crate::execute::case::ResultError;
use crate::plan::requirements;
use crate::plan::{Case, Plan, PlanError};
use crate::store::CampaignResults;
use crate::store::stream_key::StreamKey;
use octant_scenario::campaign::Campaign;
use octant_verdict::requirement::{Check, Limit, Requirement, Requirements, Verification};
use octant_verdict::trace::{CampaignTrace, GrowingTrace, TracedCase, TracedResult as Traced};
use octant_verdict::{Comparison, Verdict};
use std::path::{Path, PathBuf};

/// Reads the requirements of the campaign of a plan; empty if it names no file of them.
///
/// # Errors
/// If the campaign or its file can't be read, or the file was changed after the campaign was
/// planned.
pub fn requirements_of(plan: &Plan) -> Result<Requirements, PlanError> {
    match (requirements_in_place(plan), &plan.copies) {
        (Err(_), Some(copies)) => planned_ones(plan, copies.join("requirements.toml")),
        (found, _) => found,
    }
}

/// Reads the requirements of the campaign of a plan where they were planned.
fn requirements_in_place(plan: &Plan) -> Result<Requirements, PlanError> {
    let path = match &plan.bundled {
        Some(bundled) => bundled.requirements.as_ref().map(|planned| planned.file.clone()),
        None => Campaign::load(&plan.campaign)?.requirements,
    };
    let Some(path) = path else {
        if !has_file(plan) {
            return Ok(Requirements { title: plan.title.clone(), ..Requirements::default() });
        }
        let reason = "it names no file of requirements, and was planned with one".to_owned();
        return Err(PlanError::Contradiction { campaign: plan.campaign.clone(), reason });
    };
    planned_ones(plan, path)
}

/// Reads requirements that have to be those of a plan.
fn planned_ones(plan: &Plan, path: PathBuf) -> Result<Requirements, PlanError> {
    let requirements = requirements::load(&path)?;
    let is_planned = requirements::planned(&requirements) == plan.requirements
        && requirements.accounts == plan.accounts;
    if !is_planned {
        return Err(PlanError::Form {
            path,
            reason: "it was changed after the campaign was planned".to_owned(),
        });
    }
    Ok(requirements)
}

/// Returns whether the campaign of a plan has a file of requirements.
pub(crate) fn has_file(plan: &Plan) -> bool {
    !(plan.requirements.is_empty() && plan.not_by_test.is_empty() && plan.accounts.is_empty())
}

/// Adds to the requirements of a file those that scenarios have of their own, which are checked as
/// well.
#[must_use]
pub fn with_those_of_scenarios(plan: &Plan, of_file: &Requirements) -> Requirements {
    let mut all = of_file.clone();
    for planned in &plan.scenarios {
        // For a missing scenario only the ids are known.
        let case = plan.cases.iter().find(|case| case.scenario == planned.id);
        let scenario = case.and_then(|case| planned.scenario(case).ok());
        for id in &planned.requirements {
            if all.get(id).is_some() {
                continue;
            }
            let own = scenario.as_ref();
            let own = own.and_then(|s| s.requirements.iter().find(|own| own.check.id == *id));
            let text = own.map_or("", |own| own.text.as_str());
            let check = Check {
                measure: own.map_or_else(String::new, |own| own.check.measure.clone()),
                comparison: own.map_or(Comparison::AtMost, |own| own.check.comparison),
                limit: Limit::Number(own.map_or(f64::NAN, |own| own.check.limit)),
                secant_latitude: own.is_some_and(|own| own.check.secant_latitude),
                ensemble: None,
            };
            let mut requirement = Requirement::new(id, text, Verification::Test(check));
            requirement.section = vec![format!("Scenario {}", planned.id)];
            all.requirements.push(requirement);
        }
    }
    all
}

/// Traces a campaign by the results in its folder: all that its cases check, from the file of
/// requirements or from the scenarios themselves. Cases of the plan before `end` count, as in
/// [`status::of`](super::status::of): a rule may have stopped the campaign there.
///
/// # Errors
/// If an existing result can't be read.
pub fn trace(
    plan: &Plan,
    requirements: &Requirements,
    folder: &Path,
    end: usize,
) -> Result<CampaignTrace, ResultError> {
    trace_by(plan, requirements, &CampaignResults::open(folder)?, end)
}

/// Traces a campaign as [`trace`] does, by results that are open.
///
/// # Errors
/// If an existing result can't be read.
pub fn trace_by(
    plan: &Plan,
    requirements: &Requirements,
    results: &CampaignResults,
    end: usize,
) -> Result<CampaignTrace, ResultError> {
    let requirements = &with_those_of_scenarios(plan, requirements);
    let mut streams: Vec<Option<StreamKey>> = Vec::with_capacity(plan.cases.len());
    let mut cases = Vec::with_capacity(plan.cases.len());
    for case in plan.cases.iter().take(end) {
        let (case, stream) = traced_case(plan, requirements, results, case)?;
        cases.push(case);
        streams.push(stream);
    }
    let rows = plan.cases.iter().zip(streams.iter().map(Option::as_ref));
    for (case, draw) in cases.iter_mut().zip(independence::draws(rows)) {
        case.draw = draw as usize;
    }
    Ok(CampaignTrace::new(requirements, &cases))
}

/// Traces a campaign as [`trace`] does, with the independent draw of each case that counts, and with at most
/// this number of links from a requirement to its cases.
pub(crate) fn first_by(
    plan: &Plan,
    requirements: &Requirements,
    results: &CampaignResults,
    draws: &[u32],
    links_max: usize,
) -> Result<CampaignTrace, ResultError> {
    let requirements = &with_those_of_scenarios(plan, requirements);
    let mut growing = GrowingTrace::new(requirements, links_max);
    for (case, draw) in plan.cases.iter().zip(draws) {
        let (case, _) = traced_case(plan, requirements, results, case)?;
        growing.add(&TracedCase { draw: *draw as usize, ..case });
    }
    Ok(growing.trace())
}

/// Takes the verdicts of requirements on all draws from the state of the campaign, which knows the looks.
pub fn take_verdicts(trace: &mut CampaignTrace, status: &CampaignStatus) {
    for row in &mut trace.requirements {
        let judged = status.requirements.get(&row.id);
        if let Some(judged) = judged.filter(|judged| judged.ensemble.is_some()) {
            row.verdict = Some(judged.verdict);
            row.reason.clone_from(&judged.reason);
            row.draws = judged.draws;
        }
    }
}

/// Traces a case, whose draw isn't known yet, and returns its stream.
fn traced_case(
    plan: &Plan,
    requirements: &Requirements,
    results: &CampaignResults,
    case: &Case,
) -> Result<(TracedCase, Option<StreamKey>), ResultError> {
    let planned = plan.scenarios.iter().find(|scenario| scenario.id == case.scenario);
    let of_file = |id: &&String| requirements.get(id).is_some();
    let verifies: Vec<String> = (planned.iter())
        .flat_map(|scenario| scenario.requirements.iter().filter(of_file))
        .cloned()
        .collect();
    let id = case.id.to_string();
    let Some(facts) = results.facts(plan, case)? else {
        return Ok((TracedCase { id, verifies, draw: 0, result: None }, None));
    };
    // A check that passes in a run without evidence isn't a pass either, and of two results
    // none counts.
    let most = match facts.besides {
        _ if results.differing(&case.id)?.is_some() => Verdict::Error,
        Verdict::Fail => Verdict::Inconclusive,
        other => other,
    };
    // A failed check of such a run doesn't count among the failures that an ensemble may
    // have.
    let allowed = |id: &str| {
        let check = requirements.get(id).and_then(Requirement::check);
        check.is_some_and(|check| check.ensemble.is_some())
    };
    let check = |id: &String| {
        let check = match facts.check(id) {
            Verdict::Fail if most != Verdict::Pass && allowed(id) => most,
            check => check.worst(most),
        };
        (id.clone(), traced(check))
    };
    let result = Some(Traced {
        verdict: traced(facts.verdict),
        checks: verifies.iter().map(check).collect(),
        // A campaign keeps summaries; a recording is made by running the case again.
        recording: None,
        folder: results.place(&case.id).map(|place| place.folder().display().to_string()),
    });
    Ok((TracedCase { id, verifies, draw: 0, result }, facts.stream().map(StreamKey::from)))
}

/// Converts a verdict without requirements into inconclusive.
fn traced(verdict: Verdict) -> Verdict {
    if verdict == Verdict::None { Verdict::Inconclusive } else { verdict }
}
