//! Combinations: cases that differ only in their instrument and in their draws.
//!
//! All combinations of a replicate have the same instrument, noise and faults. The cases of one
//! combination are therefore independent of each other, those of several aren't, and bounds are
//! given for single combinations only.

use crate::plan::factor_values::FactorValue;
use crate::plan::shared::SharedText;
use crate::plan::{Case, Plan};
use octant_base::number;
use octant_scenario::quantity_of;
use std::collections::HashMap;

/// Scenario with a value of each factor of the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Combination {
    /// Name of the scenario.
    pub scenario: String,
    /// Factors of the grid with their values.
    pub factors: Vec<(String, String)>,
    /// Cases, as places in the plan.
    pub cases: Vec<usize>,
}

impl Combination {
    /// Returns the full name.
    #[must_use]
    pub fn name(&self) -> String {
        let mut name = self.scenario.clone();
        for (factor, value) in &self.factors {
            name += &format!("; {factor} {value}");
        }
        name
    }

    /// Returns the name within its scenario.
    #[must_use]
    pub fn short(&self) -> String {
        let all: Vec<String> =
            self.factors.iter().map(|(factor, value)| format!("{factor} {value}")).collect();
        all.join("; ")
    }
}

/// Renders the value of a factor.
#[must_use]
pub fn shown(value: &FactorValue) -> String {
    match value {
        FactorValue::Number(number) => number::plain(*number, 6),
        FactorValue::Text(text) => text.to_string(),
    }
}

/// Returns the value of a factor as a number; quantities in SI.
#[must_use]
pub fn number_of(value: &FactorValue) -> Option<f64> {
    match value {
        FactorValue::Number(number) => Some(*number),
        FactorValue::Text(text) => quantity_of(text).ok().map(|quantity| quantity.si),
    }
}

/// Lists the factors of which a replicate has several values: those of the grid. Each replicate has
/// one value of the others.
#[must_use]
pub fn of_grid(plan: &Plan) -> Vec<String> {
    // A list: a map of millions of replicates would take several times the memory.
    let mut order: Vec<u32> = (0..).take(plan.cases.len()).collect();
    let case = |index: &u32| plan.cases.get(*index as usize);
    order.sort_unstable_by_key(|index| (case(index).map(|case| case.replicate), *index));
    let is = |factor: &&String| {
        let mut first: Option<(u32, &FactorValue)> = None;
        order.iter().filter_map(case).any(|case| {
            let Some(value) = case.factors.get(factor) else { return false };
            let of_replicate = first.filter(|(replicate, _)| *replicate == case.replicate);
            let (_, of_first) = *first.insert(of_replicate.unwrap_or((case.replicate, value)));
            of_first != value
        })
    };
    plan.factors.iter().filter(is).cloned().collect()
}

/// Lists the combinations of the cases of a plan up to `end`, in the order in which they occur.
#[must_use]
pub fn of(plan: &Plan, end: usize) -> Vec<Combination> {
    let grid = of_grid(plan);
    let mut all: Vec<Combination> = Vec::new();
    let mut place: HashMap<(String, Vec<(String, String)>), usize> = HashMap::new();
    for (index, case) in plan.cases.iter().enumerate().take(end) {
        let factors: Vec<(String, String)> = (grid.iter())
            .filter_map(|name| Some((name.clone(), shown(case.factors.get(name)?))))
            .collect();
        let scenario = case.scenario.to_string();
        let at = *place.entry((scenario.clone(), factors.clone())).or_insert_with(|| {
            all.push(Combination { scenario, factors, cases: Vec::new() });
            all.len() - 1
        });
        all[at].cases.push(index);
    }
    all
}

/// Returns whether a drawn factor has an effect in a case: a factor of a fault that isn't injected
/// has none.
#[must_use]
pub fn takes_part(case: &Case, factor: &str) -> bool {
    let Some(FactorValue::Number(number)) = case.factors.get(factor) else { return true };
    let Some(faults) = &case.faults else { return true };
    // The setting of the factor is the one that contains its number.
    let is_its = |entry: &&SharedText| {
        let value = entry.split_once('=').map_or("", |(_, value)| value).trim_matches('"');
        value.split_whitespace().next().and_then(|n| n.parse().ok()) == Some(*number)
    };
    let key = case.set.iter().find(is_its).and_then(|entry| entry.strip_prefix("faults."));
    let Some(key) = key else { return true };
    faults.iter().any(|fault| key.strip_prefix(fault.as_str()).is_some_and(|k| k.starts_with('.')))
}
