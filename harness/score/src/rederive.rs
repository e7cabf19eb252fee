//! A stored summary held against itself: its verdict is derived again from its own numbers.
//!
//! A verdict in a file is what somebody says of a run. What the run shows are the measures, the limits and
//! what befell it, all of which are in the summary too. Every reader derives the verdict again; one that differs
//! is a contradiction, and its file is evidence of nothing.

use super::judge::{About, Finding, as_far_as_done, derive};
use super::summary::{Summary, WITH_FINDINGS};
use super::verdict::{RequirementResult, evaluate};
use octant_requirements::verdict::LimitCheck;
use octant_requirements::{Comparison, Verdict};

/// The results of a stored summary's requirements, held against its measures again: nothing that it says of
/// them is taken over but their ids, measures and limits.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn results(summary: &Summary) -> Result<Vec<RequirementResult>, serde_json::Error> {
    let document = serde_json::to_value(summary)?;
    let again = |result: &RequirementResult| {
        let requirement = LimitCheck {
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

/// What a run comes to by the rules of this program, from what is stored of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rejudged {
    /// The summary with its requirements, findings, verdict and reasons derived anew.
    pub summary: Summary,
    /// What could not be derived, since it was never stored.
    pub not_stored: Vec<String>,
}

impl Rejudged {
    /// Nothing that is stored speaks against a pass, and too little is stored for one.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        let mut without = self.summary.clone();
        without.findings.retain(|finding| !finding.reason.starts_with(NOT_HELD));
        without.findings.len() < self.summary.findings.len()
            && self.summary.verdict == Verdict::Inconclusive
            && derive(&without).verdict <= Verdict::Pass
    }
}

/// The beginning of what is told of a summary that holds too little.
const NOT_HELD: &str = "its summary doesn't hold what a pass rests on";

/// Derives the verdict of a stored summary anew, with findings about the bench that stand outside of it.
///
/// A summary of schema 1 has neither plan nor findings. What it says of itself then stays as the least; it can't
/// come to a pass, since nobody knows whether the plan was done and the answers were right.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn rejudge(stored: &Summary, outside: &[Finding]) -> Result<Rejudged, serde_json::Error> {
    let mut summary = stored.clone();
    let mut not_stored = Vec::new();
    if stored.schema < WITH_FINDINGS {
        if stored.planned.is_none() || stored.done.is_none() {
            not_stored.push("what the run was to do and what it did".to_owned());
        }
        not_stored.push("what unit and bench did wrong".to_owned());
        if stored.decision.is_none() {
            not_stored.push(
                "how uncertain the references are: values are held against their limits as they are"
                    .to_owned(),
            );
        }
        summary.findings.push(Finding::of_run(format!(
            "{NOT_HELD} (schema {}): {}",
            stored.schema,
            not_stored[..not_stored.len().min(2)].join(", ")
        )));
        // The requirements first: what follows from them again isn't told twice.
        summary.requirements = results(&summary)?;
        summary.schema = WITH_FINDINGS;
        if derive(&summary).verdict < stored.verdict {
            summary.findings.push(Finding {
                verdict: stored.verdict,
                about: About::Run,
                reason: format!(
                    "it was judged {} then: {}",
                    stored.verdict.name(),
                    stored.reasons.join("; ")
                ),
            });
        }
    }
    for finding in outside {
        if !summary.findings.contains(finding) {
            summary.findings.push(finding.clone());
        }
    }
    summary.requirements = results(&summary)?;
    let derived = derive(&summary);
    (summary.verdict, summary.reasons) = (derived.verdict, derived.reasons);
    Ok(Rejudged { summary, not_stored })
}
