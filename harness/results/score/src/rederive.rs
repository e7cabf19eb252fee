//! Consistency check of a stored summary: its verdict is derived again from its own numbers.
//!
//! A verdict in a file is only a claim. The evidence of the run is its measures, limits and findings,
//! all of which are in the summary too. Every reader derives the verdict again; if it differs, the
//! summary contradicts itself, and its file is evidence of nothing.

use super::counterfactual::Counterfactual;
use super::judge::{Finding, FindingSubject, as_far_as_done, derive};
use super::summary::{Summary, WITH_FINDINGS};
use super::verdict::{RequirementResult, evaluate};
use octant_account::Account;
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{Comparison, Verdict};

/// Derives the results of a stored summary's requirements from its measures again: of the stored
/// results, only ids, measures, limits, uncertainties and reasons are used, and whether there was a
/// value.
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
            limit: result.written_limit(),
            secant_latitude: result.at_equator.is_some(),
        };
        let found = evaluate(&requirement, &document);
        // With an unknown uncertainty of the reference there was no value, and the result stays
        // inconclusive.
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

/// True if the stated verdict of a check is possible for its value: a pass only if the limit is kept, a
/// fail only if it isn't. An inconclusive result may have a reason outside of the value.
#[must_use]
pub fn stands(said: Verdict, comparison: Comparison, value: Option<f64>, limit: f64) -> bool {
    match said {
        Verdict::Pass => value.is_some_and(|value| comparison.holds(value, limit)),
        Verdict::Fail => value.is_some_and(|value| !comparison.holds(value, limit)),
        _ => true,
    }
}

/// Lists the doubts in the accounts of a summary that are no findings in it: each makes a run inconclusive.
fn untold(summary: &Summary) -> impl Iterator<Item = String> {
    let is_told = |doubt: &String| summary.findings.iter().any(|f| f.reason.starts_with(doubt));
    summary.inputs.iter().flat_map(Account::doubts).filter(move |doubt| !is_told(doubt))
}

/// Contradictions in a stored summary, as texts; none: its verdict follows from its numbers.
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
    let baseline = summary.baseline.iter().filter_map(|b| b.counterfactual.as_ref());
    let compared = summary.counterfactual.iter().chain(baseline);
    found.extend(compared.flat_map(Counterfactual::contradictions));
    found.extend(untold(summary).map(|doubt| format!("its findings don't tell that {doubt}")));
    let derived = derive(summary).verdict;
    // Before the verdict `none` existed, a run without requirements passed.
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

/// Verdict on a stored run by the rules of this program.
#[derive(Clone, Debug, PartialEq)]
pub struct RederivedVerdict {
    /// Summary with its requirements, findings, verdict and reasons derived again.
    pub summary: Summary,
    /// Parts that could not be derived because they were never stored.
    pub not_stored: Vec<String>,
}

impl RederivedVerdict {
    /// True if nothing stored contradicts a pass, but too little is stored for one.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        let mut without = self.summary.clone();
        without.findings.retain(|finding| !finding.reason.starts_with(NOT_HELD));
        without.findings.len() < self.summary.findings.len()
            && self.summary.verdict == Verdict::Inconclusive
            && derive(&without).verdict <= Verdict::Pass
    }
}

/// Beginning of the finding about a summary with too little data.
const NOT_HELD: &str = "its summary doesn't hold what a pass rests on";

/// Derives the verdict of a stored summary again, with findings about the bench from outside of it.
///
/// A summary of schema 1 has neither plan nor findings. Its stored verdict is then the lower bound, and
/// it can't become a pass, because it is unknown whether the plan was done and the answers were right.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn rejudge(
    stored: &Summary,
    outside: &[Finding],
) -> Result<RederivedVerdict, serde_json::Error> {
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
        // The requirements come first, so that their consequences aren't reported twice.
        summary.requirements = results(&summary)?;
        summary.schema = WITH_FINDINGS;
        if derive(&summary).verdict < stored.verdict {
            summary.findings.push(Finding {
                verdict: stored.verdict,
                about: FindingSubject::Run,
                reason: format!(
                    "it was judged {} then: {}",
                    stored.verdict.name(),
                    stored.reasons.join("; ")
                ),
            });
        }
    }
    let untold: Vec<String> = untold(&summary).collect();
    let doubted = |doubt| Finding::of_bench(Verdict::Inconclusive, doubt);
    summary.findings.extend(untold.into_iter().map(doubted));
    for finding in outside {
        if !summary.findings.contains(finding) {
            summary.findings.push(finding.clone());
        }
    }
    summary.requirements = results(&summary)?;
    let derived = derive(&summary);
    (summary.verdict, summary.reasons) = (derived.verdict, derived.reasons);
    Ok(RederivedVerdict { summary, not_stored })
}
