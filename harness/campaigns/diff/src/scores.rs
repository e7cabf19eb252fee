//! Numbers of two summaries, side by side.

use octant_score::summary::Summary;
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Score of two runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScoreDiff {
    /// Path of the score in `summary.json`; its unit is the name's suffix.
    pub score: String,
    /// Value in the first run; null where it has none.
    pub first: Option<f64>,
    /// Value in the second run.
    pub second: Option<f64>,
    /// Second minus first; null unless both have it.
    pub difference: Option<f64>,
}

impl ScoreDiff {
    /// Returns whether both runs have the same value, to the last bit.
    #[must_use]
    pub fn is_equal(&self) -> bool {
        self.first.map(f64::to_bits) == self.second.map(f64::to_bits)
    }
}

/// Estimate of a parameter in two runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterDiff {
    /// Name of the parameter.
    pub parameter: String,
    /// Unit.
    pub unit: String,
    /// Estimate in the first run.
    pub first: f64,
    /// Estimate in the second run.
    pub second: f64,
    /// Second minus first.
    pub difference: f64,
    /// Difference divided by the root of the sum of both variances. Runs of one instrument with independent noise
    /// are within ±2 with 95 %; runs with the same noise are closer. Null where a run has no σ.
    pub in_sigma: Option<f64>,
}

/// Parts of a summary with scores.
const PARTS: [&str; 4] = ["calibration", "navigation", "baseline", "counterfactual"];

/// Lists the scores of both summaries; parameters are compared on their own.
pub(crate) fn compare(first: Option<&Summary>, second: Option<&Summary>) -> Vec<ScoreDiff> {
    let (Some(first), Some(second)) = (first, second) else { return Vec::new() };
    let [of_first, of_second] = [first, second].map(numbers);
    let names: BTreeSet<&String> = of_first.keys().chain(of_second.keys()).collect();
    names
        .into_iter()
        .map(|name| {
            let (first, second) = (of_first.get(name).copied(), of_second.get(name).copied());
            let difference = first.zip(second).map(|(first, second)| second - first);
            ScoreDiff { score: name.clone(), first, second, difference }
        })
        .collect()
}

fn numbers(summary: &Summary) -> BTreeMap<String, f64> {
    let mut all = BTreeMap::new();
    let Ok(document) = serde_json::to_value(summary) else { return all };
    for part in PARTS {
        walk(part, &document[part], &mut all);
    }
    all
}

fn walk(path: &str, value: &Value, all: &mut BTreeMap<String, f64>) {
    match value {
        // Values and σ of parameters are in a table of their own; series are plotted.
        Value::Object(parts) if !path.ends_with(".parameters") => {
            for (name, part) in parts {
                walk(&format!("{path}.{name}"), part, all);
            }
        }
        Value::Number(number) => {
            all.extend(number.as_f64().map(|number| (path.to_owned(), number)));
        }
        _ => {}
    }
}

/// Lists the parameters that both summaries have.
pub(crate) fn parameters(first: Option<&Summary>, second: Option<&Summary>) -> Vec<ParameterDiff> {
    let of = |summary: Option<&Summary>| {
        summary.and_then(|summary| summary.calibration.as_ref()).map(|c| c.parameters.clone())
    };
    let (Some(first), Some(second)) = (of(first), of(second)) else { return Vec::new() };
    let pairs = first.iter().filter_map(|(name, first)| Some((name, first, second.get(name)?)));
    pairs
        .map(|(name, first, second)| {
            let difference = second.estimate - first.estimate;
            let spread = first.sigma.zip(second.sigma).map(|(a, b)| (a * a + b * b).sqrt());
            ParameterDiff {
                parameter: name.clone(),
                unit: first.unit.clone(),
                first: first.estimate,
                second: second.estimate,
                difference,
                in_sigma: spread.filter(|spread| *spread > 0.0).map(|spread| difference / spread),
            }
        })
        .collect()
}
