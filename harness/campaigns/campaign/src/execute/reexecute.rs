//! Runs cases of a campaign again from its folder alone, and extrapolates from a sample to all.

use super::case::{self, ResultError};
use crate::plan::{Case, Plan};
use crate::store::CampaignResults;
use octant_base::control::Control;
use octant_score::numerics::differs;
use serde_json::Value;
use std::path::Path;

/// Confidence of the statement that a sample makes about all results.
pub const CONFIDENCE: f64 = 0.95;

/// Result of running cases again.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Again {
    /// Number of cases with a summary, from which the sample is drawn.
    pub of: usize,
    /// Cases with the same result, to the last bit.
    pub same: usize,
    /// Cases with another result, with the first difference.
    pub differing: Vec<String>,
    /// Cases of another numerics version with another result, as expected.
    pub other_numerics: Vec<String>,
    /// Cases that could not be run again, with the reason.
    pub not_run: Vec<String>,
}

/// Returns the largest number of altered results among `of` that is consistent, at this confidence,
/// with a sample of `sampled` without an altered one: the largest number that would stay undetected
/// with a probability above 1 − `confidence`.
#[must_use]
pub fn altered_at_most(of: usize, sampled: usize, confidence: f64) -> usize {
    let sampled = sampled.min(of);
    // Sampling without replacement: the probability that none of `altered` is in the sample.
    let unseen = |altered: usize| -> f64 {
        if altered > of - sampled {
            return 0.0;
        }
        (0..sampled).map(|i| (of - altered - i) as f64 / (of - i) as f64).product()
    };
    let (mut low, mut high) = (0, of);
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        if unseen(middle) > 1.0 - confidence { low = middle } else { high = middle - 1 }
    }
    low
}

/// Returns the places of the cases of a sample: the first by a hash of seed and id.
#[must_use]
pub fn sample(ids: &[&str], count: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<(blake3::Hash, usize)> = ids
        .iter()
        .enumerate()
        .map(|(index, id)| (blake3::hash(format!("{seed} {id}").as_bytes()), index))
        .collect();
    order.sort_by(|a, b| a.0.as_bytes().cmp(b.0.as_bytes()));
    order.into_iter().take(count).map(|(_, index)| index).collect()
}

/// Runs cases of a campaign again, all or a sample, from the plan and the inputs in its folder.
///
/// # Errors
/// If a result can't be read.
pub fn run(
    plan: &Plan,
    folder: &Path,
    count: Option<usize>,
    seed: u64,
    tell: impl Fn(usize, usize),
) -> Result<Again, ResultError> {
    let results = CampaignResults::open(folder)?;
    let mut there = Vec::new();
    for case in &plan.cases {
        if let Some((result, _)) = results.of_plan(plan, case)?
            && result.summary.is_some()
        {
            there.push(case);
        }
    }
    let ids: Vec<&str> = there.iter().map(|case| case.id.as_str()).collect();
    let drawn = sample(&ids, count.unwrap_or(usize::MAX), seed);
    let mut again = Again { of: there.len(), ..Again::default() };
    for (done, index) in drawn.iter().enumerate() {
        tell(done, drawn.len());
        match one(plan, folder, &results, there[*index]) {
            Ok(None) => again.same += 1,
            Ok(Some((difference, None))) => again.differing.push(difference),
            Ok(Some((difference, Some(told)))) => {
                again.other_numerics.push(format!("{difference}: {told}"));
            }
            Err(reason) => again.not_run.push(reason),
        }
    }
    Ok(again)
}

/// First difference, and the meaning of another numerics version if the stored result has one.
type Differs = (String, Option<String>);

/// Runs one case again; `None` if it has the same result.
fn one(
    plan: &Plan,
    folder: &Path,
    results: &CampaignResults,
    case: &Case,
) -> Result<Option<Differs>, String> {
    let told = |error: &dyn std::fmt::Display| format!("case {}: {error}", case.id);
    let planned = plan.planned(case).map_err(|error| told(&error))?;
    let planned = planned.copied(folder);
    let result = case::run(&planned, case, &Control::default()).map_err(|error| told(&error))?;
    let now = serde_json::to_value(&result).map_err(|error| told(&error))?;
    let stored = results.bytes(&case.id).map_err(|error| told(&error))?;
    let bytes = stored.map(|stored| stored.bytes).unwrap_or_default();
    let then: Value = serde_json::from_slice(&bytes).map_err(|error| told(&error))?;
    let numerics = then["summary"]["numerics"].as_u64().and_then(|version| version.try_into().ok());
    let found = difference(&then["summary"], &now["summary"]);
    Ok(found.map(|what| (told(&what), differs(numerics))))
}

/// Finds the first number or text in which two summaries differ, except for the program that wrote
/// them and fields derived from the numbers.
#[must_use]
pub fn difference(then: &Value, now: &Value) -> Option<String> {
    const NOT_MEASURED: [&str; 7] =
        ["octant", "numerics", "schema", "verdict", "reasons", "requirements", "findings"];
    let (Value::Object(then), Value::Object(now)) = (then, now) else {
        return Some("there is no summary".to_owned());
    };
    let names: std::collections::BTreeSet<&String> = then.keys().chain(now.keys()).collect();
    let measured = names.into_iter().filter(|name| !NOT_MEASURED.contains(&name.as_str()));
    measured
        .filter_map(|name| {
            let of = |all: &serde_json::Map<String, Value>| all.get(name).cloned();
            walk(name, &of(then).unwrap_or_default(), &of(now).unwrap_or_default())
        })
        .next()
}

fn walk(path: &str, then: &Value, now: &Value) -> Option<String> {
    match (then, now) {
        (Value::Object(a), Value::Object(b)) => {
            let names: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            names.into_iter().find_map(|name| {
                let of = |all: &serde_json::Map<String, Value>| all.get(name).cloned();
                let path = format!("{path}.{name}");
                walk(&path, &of(a).unwrap_or_default(), &of(b).unwrap_or_default())
            })
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => a
            .iter()
            .zip(b)
            .enumerate()
            .find_map(|(index, (a, b))| walk(&format!("{path}[{index}]"), a, b)),
        _ if then == now => None,
        (Value::Array(a), Value::Array(b)) => {
            Some(format!("{path} has {} entries, stored are {}", b.len(), a.len()))
        }
        _ => Some(format!("{path} is {now}, stored is {then}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with the probabilities counted one by one, and the textbook's rule of three.
    #[test]
    fn what_a_sample_leaves_unseen_is_bounded() {
        assert_eq!(altered_at_most(100, 100, CONFIDENCE), 0);
        assert_eq!(altered_at_most(10, 0, CONFIDENCE), 10);
        // With 2 of 10 altered, 5 draws miss them with 5·4/(10·9) = 22 %; with 4 altered 2.4 %,
        // with 3 altered 8.3 %.
        assert_eq!(altered_at_most(10, 5, CONFIDENCE), 3);
        // For a large number the bound is about 3/n.
        let bound = altered_at_most(100_000, 300, CONFIDENCE) as f64 / 100_000.0;
        assert!((bound - 3.0 / 300.0).abs() < 1e-4, "{bound}");
        for (of, sampled) in [(20, 3), (50, 7), (60, 59), (7, 6)] {
            let bound = altered_at_most(of, sampled, CONFIDENCE);
            let unseen = |altered: usize| {
                let mut p = 1.0;
                for i in 0..altered {
                    // Computed the other way round: each altered one falls outside of the sample.
                    p *= (of - sampled).saturating_sub(i) as f64 / (of - i) as f64;
                }
                p
            };
            assert!(unseen(bound) > 0.05 && unseen(bound + 1) <= 0.05, "{of} {sampled} {bound}");
        }
    }

    #[test]
    fn a_sample_is_drawn_by_its_seed_and_has_no_case_twice() {
        let ids: Vec<String> = (0..200).map(|i| format!("{i:016x}")).collect();
        let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
        let mut drawn = sample(&ids, 50, 1);
        assert_eq!(drawn, sample(&ids, 50, 1));
        assert_ne!(drawn, sample(&ids, 50, 2));
        drawn.sort_unstable();
        drawn.dedup();
        assert_eq!(drawn.len(), 50);
        assert_eq!(sample(&ids, 1000, 1).len(), 200);
    }
}
