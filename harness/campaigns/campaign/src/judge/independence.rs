//! Groups cases into independent draws, and finds parts of a design without effect.
//!
//! A seed is an instrument with its noise: all of its combinations are one draw. Cases with the
//! same stream of samples are one draw too, whatever their seeds; they are the same run, repeated
//! under the label of a factor without effect or of a value in another spelling.

use crate::plan::factor_values::FactorValue;
use crate::plan::{Case, Plan};
use crate::report::combination::of_grid;
use crate::store::facts::CaseFacts;
use octant_statistics::cluster::{self, RowResult};
use std::collections::{BTreeMap, HashMap};

/// Evidence of a case for a requirement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Whether the requirement was met in a run that completed its plan.
    pub result: RowResult,
    /// Hash of the stream; `None` for a case without a summary.
    pub stream: Option<String>,
}

impl Shown {
    /// Extracts a result's evidence for a requirement. A check without a value, a run that is no evidence
    /// and an error come to nothing: they show neither that it is met nor that it isn't.
    #[must_use]
    pub fn of(facts: &CaseFacts, requirement: &str) -> Self {
        let stream = facts.stream().map(str::to_owned);
        Self { result: facts.shows(requirement), stream }
    }
}

/// Returns the independent draw of each case, numbered from 0, from its seed and its stream.
#[must_use]
pub fn draws<'a, H: Ord>(cases: impl IntoIterator<Item = (&'a Case, Option<H>)>) -> Vec<u32> {
    cluster::draws(cases.into_iter().map(|(case, stream)| (case.seed, stream)))
}

/// Parts of a design without effect.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Idle {
    /// Cases with the same stream, grouped by it, in the order of the plan.
    pub repeated: Vec<Vec<String>>,
    /// Factors of the grid none of whose values changed a stream.
    pub factors: Vec<String>,
}

/// Finds cases that are the same run, and factors without effect.
#[must_use]
pub fn idle<'a, H: Ord + Copy>(
    plan: &Plan,
    cases: impl IntoIterator<Item = (&'a Case, Option<H>)>,
) -> Idle {
    let run: Vec<(&Case, H)> =
        cases.into_iter().filter_map(|(case, stream)| Some((case, stream?))).collect();
    // A plan has at most ten million cases. Lists: maps of so many would take several times the memory.
    let mut order: Vec<u32> = (0..).take(run.len()).collect();
    let stream = |index: &u32| run[*index as usize].1;
    order.sort_unstable_by_key(|index| (stream(index), *index));
    let same = order.chunk_by(|a, b| stream(a) == stream(b));
    let mut repeated: Vec<&[u32]> = same.filter(|all| all.len() > 1).collect();
    repeated.sort();
    let id = |index: &u32| run[*index as usize].0.id.to_string();
    let repeated = repeated.into_iter().map(|all| all.iter().map(id).collect()).collect();
    order.sort_unstable_by_key(|index| (run[*index as usize].0.seed, *index));
    Idle {
        repeated,
        factors: (of_grid(plan).into_iter())
            .filter(|factor| changes_nothing(factor, &run, &order))
            .collect(),
    }
}

/// Returns whether all cases that differ in this factor alone have the same streams. Cases are
/// compared within a scenario and a seed, where nothing else differs. `by_seed` is their order by the seed.
fn changes_nothing<H: PartialEq + Copy>(factor: &str, run: &[(&Case, H)], by_seed: &[u32]) -> bool {
    type Others<'a> = (&'a str, BTreeMap<&'a str, String>);
    let shown = |value: &FactorValue| format!("{value:?}");
    let mut first: HashMap<Others<'_>, H> = HashMap::new();
    let mut seed = None;
    let mut compared = false;
    for (case, stream) in by_seed.iter().map(|index| &run[*index as usize]) {
        if case.factors.get(factor).is_none() {
            continue;
        }
        if seed.replace(case.seed) != Some(case.seed) {
            first.clear();
        }
        let others = case.factors.iter().filter(|(name, _)| *name != factor);
        let others = others.map(|(name, value)| (name, shown(value))).collect();
        match first.entry((case.scenario.as_str(), others)) {
            std::collections::hash_map::Entry::Vacant(entry) => _ = entry.insert(*stream),
            std::collections::hash_map::Entry::Occupied(entry) if entry.get() == stream => {
                compared = true;
            }
            std::collections::hash_map::Entry::Occupied(_) => return false,
        }
    }
    compared
}
