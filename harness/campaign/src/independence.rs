//! Groups cases into independent draws, and finds parts of a design without effect.
//!
//! A seed is an instrument with its noise: all of its combinations are one draw. Cases with the
//! same stream of samples are one draw too, whatever their seeds; they are the same run, repeated
//! under the label of a factor without effect or of a value in another spelling.

use super::factor_values::FactorValue;
use super::facts::CaseFacts;
use super::plan::{Case, Plan};
use super::report::combination::of_grid;
use octant_statistics::cluster;
use std::collections::{BTreeMap, HashMap};

/// Evidence of a case for a requirement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// True if the requirement was met in a run that completed its plan.
    pub passed: bool,
    /// Hash of the stream; `None` for a case without a summary.
    pub stream: Option<String>,
}

impl Shown {
    /// Extracts a result's evidence for a requirement. Everything except a pass counts as not
    /// passed: a check that failed or was inconclusive, a refused calibration, an error.
    #[must_use]
    pub fn of(facts: &CaseFacts, requirement: &str) -> Self {
        let stream = facts.stream().map(str::to_owned);
        Self { passed: facts.passes(requirement), stream }
    }
}

/// Returns the independent draw of each case, numbered from 0, from its seed and its stream.
#[must_use]
pub fn draws<'a, H: Ord>(cases: impl IntoIterator<Item = (&'a Case, Option<H>)>) -> Vec<usize> {
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
    let mut by_stream: Vec<usize> = (0..run.len()).collect();
    by_stream.sort_unstable_by_key(|index| (run[*index].1, *index));
    let same = by_stream.chunk_by(|a, b| run[*a].1 == run[*b].1);
    let mut repeated: Vec<&[usize]> = same.filter(|all| all.len() > 1).collect();
    repeated.sort();
    let ids = |all: &[usize]| all.iter().map(|index| run[*index].0.id.to_string()).collect();
    Idle {
        repeated: repeated.into_iter().map(ids).collect(),
        factors: (of_grid(plan).into_iter())
            .filter(|factor| changes_nothing(factor, &run))
            .collect(),
    }
}

/// Returns whether all cases that differ in this factor alone have the same streams. Cases are
/// compared within a scenario and a seed, where nothing else differs.
fn changes_nothing<H: PartialEq + Copy>(factor: &str, run: &[(&Case, H)]) -> bool {
    type Others<'a> = (&'a str, u64, BTreeMap<&'a str, String>);
    let shown = |value: &FactorValue| format!("{value:?}");
    let mut first: HashMap<Others<'_>, H> = HashMap::new();
    let mut compared = false;
    for (case, stream) in run {
        if case.factors.get(factor).is_none() {
            continue;
        }
        let others = case.factors.iter().filter(|(name, _)| *name != factor);
        let others = others.map(|(name, value)| (name, shown(value))).collect();
        match first.entry((case.scenario.as_str(), case.seed, others)) {
            std::collections::hash_map::Entry::Vacant(entry) => _ = entry.insert(*stream),
            std::collections::hash_map::Entry::Occupied(entry) if entry.get() == stream => {
                compared = true;
            }
            std::collections::hash_map::Entry::Occupied(_) => return false,
        }
    }
    compared
}
