//! A stored summary held against itself: its verdict is derived again from its own numbers.
//!
//! A verdict in a file is what somebody says of a run. What the run shows are the measures, the limits and
//! what befell it, all of which are in the summary too. Every reader derives the verdict again; one that differs
//! is a contradiction, and its file is evidence of nothing.

use super::judge::{as_far_as_done, derive};
use super::summary::{Summary, WITH_FINDINGS};
use super::verdict::{Comparison, Requirement, RequirementResult, Verdict, evaluate};

/// The results of a stored summary's requirements, held against its measures again: nothing that it says of
/// them is taken over but their ids, measures and limits.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn results(summary: &Summary) -> Result<Vec<RequirementResult>, serde_json::Error> {
    let document = serde_json::to_value(summary)?;
    let again = |result: &RequirementResult| {
        let requirement = Requirement {
            id: result.id.clone(),
            measure: result.measure.clone(),
            comparison: result.comparison,
            limit: result.limit,
        };
        let found = evaluate(&requirement, &document);
        // Where nobody knows how uncertain a reference is, there is no value, and nothing is decided.
        let value = result.value.and(found.value);
        let found = RequirementResult {
            uncertainty: result.uncertainty,
            value,
            reason: result.reason.clone().or(found.reason),
            ..found
        };
        as_far_as_done(summary, found.again())
    };
    Ok(summary.requirements.iter().map(again).collect())
}

/// Whether what is said of a check can be said of its value: a pass of one that keeps its limit alone, a fail
/// of one that doesn't. Inconclusive may be for a reason outside of the value.
#[must_use]
pub fn stands(said: Verdict, comparison: Comparison, value: Option<f64>, limit: f64) -> bool {
    match said {
        Verdict::Pass => value.is_some_and(|value| comparison.holds(value, limit)),
        Verdict::Fail => value.is_some_and(|value| !comparison.holds(value, limit)),
        _ => true,
    }
}

/// Where a stored summary contradicts itself, in words; none: it says what its numbers come to.
#[must_use]
pub fn contradictions(summary: &Summary) -> Vec<String> {
    let results = match results(summary) {
        Ok(results) => results,
        Err(error) => return vec![format!("its verdict can't be derived again: {error}")],
    };
    let mut found = Vec::new();
    for (said, now) in summary.requirements.iter().zip(&results) {
        let number = |value: Option<f64>| value.map_or("none".to_owned(), |v| v.to_string());
        if said.value != now.value {
            found.push(format!(
                "{} says that {} is {}, its own measure is {}",
                said.id,
                said.measure,
                number(said.value),
                number(now.value)
            ));
        } else if said.verdict != now.verdict {
            let [value, limit] = [number(now.value), now.limit.to_string()];
            found.push(format!(
                "{} says {}, its value {value} and its limit {} {limit} come to {}",
                said.id,
                said.verdict.name(),
                said.comparison.sign(),
                now.verdict.name()
            ));
        } else if said.margin != now.margin {
            found.push(format!(
                "{} says that its margin is {}, value and limit leave {}",
                said.id,
                number(said.margin),
                number(now.margin)
            ));
        }
    }
    let derived = derive(summary).verdict;
    // Before there was a verdict none, what nothing was asked of passed.
    let was_none = summary.schema < WITH_FINDINGS
        && (summary.verdict, derived) == (Verdict::Pass, Verdict::None);
    if summary.verdict != derived && !was_none {
        found.push(format!(
            "it says {}, what it holds comes to {}",
            summary.verdict.name(),
            derived.name()
        ));
    }
    found
}
