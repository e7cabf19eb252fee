//! State of each case, from the facts of its result.

use crate::execute::case::ResultError;
use crate::plan::{Case, Plan};
use crate::store::CampaignResults;
use crate::store::in_plan_order::{FACTS_AT_ONCE, read_in_order};
use crate::store::stream_key::StreamKey;
use octant_statistics::cluster::RowResult;
use octant_verdict::Verdict;

/// State of a case that has run: what is counted of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct CaseState {
    pub(crate) verdict: Verdict,
    /// Worst verdict of all parts except the requirements.
    pub(crate) besides: Verdict,
    /// True if a refused calibration is all that is wrong, except for the requirements.
    pub(crate) refused_alone: bool,
    /// Stream; `None` without a summary.
    pub(crate) stream: Option<StreamKey>,
    /// Numerics version of the program that ran it, which old results don't have; `None` without a summary.
    pub(crate) numerics: Option<Option<u32>>,
    /// Verdict of each requirement that its scenario checks, and what the case shows of it; with the reason, where that
    /// is nothing.
    pub(crate) checks: Box<[(Verdict, RowResult, Option<String>)]>,
    /// True if it has two results.
    pub(crate) differs: bool,
    /// First reason of a result that isn't a pass.
    pub(crate) why: Option<String>,
}

/// Requirements that the scenario of a case checks.
pub(crate) fn checked<'p>(plan: &'p Plan, case: &Case) -> &'p [String] {
    let scenario = plan.scenarios.iter().find(|scenario| scenario.id == case.scenario);
    scenario.map(|scenario| scenario.requirements.as_slice()).unwrap_or_default()
}

/// Reads the states of the cases of a plan up to `end` that are `wanted`, by their places, and gives them to `take` in
/// their order; `None` for a case without a result.
///
/// # Errors
/// If an existing result can't be read.
pub(crate) fn each_state(
    plan: &Plan,
    results: &CampaignResults,
    end: usize,
    wanted: impl Fn(usize) -> bool + Sync,
    mut take: impl FnMut(&Case, Option<CaseState>),
) -> Result<(), ResultError> {
    let cases = plan.cases.get(..end).unwrap_or(&plan.cases);
    let read = |index: usize| match cases.get(index) {
        Some(case) if wanted(index) => state(plan, results, case).map(Some),
        _ => Ok(None),
    };
    read_in_order(cases.len(), FACTS_AT_ONCE, read, |index, state| {
        if let Some(case) = cases.get(index) {
            take(case, state);
        }
        Ok(())
    })
}

fn state(
    plan: &Plan,
    results: &CampaignResults,
    case: &Case,
) -> Result<Option<CaseState>, ResultError> {
    let Some(facts) = results.facts(plan, case)? else { return Ok(None) };
    let ids = checked(plan, case).iter();
    Ok(Some(CaseState {
        verdict: facts.verdict,
        besides: facts.besides,
        refused_alone: facts.refused_alone,
        stream: facts.stream().map(StreamKey::from),
        numerics: facts.run.as_ref().map(|run| run.numerics),
        checks: ids
            .map(|id| (facts.check(id), facts.shows(id), facts.why_unknown(id).map(str::to_owned)))
            .collect(),
        differs: results.differing(&case.id)?.is_some(),
        why: facts.why().cloned(),
    }))
}
