//! When enough is known: a requirement is shown, or shown not to hold, before every case has run.
//!
//! It is looked at after every so many cases of the plan, in its order, so that it ends at the same case
//! wherever the cases ran. Who looks K times has K chances to see what isn't there: each look has a K-th of
//! the error that is allowed (Bonferroni), so that all together keep the confidence.

use super::plan::{Case, Plan, StopRule};
use crate::score::verdict::Verdict;
use octant_statistics::proportion::Demand;

/// Where a campaign stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// The requirement is kept with the probability and the confidence that are asked for.
    Shown {
        /// Cases of the plan up to there.
        end: usize,
    },
    /// It isn't.
    Refuted {
        /// Cases of the plan up to there.
        end: usize,
    },
    /// Nothing is shown by the cases that have a result; the next look is at this many.
    Open {
        /// Cases of the plan up to there.
        next: usize,
    },
}

impl Decision {
    /// Cases of the plan that count, of so many.
    #[must_use]
    pub fn end(self, cases: usize) -> usize {
        match self {
            Self::Shown { end } | Self::Refuted { end } => end,
            Self::Open { .. } => cases,
        }
    }
}

/// Looks at the cases in the order of the plan, as far as they have a result. `check` gives the verdict of
/// the requirement in a case that has run.
#[must_use]
pub fn decide(plan: &Plan, rule: &StopRule, check: impl Fn(&Case) -> Option<Verdict>) -> Decision {
    let every = usize::try_from(rule.every).unwrap_or(usize::MAX).max(1);
    let looks = plan.cases.len().div_ceil(every).max(1);
    let confidence = 1.0 - (1.0 - rule.demand.confidence) / looks as f64;
    let demand = Demand { confidence, ..rule.demand };
    let checks = |scenario: &str| {
        let found = plan.scenarios.iter().find(|planned| planned.id == scenario);
        found.is_some_and(|planned| planned.requirements.contains(&rule.requirement))
    };
    let (mut runs, mut failures) = (0, 0);
    for (index, case) in plan.cases.iter().enumerate() {
        let end = index + 1;
        if checks(&case.scenario) {
            let next = end.div_ceil(every).saturating_mul(every).min(plan.cases.len());
            let Some(verdict) = check(case) else { return Decision::Open { next } };
            runs += 1;
            // What isn't shown to be kept counts as broken.
            failures += u64::from(verdict != Verdict::Pass);
        }
        if end % every == 0 || end == plan.cases.len() {
            if demand.is_shown(failures, runs) {
                return Decision::Shown { end };
            }
            if demand.is_refuted(failures, runs) {
                return Decision::Refuted { end };
            }
        }
    }
    Decision::Open { next: plan.cases.len() }
}
