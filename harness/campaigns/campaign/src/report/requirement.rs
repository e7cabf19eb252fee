//! Figures of each requirement over the cases: overall, by combination, and in the order of the
//! cases.

use super::combination::Combination;
use super::figures::CONFIDENCE;
use super::rows::{ReportRow, ReportRows, RowOutcome};
use crate::judge::status::{CampaignStatus, RequirementStatus};
use crate::plan::Plan;
use crate::store::facts::row_result;
use octant_score::verdict::RequirementResult;
use octant_statistics::cluster::{DrawCounts, DrawTally, RowResult};
use octant_statistics::convergence::{ConvergenceStep, convergence, pass};
use octant_statistics::proportion::{Demand, Needed, further_at_rate, success_lower_bound};
use octant_verdict::Verdict;
use octant_verdict::requirement::{EnsembleRequirement, Requirements};
use octant_verdict::trace::{VerdictCounts, claim};
use serde::Serialize;

/// Figures of a requirement over the cases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RequirementFigures {
    /// Id.
    pub id: String,
    /// Text; null if its file isn't there, or was changed.
    pub text: Option<String>,
    /// Document and clause of origin.
    pub clause: Option<String>,
    /// Measure; null if no case checks it.
    pub measure: Option<String>,
    /// Comparison of the measure with the limit.
    pub comparison: Option<&'static str>,
    /// The limit, in the unit of the measure.
    pub limit: Option<f64>,
    /// True if the limit is multiplied by the secant of the latitude of each case.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub secant_latitude: bool,
    /// Overall verdict.
    pub verdict: Verdict,
    /// Reason.
    pub reason: String,
    /// Checks.
    pub counts: VerdictCounts,
    /// Independent draws: one passes if all of its checks did.
    pub draws: DrawCounts,
    /// Result of the draws, as a sentence; null if none is known.
    pub claim: Option<String>,
    /// Requirement on all cases together; null if every case must pass.
    pub asked: Option<EnsembleRequirement>,
    /// Confidence of the lower bound, one-sided: the required one, or 95 %.
    pub confidence: f64,
    /// Lower bound of the probability that a draw passes (of Clopper and Pearson, or the open one; with several looks at
    /// each of them, so that all keep the confidence); null where none is known.
    pub lower_bound: Option<f64>,
    /// Further draws that suffice if all of them pass; null if nothing is required of them
    /// together.
    pub needed_if_all_pass: Option<Needed>,
    /// Further draws that suffice if they fail at the present rate.
    pub needed_at_rate: Option<Needed>,
    /// Case that came nearest to the limit, or farthest beyond it.
    pub nearest: Option<Nearest>,
    /// Convergence of the probability that a draw passes, with two-sided bounds of 95 %.
    pub convergence: Vec<ConvergenceStep>,
    /// Parts by combination, in their order.
    pub combinations: Vec<CombinationChecks>,
}

/// Case with the least margin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Nearest {
    /// The case.
    pub case: String,
    /// The measure.
    pub value: f64,
    /// Margin to the limit, negative if the limit is exceeded.
    pub margin: f64,
}

/// The checks of one combination.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CombinationChecks {
    /// Checks.
    pub counts: VerdictCounts,
    /// Independent draws.
    pub draws: DrawCounts,
    /// Lower bound of the probability that a draw of it passes; null if none is known.
    pub lower_bound: Option<f64>,
}

fn bound(draws: DrawCounts, confidence: f64) -> Option<f64> {
    (draws.known() > 0).then(|| success_lower_bound(draws.not_passed, draws.known(), confidence))
}

/// Verdicts of the cases that check a requirement, by check and by draw.
#[derive(Default)]
struct Counted {
    counts: VerdictCounts,
    draws: DrawTally,
}

impl Counted {
    fn of<'a>(plan: &Plan, id: &str, rows: impl Iterator<Item = (usize, ReportRow<'a>)>) -> Self {
        let mut counted = Self::default();
        for (draw, row) in rows {
            if !checks(plan, &row.case.scenario, id) {
                continue;
            }
            let counts = &mut counted.counts;
            *match row.outcome.as_ref().map(|outcome| outcome.check(id)) {
                None => &mut counts.missing,
                Some(Verdict::Pass) => &mut counts.pass,
                Some(Verdict::None | Verdict::Inconclusive) => &mut counts.inconclusive,
                Some(Verdict::Fail) => &mut counts.fail,
                Some(Verdict::Error) => &mut counts.error,
            } += 1;
            let result = |outcome: &RowOutcome| row_result(outcome.check(id), outcome.besides);
            counted.draws.add(draw, row.outcome.as_ref().map_or(RowResult::Open, result));
        }
        counted
    }

    fn draws(&self) -> DrawCounts {
        self.draws.counts()
    }

    /// Returns whether each known draw passed, in the order in which they began.
    fn passed(&self) -> Vec<bool> {
        let known = self.draws.results().filter(|result| *result != RowResult::Open);
        known.map(|result| result == RowResult::Passed).collect()
    }
}

/// Returns whether the cases of a scenario check a requirement.
pub fn checks(plan: &Plan, scenario: &str, id: &str) -> bool {
    let planned = plan.scenarios.iter().find(|planned| planned.id == scenario);
    planned.is_some_and(|planned| planned.requirements.iter().any(|own| own == id))
}

/// Computes the figures of each requirement, in the order of the ids.
pub(super) fn of(
    plan: &Plan,
    status: &CampaignStatus,
    about: &Requirements,
    combinations: &[Combination],
    rows: &ReportRows<'_>,
    draws: &[u32],
) -> Vec<RequirementFigures> {
    status
        .requirements
        .iter()
        .map(|(id, found)| {
            one(plan, id, (found, status.looks.is_open()), about, combinations, rows, draws)
        })
        .collect()
}

fn one(
    plan: &Plan,
    id: &str,
    (status, is_open): (&RequirementStatus, bool),
    about: &Requirements,
    combinations: &[Combination],
    rows: &ReportRows<'_>,
    draws: &[u32],
) -> RequirementFigures {
    let results = || {
        rows.iter().filter_map(|row| {
            let mut checks = row.outcome?.checks.into_iter();
            Some((row.case, checks.find(|check| check.id == id)?))
        })
    };
    let planned = plan.requirements.iter().find(|planned| planned.check.id == id);
    let first: Option<RequirementResult> = results().next().map(|(_, result)| result);
    let secant_latitude = match (planned, &first) {
        (Some(planned), _) => planned.check.secant_latitude,
        (None, first) => first.as_ref().is_some_and(|result| result.at_equator.is_some()),
    };
    let (measure, comparison, limit) = match (planned, first) {
        (Some(planned), _) => {
            let check = &planned.check;
            (Some(check.measure.clone()), Some(check.comparison.sign()), Some(check.limit))
        }
        (None, Some(result)) => {
            let limit = result.written_limit();
            (Some(result.measure), Some(result.comparison.sign()), Some(limit))
        }
        (None, None) => (None, None, None),
    };
    let all = Counted::of(plan, id, draws.iter().map(|draw| *draw as usize).zip(rows.iter()));
    // Draws that were added after the first look are no part of a claim.
    let counted = if status.ensemble.is_some() { status.draws } else { all.draws() };
    let lower = status.bound.or_else(|| bound(counted, CONFIDENCE));
    let confidence = status.ensemble.map_or(CONFIDENCE, |asked| asked.confidence);
    let nearest = results()
        .filter_map(|(case, result)| {
            let (value, margin) = (result.value?, result.margin?);
            Some((case, value, margin))
        })
        .min_by(|a, b| a.2.total_cmp(&b.2))
        .map(|(case, value, margin)| Nearest { case: case.id.to_string(), value, margin });
    let own = about.get(id);
    RequirementFigures {
        id: id.to_owned(),
        text: own.map(|own| own.text.clone()).filter(|text| !text.is_empty()),
        clause: own.and_then(|own| own.clause.clone()),
        measure,
        comparison,
        limit,
        secant_latitude,
        verdict: status.verdict,
        reason: status.reason.clone(),
        counts: all.counts,
        draws: counted,
        claim: lower.map(|lower| claim(counted, lower, confidence)),
        asked: status.ensemble,
        confidence,
        lower_bound: lower,
        needed_if_all_pass: status.needed,
        needed_at_rate: status.ensemble.filter(|_| !is_open).map(
            |EnsembleRequirement { pass, confidence }| {
                further_at_rate(Demand { pass, confidence }, counted.not_passed, counted.known())
            },
        ),
        nearest,
        convergence: convergence(&all.passed(), |passed| pass(passed, CONFIDENCE)),
        combinations: (combinations.iter())
            .map(|combination| {
                let cases = combination.cases.iter().copied();
                let draws =
                    cases.clone().filter_map(|case| draws.get(case).map(|draw| *draw as usize));
                let mine = Counted::of(plan, id, draws.zip(rows.at(cases)));
                let draws = mine.draws();
                CombinationChecks {
                    counts: mine.counts,
                    draws,
                    lower_bound: bound(draws, confidence),
                }
            })
            .collect(),
    }
}
