//! Facts of a result: all that the state of a campaign needs, in a hundredth of the result's bytes.

use crate::execute::case::{CaseResult, ResultClaim, ResultError};
use crate::judge::except_requirements::{is_refused_alone, verdict_except_requirements};
use crate::plan::{Case, PlannedScenario};
use crate::store::error::ResultPlace;
use octant_score::rederive::stands;
use octant_score::verdict::RequirementResult;
use octant_statistics::cluster::RowResult;
use octant_verdict::Verdict;
use serde::{Deserialize, Serialize};

/// Facts of a result. They are stored beside it, and follow from it alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseFacts {
    /// Version of the result.
    pub schema: u32,
    /// Worst verdict of all parts.
    pub verdict: Verdict,
    /// Worst verdict of all parts except the requirements.
    pub besides: Verdict,
    /// True if a refused calibration is all that is wrong, except for the requirements.
    pub refused_alone: bool,
    /// Reason why there is no summary; null if there is one.
    pub error: Option<String>,
    /// First reason for the verdict.
    pub reason: Option<String>,
    /// BLAKE3 of everything that defines the case.
    pub case_blake3: Option<String>,
    /// Facts of the summary; null without one.
    pub run: Option<SummaryFacts>,
}

/// Facts of a summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SummaryFacts {
    /// Seed of every random stream.
    pub seed: u64,
    /// BLAKE3 of the stream.
    pub stream_hash: String,
    /// Numerics version of the program.
    pub numerics: Option<u32>,
    /// Checks of the case.
    pub checks: Vec<RequirementResult>,
}

/// Returns what a case shows of a requirement, from the verdict of its check and the worst one of all else: that it is
/// met only if both passed, that it isn't only if one of them failed.
pub(crate) fn row_result(check: Verdict, besides: Verdict) -> RowResult {
    match (check, besides) {
        (Verdict::Pass, Verdict::Pass) => RowResult::Passed,
        (Verdict::Fail, _) | (_, Verdict::Fail) => RowResult::Failed,
        _ => RowResult::Unknown,
    }
}

impl CaseFacts {
    /// Extracts the facts of a result.
    #[must_use]
    pub fn of(result: &CaseResult) -> Self {
        let summary = result.summary.as_ref();
        Self {
            schema: result.schema,
            verdict: result.verdict,
            besides: verdict_except_requirements(result),
            refused_alone: is_refused_alone(result),
            error: result.error.clone(),
            reason: summary.and_then(|summary| summary.reasons.first().cloned()),
            case_blake3: result.case_blake3.clone(),
            run: summary.map(|summary| SummaryFacts {
                seed: summary.seed,
                stream_hash: summary.stream_hash.clone(),
                numerics: summary.numerics,
                checks: summary.requirements.clone(),
            }),
        }
    }

    /// Returns the hash of the stream; `None` for a case without a summary.
    #[must_use]
    pub fn stream(&self) -> Option<&str> {
        self.run.as_ref().map(|run| run.stream_hash.as_str())
    }

    /// Returns the verdict of a requirement: an error without a summary, inconclusive if it wasn't
    /// checked.
    #[must_use]
    pub fn check(&self, requirement: &str) -> Verdict {
        let Some(run) = &self.run else { return Verdict::Error };
        let checks = run.checks.iter().filter(|check| check.id == requirement);
        // If a requirement is checked more than once, all checks must hold.
        checks.map(|check| check.verdict).reduce(Verdict::worst).unwrap_or(Verdict::Inconclusive)
    }

    /// Returns what the result shows of a requirement.
    #[must_use]
    pub fn shows(&self, requirement: &str) -> RowResult {
        row_result(self.check(requirement), self.besides)
    }

    /// Returns the reason why the result shows nothing of a requirement; `None`: it does, or there is no reason.
    #[must_use]
    pub fn why_unknown(&self, requirement: &str) -> Option<&str> {
        if self.shows(requirement) != RowResult::Unknown {
            return None;
        }
        let mut checks = self.run.iter().flat_map(|run| &run.checks);
        let own = checks.find(|check| check.id == requirement && check.verdict != Verdict::Pass);
        let of_check = own.and_then(|check| check.reason.as_deref());
        of_check.or(self.error.as_deref()).or(self.reason.as_deref())
    }

    /// Returns the first reason of a result that isn't a pass.
    #[must_use]
    pub fn why(&self) -> Option<&String> {
        self.error.as_ref().or(self.reason.as_ref()).filter(|_| self.verdict != Verdict::Pass)
    }

    /// Checks that the facts are those of a planned case, and that their verdicts follow from their
    /// values and limits.
    pub(crate) fn belongs(
        &self,
        place: &ResultPlace,
        planned: Option<&PlannedScenario>,
        case: &Case,
    ) -> Result<(), ResultError> {
        let contradictions = self.contradictions();
        if !contradictions.is_empty() {
            return Err(ResultError::Contradiction { place: place.clone(), contradictions });
        }
        let (Some(run), Some(planned)) = (&self.run, planned) else { return Ok(()) };
        let claim = ResultClaim {
            schema: self.schema,
            case_blake3: self.case_blake3.as_deref(),
            seed: run.seed,
            checks: &run.checks,
        };
        claim.check(place, planned, case)
    }

    fn contradictions(&self) -> Vec<String> {
        let mut found = Vec::new();
        let mut least = Verdict::None;
        for check in self.run.iter().flat_map(|run| &run.checks) {
            if !stands(check.verdict, check.comparison, check.value, check.limit) {
                found.push(check.sentence() + ", and says " + check.verdict.name());
            }
            least = least.worst(check.verdict);
        }
        if self.run.is_none() || self.error.is_some() {
            least = Verdict::Error;
        }
        if self.verdict < least {
            let [said, least] = [self.verdict, least].map(Verdict::name);
            found.push(format!("it says {said}, its facts come to {least}"));
        }
        found
    }
}
