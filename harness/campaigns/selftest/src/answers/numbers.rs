//! Numbers of a group: the computed ones, and the expected ones of `fixtures/golden`.

use crate::judge::Known;
use serde_json::Value;
use std::collections::BTreeMap;

const GOLDEN: &str = include_str!("../../../../../fixtures/golden/answers.json");

/// Numbers computed by a group, by name.
pub(super) type Found = BTreeMap<String, f64>;

/// Reads the expected numbers of a group, as written by `answers.py`.
pub(super) fn known(group: &str) -> Vec<Known> {
    let golden: Value = serde_json::from_str(GOLDEN).unwrap_or_default();
    let all = golden[group].as_object().into_iter().flatten();
    all.filter_map(|(name, of)| {
        let of = |at: usize| of[at].as_f64();
        Some(tight(name, of(0)?, of(1)?, of(2)?))
    })
    .collect()
}

/// Reads an input of a group that `answers.py` has chosen.
pub(super) fn input(name: &str) -> Option<f64> {
    let golden: Value = serde_json::from_str(GOLDEN).ok()?;
    golden["inputs"][name].as_f64()
}

/// Builds a known number whose tolerance combines a relative and an absolute part, and is at least
/// four units of its last place.
pub(super) fn tight(name: &str, value: f64, relative: f64, absolute: f64) -> Known {
    let rounding = 4.0 * f64::EPSILON * value.abs();
    let tolerance = (relative * value.abs() + absolute).max(rounding).max(f64::MIN_POSITIVE);
    Known { name: name.to_owned(), value, tolerance }
}
