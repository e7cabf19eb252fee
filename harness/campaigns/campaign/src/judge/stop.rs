//! Early stopping: a requirement is shown, or refuted, before every case has run.
//!
//! The rule is evaluated after a fixed number of cases of the plan, in its order, so that it stops
//! at the same case wherever the cases ran. The unit is the independent draw, each with all of its
//! cases. With K evaluations there are K chances of a false conclusion, so each evaluation gets a
//! K-th of the allowed error (Bonferroni), and all together keep the confidence.

use super::independence::Shown;
use crate::plan::looks::at_each_of;
use crate::plan::{Case, Plan, StopRule};
use octant_statistics::cluster::{Growing, RowResult};
use std::collections::HashMap;

/// Decision about the rest of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopDecision {
    /// The requirement is met with the required probability and confidence.
    Shown {
        /// Number of cases of the plan up to the decision.
        end: usize,
    },
    /// The requirement isn't met.
    Refuted {
        /// Number of cases of the plan up to the decision.
        end: usize,
    },
    /// The cases with a result don't decide yet; the next evaluation is at `next` cases.
    Open {
        /// Number of cases of the plan up to the next evaluation.
        next: usize,
    },
}

impl StopDecision {
    /// Returns how many of `cases` cases of the plan count.
    #[must_use]
    pub fn end(self, cases: usize) -> usize {
        match self {
            Self::Shown { end } | Self::Refuted { end } => end,
            Self::Open { .. } => cases,
        }
    }
}

/// Evaluates the cases in the order of the plan, as far as they have a result. `shown` returns the
/// evidence of a case that has run. A draw counts when all of its cases are there; until then it
/// counts neither as passed nor as failed, because counting failures early would make them look
/// more frequent than they are.
#[must_use]
pub fn decide(
    plan: &Plan,
    rule: &StopRule,
    shown: impl Fn(&Case) -> Option<Shown>,
) -> StopDecision {
    let every = usize::try_from(rule.every).unwrap_or(usize::MAX).max(1);
    let demand = at_each_of(rule.demand, rule.looks(plan.cases.len()));
    let checks = |scenario: &str| {
        let found = plan.scenarios.iter().find(|planned| planned.id == scenario);
        found.is_some_and(|planned| planned.requirements.contains(&rule.requirement))
    };
    // Place of the last case of each seed: before it the draw isn't complete.
    let mut last: HashMap<u64, usize> = HashMap::new();
    let checking = || plan.cases.iter().enumerate().filter(|(_, case)| checks(&case.scenario));
    checking().for_each(|(index, case)| _ = last.insert(case.seed, index));
    let mut begun: HashMap<u64, Vec<(RowResult, Option<String>)>> = HashMap::new();
    let mut draws = Growing::default();
    for (index, case) in plan.cases.iter().enumerate() {
        let end = index + 1;
        if checks(&case.scenario) {
            let next = end.div_ceil(every).saturating_mul(every).min(plan.cases.len());
            let Some(Shown { result, stream }) = shown(case) else {
                return StopDecision::Open { next };
            };
            begun.entry(case.seed).or_default().push((result, stream));
            if last.get(&case.seed) == Some(&index) {
                draws.add(begun.remove(&case.seed).unwrap_or_default());
            }
        }
        if end % every == 0 || end == plan.cases.len() {
            let counts = draws.counts();
            if demand.is_shown(counts.not_passed, counts.known()) {
                return StopDecision::Shown { end };
            }
            // A draw that came to nothing may have passed.
            if demand.is_refuted(counts.failed(), counts.known()) {
                return StopDecision::Refuted { end };
            }
        }
    }
    StopDecision::Open { next: plan.cases.len() }
}
