//! Runs one case to its summary, and reads its result.

pub use crate::plan::make::hash_of;
pub use crate::store::result_error::ResultError;

use crate::plan::{Case, PlanError, PlannedScenario};
use crate::store::error::ResultPlace;
use octant_base::control::Control;
use octant_base::not_finite;
use octant_run::many::{Beginnings, ManyError, OneOfMany, judge_each};
use octant_run::{Run, StreamKeeping};
use octant_scenario::Scenario;
use octant_score::rederive;
use octant_score::summary::{self, Summary};
use octant_score::verdict::RequirementResult;
use octant_verdict::measures::{MeasureNeed, needs};
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{Comparison, Verdict};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Newest version of the result file, which this program reads.
pub const SCHEMA: u32 = 3;
/// First version whose summary may have null for a number that isn't finite, which older programs can't read; a result
/// without one is of the version before.
const NOT_FINITE: u32 = 3;
/// First version whose results contain the hashes of their inputs; older ones are read without.
const CHAINED: u32 = 2;

/// Result of a case. If it has a summary, it contains nothing of host or clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseResult {
    /// Version of this form, 1 to [`SCHEMA`].
    pub schema: u32,
    /// The case.
    pub case: String,
    /// BLAKE3 of everything that defines the case, hexadecimal: its scenario, additional checks,
    /// settings, faults and seed. Its first digits are the case's id. Null in files of version 1.
    #[serde(default)]
    pub case_blake3: Option<String>,
    /// BLAKE3 of the summary, computed by [`hash_of_summary`]; null without one.
    #[serde(default)]
    pub summary_blake3: Option<String>,
    /// Worst verdict of all parts: an error if the case has no summary, inconclusive if it checks
    /// no requirement.
    pub verdict: Verdict,
    /// Reason why there is no summary; null if there is one.
    pub error: Option<String>,
    /// Summary of the run.
    pub summary: Option<Summary>,
}

/// Reasons why a case gave no summary.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The scenario isn't the planned one, or isn't valid.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The case or its twin could not be run.
    #[error(transparent)]
    Run(#[from] ManyError),
    /// The run ended without a result: an error in this program.
    #[error("run the case: it has no result")]
    NotRun,
    /// The summary can't be written.
    #[error("write the summary: {0}")]
    Json(#[from] serde_json::Error),
}

/// Runs a case from its beginning, and from its beginning the twin that its requirements ask for.
///
/// # Errors
/// If its scenario isn't the planned one, or can't be run.
pub fn run(
    planned: &PlannedScenario,
    case: &Case,
    control: &Control,
) -> Result<CaseResult, CaseError> {
    run_all(planned, &[case], Beginnings::Undivided, control)
        .pop()
        .unwrap_or(Err(CaseError::NotRun))
}

/// Runs cases of a scenario, each with its twin where its requirements ask for one. The results are in the order of the
/// cases, and the same bits with shared beginnings as without.
pub(crate) fn run_all(
    planned: &PlannedScenario,
    cases: &[&Case],
    beginnings: Beginnings,
    control: &Control,
) -> Vec<Result<CaseResult, CaseError>> {
    let scenarios: Vec<_> = cases.iter().map(|case| planned.scenario(case)).collect();
    let (places, all): (Vec<usize>, Vec<OneOfMany<'_>>) = (scenarios.iter().zip(cases).enumerate())
        .filter_map(|(place, (scenario, case))| {
            let scenario = scenario.as_ref().ok()?;
            let (seed, keeping) = (case.seed, StreamKeeping::HashAlone);
            let twin = needs_twin(scenario.requirements.iter().map(|own| &own.check));
            Some((place, OneOfMany { scenario, seed, keeping, twin }))
        })
        .unzip();
    let done: Mutex<BTreeMap<usize, Result<Run, ManyError>>> = Mutex::default();
    judge_each(&all, beginnings, 1, control, &|index, run| {
        done.lock().unwrap_or_else(PoisonError::into_inner).insert(places[index], run);
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut outcome = |place: usize, scenario: Result<Scenario, PlanError>| {
        scenario?;
        let run = done.remove(&place).ok_or(CaseError::NotRun)??;
        let case = cases[place];
        Ok(CaseResult::of(&case.id, Some(hash_of(planned, case)), run.summary)?)
    };
    let scenarios = scenarios.into_iter().enumerate();
    scenarios.map(|(place, scenario)| outcome(place, scenario)).collect()
}

/// Returns whether one of some requirements measures the effect of faults, against the run without them.
pub(crate) fn needs_twin<'a>(checks: impl IntoIterator<Item = &'a LimitCheck>) -> bool {
    let asks =
        |check: &LimitCheck| needs(check.measure.trim_matches('|')).contains(&MeasureNeed::Twin);
    checks.into_iter().any(asks)
}

/// Computes the BLAKE3 of a summary as JSON with sorted keys and without white space, hexadecimal:
/// independent of the file's formatting, and with any fields that a newer program added.
#[must_use]
pub fn hash_of_summary(summary: &serde_json::Value) -> String {
    blake3::hash(summary.to_string().as_bytes()).to_hex().to_string()
}

/// Returns the verdict of a case whose run had `verdict`: a case that checks nothing is
/// inconclusive.
fn verdict_of(verdict: Verdict, summary: &Summary) -> Verdict {
    let nothing = summary.requirements.is_empty();
    verdict.worst(if nothing { Verdict::Inconclusive } else { Verdict::Pass })
}

impl CaseResult {
    /// Creates the result of a case with a summary.
    ///
    /// # Errors
    /// If the summary can't be written as JSON.
    pub fn of(
        case: &str,
        case_blake3: Option<String>,
        summary: Summary,
    ) -> Result<Self, serde_json::Error> {
        let is_finite = summary.schema < summary::NOT_FINITE;
        Ok(Self {
            schema: if is_finite { CHAINED } else { NOT_FINITE },
            case: case.to_owned(),
            case_blake3,
            summary_blake3: Some(hash_of_summary(&serde_json::to_value(&summary)?)),
            verdict: verdict_of(summary.verdict, &summary),
            error: None,
            summary: Some(summary),
        })
    }

    /// Creates the result of a case without a summary.
    #[must_use]
    pub fn broken(case: &str, error: String) -> Self {
        Self {
            schema: CHAINED,
            case: case.to_owned(),
            case_blake3: None,
            summary_blake3: None,
            verdict: Verdict::Error,
            error: Some(error),
            summary: None,
        }
    }

    /// Returns the verdict of a requirement: an error without a summary, inconclusive if it wasn't
    /// checked.
    #[must_use]
    pub fn check(&self, requirement: &str) -> Verdict {
        let Some(summary) = &self.summary else { return Verdict::Error };
        let checks = summary.requirements.iter().filter(|check| check.id == requirement);
        // If a requirement is checked more than once, all checks must hold.
        checks.map(|check| check.verdict).reduce(Verdict::worst).unwrap_or(Verdict::Inconclusive)
    }

    /// Returns the bytes of the result file.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Reads a result file and checks that it is consistent: its hashes, and its verdict with its
    /// values and limits.
    ///
    /// # Errors
    /// If it can't be read, or isn't the result of its case: found and expected.
    pub fn read(path: &Path) -> Result<Self, ResultError> {
        let bytes = std::fs::read(path)
            .map_err(|source| ResultError::System { path: path.to_owned(), source })?;
        Self::from_bytes(&ResultPlace::File(path.to_owned()), &bytes)
    }

    /// Reads as [`CaseResult::read`], from the bytes that are stored in a place.
    ///
    /// # Errors
    /// If it can't be read, or isn't the result of its case: found and expected.
    pub fn from_bytes(place: &ResultPlace, bytes: &[u8]) -> Result<Self, ResultError> {
        let result = Self::unjudged(place, bytes)?;
        match result.contradictions(bytes).as_slice() {
            [] => Ok(result),
            all => Err(ResultError::Contradiction {
                place: place.clone(),
                contradictions: all.to_vec(),
            }),
        }
    }

    /// Reads the result of a case as it is: its verdict isn't reliable until it is derived again.
    ///
    /// # Errors
    /// If it can't be read, or isn't the result of its case: found and expected.
    pub fn unjudged(place: &ResultPlace, bytes: &[u8]) -> Result<Self, ResultError> {
        let form = |source| ResultError::Form { place: place.clone(), source };
        // The version is checked first: nothing else is reliable in a newer file.
        let Version { schema } = serde_json::from_slice(bytes).map_err(form)?;
        if !(1..=SCHEMA).contains(&schema) {
            let place = place.clone();
            return Err(ResultError::Version { place, found: schema, newest: SCHEMA });
        }
        let result: Self = not_finite::from_slice(bytes).map_err(form)?;
        if place.case() != result.case {
            return Err(ResultError::Name { place: place.clone(), case: result.case });
        }
        Ok(result)
    }

    /// Checks that the result belongs to a planned case, with its seed and checks.
    pub(crate) fn belongs(
        &self,
        place: &ResultPlace,
        planned: &PlannedScenario,
        case: &Case,
    ) -> Result<(), ResultError> {
        let Some(summary) = &self.summary else { return Ok(()) };
        let claim = ResultClaim {
            schema: self.schema,
            case_blake3: self.case_blake3.as_deref(),
            seed: summary.seed,
            checks: &summary.requirements,
        };
        claim.check(place, planned, case)
    }

    /// Lists the contradictions within the result.
    fn contradictions(&self, bytes: &[u8]) -> Vec<String> {
        let mut found = Vec::new();
        if let Some(hash) = self.case_blake3.as_ref().filter(|hash| !hash.starts_with(&self.case)) {
            found.push(format!("its case_blake3 {hash} is not that of case {}", self.case));
        }
        let Some(summary) = &self.summary else {
            if self.verdict != Verdict::Error {
                found.push(format!("it says {} without a summary", self.verdict.name()));
            }
            return found;
        };
        if self.schema >= CHAINED {
            let hash = serde_json::from_slice::<serde_json::Value>(bytes)
                .ok()
                .and_then(|mut all| Some(hash_of_summary(&all.get_mut("summary")?.take())));
            if hash != self.summary_blake3 {
                let none = || "none".to_owned();
                found.push(format!(
                    "its summary_blake3 is {}, its summary gives {}",
                    self.summary_blake3.clone().unwrap_or_else(none),
                    hash.unwrap_or_else(none)
                ));
            }
        }
        found.extend(rederive::contradictions(summary));
        let expected = match &self.error {
            None => verdict_of(summary.verdict, summary),
            Some(_) => Verdict::Error,
        };
        if self.verdict != expected {
            let [said, expected] = [self.verdict, expected].map(Verdict::name);
            found.push(format!("it says {said}, its summary comes to {expected}"));
        }
        found
    }
}

/// Planned case that a result with a summary names as its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ResultClaim<'a> {
    pub(crate) schema: u32,
    pub(crate) case_blake3: Option<&'a str>,
    pub(crate) seed: u64,
    pub(crate) checks: &'a [RequirementResult],
}

impl ResultClaim<'_> {
    /// Checks that it names the planned case, with its seed and checks.
    pub(crate) fn check(
        &self,
        place: &ResultPlace,
        planned: &PlannedScenario,
        case: &Case,
    ) -> Result<(), ResultError> {
        let wrong = |what: &str, found: &str, expected: &str| {
            Err(ResultError::Foreign {
                place: place.clone(),
                what: what.to_owned(),
                found: found.to_owned(),
                expected: expected.to_owned(),
            })
        };
        if self.schema >= CHAINED {
            let expected = hash_of(planned, case);
            let found = self.case_blake3.unwrap_or("none");
            if found != expected {
                return wrong("case_blake3", found, &expected);
            }
        }
        if self.seed != case.seed {
            return wrong("seed", &self.seed.to_string(), &case.seed.to_string());
        }
        for check in &planned.checks {
            let of_it = |result: &&RequirementResult| result.id == check.id;
            let same = |result: &&RequirementResult| {
                let has_secant = result.at_equator.is_some();
                (result.measure.as_str(), result.comparison, result.written_limit(), has_secant)
                    == (&check.measure, check.comparison, check.limit, check.secant_latitude)
            };
            let mut found = self.checks.iter().filter(of_it).peekable();
            // A missing check is reported as not checked.
            if let Some(first) = found.peek().copied()
                && !found.any(|result| same(&result))
            {
                let sign =
                    |comparison: Comparison, limit: f64| format!("{} {limit}", comparison.sign());
                return wrong(
                    &format!("requirement {}", check.id),
                    &format!("{} {}", first.measure, sign(first.comparison, first.written_limit())),
                    &format!("{} {}", check.measure, sign(check.comparison, check.limit)),
                );
            }
        }
        Ok(())
    }
}

#[derive(Deserialize)]
struct Version {
    schema: u32,
}
