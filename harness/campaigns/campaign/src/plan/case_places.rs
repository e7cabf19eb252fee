//! Places of cases in a plan by their ids.

use super::case_id::CaseId;
use crate::plan::{Case, Plan};

/// Places of the cases of a plan by their ids: a sorted list, as a map of millions of cases would take ten
/// times the memory.
#[derive(Debug)]
pub(crate) struct CasePlaces<'a> {
    cases: &'a [Case],
    /// Places in the order of the ids.
    order: Vec<u32>,
}

impl<'a> CasePlaces<'a> {
    pub(crate) fn of(plan: &'a Plan) -> Self {
        let cases = plan.cases.as_slice();
        let mut order: Vec<u32> = (0..).take(cases.len()).collect();
        // The last case with an id counts.
        order.sort_unstable_by_key(|at| (cases[*at as usize].id, u32::MAX - at));
        Self { cases, order }
    }

    /// Returns the place of a case; `None` if the plan doesn't have it.
    pub(crate) fn get(&self, id: &str) -> Option<usize> {
        let id: CaseId = id.parse().ok()?;
        let case = |at: &u32| self.cases.get(*at as usize);
        let from = self.order.partition_point(|at| case(at).is_some_and(|case| case.id < id));
        let found = self.order.get(from).filter(|at| case(at).is_some_and(|case| case.id == id))?;
        Some(*found as usize)
    }
}
