//! Links from requirements to cases, results and recordings, and back.

use crate::requirement::{EnsembleRequirement, Requirement, Requirements, Verification};
use crate::verdict::Verdict;
use octant_statistics::cluster::{DrawCounts, DrawTally, RowResult};
use octant_statistics::proportion;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// A case of a campaign, with the requirements that it verifies and its result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TracedCase {
    /// Id of the case.
    pub id: String,
    /// Ids of the requirements that it verifies.
    pub verifies: Vec<String>,
    /// Number of its independent draw: cases of one draw share their instrument and its noise.
    pub draw: usize,
    /// Result; `None` if the case hasn't run.
    pub result: Option<TracedResult>,
}

/// Result of a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TracedResult {
    /// Verdict of the case as a whole.
    pub verdict: Verdict,
    /// Verdict of each check, by the id of the requirement. A requirement that the case should verify
    /// and that is missing here was not checked.
    pub checks: Vec<(String, Verdict)>,
    /// The recording.
    pub recording: Option<String>,
    /// The run folder.
    pub folder: Option<String>,
}

/// One case of a requirement.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TraceLink {
    /// The case.
    pub case: String,
    /// Number of its independent draw.
    pub draw: usize,
    /// Verdict of the check; `None` if the case hasn't run, or ran without this check.
    pub verdict: Option<Verdict>,
    /// The recording.
    pub recording: Option<String>,
    /// The run folder.
    pub folder: Option<String>,
}

/// Numbers of checks by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VerdictCounts {
    /// Passed.
    pub pass: u64,
    /// Inconclusive.
    pub inconclusive: u64,
    /// Failed.
    pub fail: u64,
    /// The bench failed.
    pub error: u64,
    /// Not run, or run without this check.
    pub missing: u64,
}

impl VerdictCounts {
    /// Number of all checks, also of those that are missing.
    #[must_use]
    pub const fn all(&self) -> u64 {
        self.pass + self.inconclusive + self.fail + self.error + self.missing
    }

    fn add(&mut self, verdict: Option<Verdict>) {
        *match verdict {
            None => &mut self.missing,
            Some(Verdict::Pass) => &mut self.pass,
            // If nothing was required, nothing is shown.
            Some(Verdict::None | Verdict::Inconclusive) => &mut self.inconclusive,
            Some(Verdict::Fail) => &mut self.fail,
            Some(Verdict::Error) => &mut self.error,
        } += 1;
    }
}

/// Result of one requirement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceRow {
    /// Id.
    pub id: String,
    /// Verification: `test`, `analysis`, `inspection`, `open`.
    pub verification: String,
    /// Cases, in the order of the campaign.
    pub cases: Vec<TraceLink>,
    /// Numbers of its checks by verdict.
    pub counts: VerdictCounts,
    /// Numbers of its independent draws by result.
    pub draws: DrawCounts,
    /// Verdict; `None` if a run can't give one: it is verified by other tests, analysis or inspection.
    pub verdict: Option<Verdict>,
    /// Reason, in plain words.
    pub reason: String,
}

/// A case that names an unknown requirement.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnknownRequirement {
    /// The case.
    pub case: String,
    /// Id that it names.
    pub requirement: String,
}

/// Trace of a campaign, in both directions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CampaignTrace {
    /// Every requirement with its cases, in the order of the document.
    pub requirements: Vec<TraceRow>,
    /// Requirements without a case, whose verification is by test or open.
    pub without_case: Vec<String>,
    /// Cases that verify no known requirement.
    pub without_requirement: Vec<String>,
    /// Unknown requirements that cases name.
    pub unknown: Vec<UnknownRequirement>,
    /// Reasons in the accounts of the documents why requirements may be missing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<String>,
}

/// Trace of a campaign whose cases come one by one.
#[derive(Debug)]
pub struct GrowingTrace<'a> {
    requirements: &'a Requirements,
    /// Place of each requirement by its id.
    index: HashMap<&'a str, usize>,
    rows: Vec<GrowingRow>,
    without_requirement: Vec<String>,
    unknown: Vec<UnknownRequirement>,
    links_max: usize,
}

/// Cases of a requirement so far.
#[derive(Clone, Debug, Default)]
struct GrowingRow {
    links: Vec<TraceLink>,
    counts: VerdictCounts,
    draws: DrawTally,
}

impl<'a> GrowingTrace<'a> {
    /// Begins a trace, in which each requirement will have its first `links_max` cases. All of them count.
    #[must_use]
    pub fn new(requirements: &'a Requirements, links_max: usize) -> Self {
        let all = &requirements.requirements;
        Self {
            requirements,
            index: all.iter().enumerate().map(|(i, r)| (r.id.as_str(), i)).collect(),
            rows: vec![GrowingRow::default(); all.len()],
            without_requirement: Vec::new(),
            unknown: Vec::new(),
            links_max,
        }
    }

    /// Adds a case. One that names a requirement several times counts once for it, with the worst of its
    /// checks.
    pub fn add(&mut self, case: &TracedCase) {
        let mut worst: HashMap<&str, Verdict> = HashMap::new();
        for (id, verdict) in case.result.iter().flat_map(|result| &result.checks) {
            let slot = worst.entry(id).or_insert(*verdict);
            *slot = (*slot).max(*verdict);
        }
        // Checks count, whether they were announced or not.
        let mut ids: Vec<&str> = Vec::new();
        let checked = case.result.iter().flat_map(|r| &r.checks).map(|(id, _)| id);
        for id in case.verifies.iter().chain(checked) {
            if !ids.contains(&id.as_str()) {
                ids.push(id);
            }
        }
        let mut known = false;
        for id in ids {
            let Some(row) = self.index.get(id).and_then(|at| self.rows.get_mut(*at)) else {
                let requirement = id.to_owned();
                self.unknown.push(UnknownRequirement { case: case.id.clone(), requirement });
                continue;
            };
            known = true;
            let verdict = worst.get(id).copied();
            row.counts.add(verdict);
            row.draws.add(
                case.draw,
                match verdict {
                    None => RowResult::Open,
                    Some(Verdict::Pass) => RowResult::Passed,
                    Some(Verdict::Fail) => RowResult::Failed,
                    Some(_) => RowResult::Unknown,
                },
            );
            if row.links.len() < self.links_max {
                row.links.push(TraceLink {
                    case: case.id.clone(),
                    draw: case.draw,
                    verdict,
                    recording: case.result.as_ref().and_then(|r| r.recording.clone()),
                    folder: case.result.as_ref().and_then(|r| r.folder.clone()),
                });
            }
        }
        if !known {
            self.without_requirement.push(case.id.clone());
        }
    }

    /// Returns the trace of all cases.
    #[must_use]
    pub fn trace(self) -> CampaignTrace {
        let Self { requirements, rows, without_requirement, unknown, .. } = self;
        let rows: Vec<TraceRow> =
            requirements.requirements.iter().zip(rows).map(|(r, cases)| row(r, cases)).collect();
        let tested = |row: &&TraceRow| row.counts.all() == 0 && row.verdict.is_some();
        let without_case = rows.iter().filter(tested).map(|row| row.id.clone()).collect();
        let doubts = requirements.doubts();
        CampaignTrace { requirements: rows, without_case, without_requirement, unknown, doubts }
    }
}

impl CampaignTrace {
    /// Traces the cases of a campaign. A case that names a requirement several times counts once for
    /// it, with the worst of its checks.
    #[must_use]
    pub fn new(requirements: &Requirements, cases: &[TracedCase]) -> Self {
        let mut growing = GrowingTrace::new(requirements, usize::MAX);
        cases.iter().for_each(|case| growing.add(case));
        growing.trace()
    }

    /// Worst verdict of all requirements that runs can verify. Without any it is inconclusive, because
    /// nothing was shown; so it is where requirements may be missing.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let worst = self.requirements.iter().filter_map(|row| row.verdict).max();
        let is_whole = self.unknown.is_empty() && self.doubts.is_empty();
        let most = if is_whole { Verdict::Pass } else { Verdict::Inconclusive };
        worst.unwrap_or(Verdict::Inconclusive).max(most)
    }

    /// Requirements that a case verifies, with the verdict of each check.
    #[must_use]
    pub fn of_case(&self, case: &str) -> Vec<(&str, Option<Verdict>)> {
        let of =
            |row: &TraceRow| row.cases.iter().find(|link| link.case == case).map(|l| l.verdict);
        self.requirements
            .iter()
            .filter_map(|row| of(row).map(|verdict| (row.id.as_str(), verdict)))
            .collect()
    }
}

fn row(requirement: &Requirement, cases: GrowingRow) -> TraceRow {
    let GrowingRow { links: cases, counts, draws } = cases;
    let draws = draws.counts();
    let (verdict, reason) = match &requirement.verification {
        Verification::Test(check) => {
            let (verdict, reason) = judge(check.ensemble, counts, draws);
            (Some(verdict), reason)
        }
        Verification::Open => {
            (Some(Verdict::Inconclusive), "nobody has said how it is verified".to_owned())
        }
        Verification::Tests(tests) => {
            (None, format!("verified by tests of which no run can tell: {}", tests.join("; ")))
        }
        other => (None, format!("verified by {}, of which no run can tell", other.name())),
    };
    TraceRow {
        id: requirement.id.clone(),
        verification: requirement.verification.name().to_owned(),
        cases,
        counts,
        draws,
        verdict,
        reason,
    }
}

/// Combines the checks of a requirement, by bounds that hold for data that is looked at once.
///
/// Without a required probability the worst check decides. With one, independent draws are counted, not
/// checks: a draw passes if all of its checks did. The verdict is pass if the lower bound of the
/// probability that a draw passes (Clopper and Pearson) reaches the required one, fail if the upper
/// bound doesn't, and inconclusive between. A check that came to nothing (a value that isn't there, a run
/// that ended early) counts against both: for the lower bound its draw didn't pass, for the upper one it
/// may have. Errors and missing checks never result in a pass.
#[must_use]
pub fn judge(
    ensemble: Option<EnsembleRequirement>,
    counts: VerdictCounts,
    draws: DrawCounts,
) -> (Verdict, String) {
    judge_by(ensemble, counts, draws, &ONCE)
}

/// Bounds of the probability that a draw passes.
#[derive(Clone, Copy, Debug)]
pub struct ClaimBounds {
    /// Lower bound after so many failures in so many draws, with a one-sided confidence.
    pub lower: fn(u64, u64, f64) -> f64,
    /// Upper bound.
    pub upper: fn(u64, u64, f64) -> f64,
    /// Number of looks, each of which has that part of the error.
    pub looks: u64,
    /// How they hold, behind the claim.
    pub words: &'static str,
}

/// Bounds of data that is looked at once.
pub const ONCE: ClaimBounds = ClaimBounds {
    lower: proportion::success_lower_bound,
    upper: proportion::success_upper_bound,
    looks: 1,
    words: "",
};

/// Combines the checks of a requirement as [`judge`] does, by other bounds.
#[must_use]
pub fn judge_by(
    ensemble: Option<EnsembleRequirement>,
    counts: VerdictCounts,
    draws: DrawCounts,
    bounds: &ClaimBounds,
) -> (Verdict, String) {
    let (VerdictCounts { inconclusive, fail, error, missing, .. }, all) = (counts, counts.all());
    if all == 0 {
        return (Verdict::Inconclusive, "no case verifies it".to_owned());
    }
    if error > 0 {
        return (Verdict::Error, format!("{error} of {all} checks ended in an error"));
    }
    let Some(EnsembleRequirement { pass: required, confidence }) = ensemble else {
        let open = inconclusive + missing;
        return if fail > 0 {
            (Verdict::Fail, format!("{fail} of {all} checks failed"))
        } else if open > 0 {
            let told =
                format!("{inconclusive} of {all} checks are inconclusive, {missing} missing");
            (Verdict::Inconclusive, told)
        } else {
            let of = counted(draws.all());
            (Verdict::Pass, format!("all {all} checks passed, of {of}"))
        };
    };
    let DrawCounts { passed, not_passed, unknown, open, .. } = draws;
    let of_look = 1.0 - (1.0 - confidence) / bounds.looks.max(1) as f64;
    let lower = (bounds.lower)(not_passed, draws.known(), of_look);
    // A draw without a result might pass, and one that came to nothing might have: the verdict is fail only
    // if that wouldn't help.
    let upper = (bounds.upper)(draws.failed(), draws.all(), of_look);
    let percent = |p: f64| format!("{:.2} %", 100.0 * p);
    if upper < required {
        let told = format!(
            "{} of {} failed: with {} confidence the probability that a draw passes is at most {}{}, \
             required {}",
            draws.failed(),
            counted(draws.all()),
            percent(confidence),
            percent(upper),
            bounds.words,
            percent(required)
        );
        return (Verdict::Fail, told);
    }
    let mut found = claim(draws, lower, confidence);
    found += &format!("{}, required {}", bounds.words, percent(required));
    if unknown > 0 {
        found += &format!("; {} came to nothing", counted(unknown));
    }
    if open > 0 {
        (Verdict::Inconclusive, format!("{found}; {} without a result", counted(open)))
    } else if passed > 0 && lower >= required {
        (Verdict::Pass, found)
    } else {
        (Verdict::Inconclusive, found)
    }
}

/// Sentence about the result of draws that names its basis: `lower` is the bound at this one-sided
/// confidence.
#[must_use]
pub fn claim(draws: DrawCounts, lower: f64, confidence: f64) -> String {
    let all_of = match draws.rows {
        // Some checks of open draws are missing; and not all checks are those of the draws that passed.
        rows if rows > draws.all() && draws.passed < draws.all() => {
            " in all of their checks".to_owned()
        }
        rows if rows > draws.all() => format!(" in all of their {rows} checks"),
        _ => String::new(),
    };
    // Rounded down, so that the bound isn't overstated.
    let down = (1e4 * lower).floor() / 1e2;
    format!(
        "{} of {} passed{all_of}: with {:.2} % confidence a draw passes with a probability of at \
         least {down:.2} %",
        draws.passed,
        counted(draws.known()),
        100.0 * confidence
    )
}

fn counted(draws: u64) -> String {
    format!("{draws} independent draw{}", if draws == 1 { "" } else { "s" })
}
