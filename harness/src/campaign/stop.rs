//! When enough is known: a requirement is shown, or shown not to hold, before every case has run.
//!
//! It is looked at after every so many cases of the plan, in its order, so that it ends at the same case
//! wherever the cases ran. What counts are independent draws, each with all of its cases. Who looks K times has K chances to see what isn't there: each look has a K-th of
//! the error that is allowed (Bonferroni), so that all together keep the confidence.

use super::independence::Shown;
use super::plan::{Case, Plan, StopRule};
use octant_statistics::cluster::Growing;
use octant_statistics::proportion::Demand;
use std::collections::HashMap;

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

/// Looks at the cases in the order of the plan, as far as they have a result. `shown` gives what a case that
/// has run shows of the requirement. A draw counts when all of its cases are there; one that passed in some
/// of them so far counts as nothing yet, and neither does one that didn't: to count it early would make
/// failures look more frequent than they are.
#[must_use]
pub fn decide(plan: &Plan, rule: &StopRule, shown: impl Fn(&Case) -> Option<Shown>) -> Decision {
    let every = usize::try_from(rule.every).unwrap_or(usize::MAX).max(1);
    let looks = plan.cases.len().div_ceil(every).max(1);
    let confidence = 1.0 - (1.0 - rule.demand.confidence) / looks as f64;
    let demand = Demand { confidence, ..rule.demand };
    let checks = |scenario: &str| {
        let found = plan.scenarios.iter().find(|planned| planned.id == scenario);
        found.is_some_and(|planned| planned.requirements.contains(&rule.requirement))
    };
    // Where the last case of each seed stands: before that its draw isn't whole.
    let mut last: HashMap<u64, usize> = HashMap::new();
    let checking = || plan.cases.iter().enumerate().filter(|(_, case)| checks(&case.scenario));
    checking().for_each(|(index, case)| _ = last.insert(case.seed, index));
    let mut begun: HashMap<u64, Vec<(bool, Option<String>)>> = HashMap::new();
    let mut draws = Growing::default();
    for (index, case) in plan.cases.iter().enumerate() {
        let end = index + 1;
        if checks(&case.scenario) {
            let next = end.div_ceil(every).saturating_mul(every).min(plan.cases.len());
            let Some(Shown { passed, stream }) = shown(case) else {
                return Decision::Open { next };
            };
            begun.entry(case.seed).or_default().push((passed, stream));
            if last.get(&case.seed) == Some(&index) {
                draws.add(begun.remove(&case.seed).unwrap_or_default());
            }
        }
        if end % every == 0 || end == plan.cases.len() {
            let counts = draws.counts();
            if demand.is_shown(counts.not_passed, counts.known()) {
                return Decision::Shown { end };
            }
            if demand.is_refuted(counts.not_passed, counts.known()) {
                return Decision::Refuted { end };
            }
        }
    }
    Decision::Open { next: plan.cases.len() }
}
