//! The test of a change between two nights.

use octant_nightly::compare::{Change, Thresholds, tested};

fn pairs(
    count: u32,
    one: impl Fn(u32) -> (Option<f64>, Option<f64>),
) -> Vec<(Option<f64>, Option<f64>)> {
    (0..count).map(one).collect()
}

/// Returns a number that looks random.
fn drawn(k: u32) -> f64 {
    1.0 + 0.1 * f64::from((k * 37 + 11) % 101) / 101.0
}

#[test]
fn a_calibration_that_is_refused_now_is_worse_than_any_error() {
    // Six of sixteen are refused, and the others improved slightly.
    let values = pairs(16, |k| (Some(drawn(k)), (k >= 6).then(|| drawn(k) - 1e-6 * drawn(k + 3))));
    let found = tested(&values, 1.0, Thresholds::default()).unwrap();
    assert_eq!((found.pairs, found.lost, found.gained), (16, 6, 0));
    // The refused ones give the direction, but the majority contradicts it: not significant.
    assert_eq!(found.change, Change::Changed);
    let values = pairs(16, |k| (Some(drawn(k)), (k >= 12).then(|| drawn(k))));
    let found = tested(&values, 1.0, Thresholds::default()).unwrap();
    assert_eq!((found.change, found.lost), (Change::Worse, 12));
    // Twelve equal signs: 2 · 2^-12.
    assert!((found.p - 2.0 * 0.5f64.powi(12)).abs() < 1e-12, "{}", found.p);
    // For a margin, less is worse.
    let margin = tested(&values, -1.0, Thresholds::default()).unwrap();
    assert_eq!(margin.change, Change::Worse);
    // A calibration that is published again is better.
    let back: Vec<_> = values.iter().map(|(a, b)| (*b, *a)).collect();
    assert_eq!(tested(&back, 1.0, Thresholds::default()).unwrap().change, Change::Better);
    // If both nights refused, there is no difference, and the pair can't be tested.
    let none = pairs(16, |k| if k < 8 { (None, None) } else { (Some(1.0), Some(1.0)) });
    let found = tested(&none, 1.0, Thresholds::default()).unwrap();
    assert_eq!((found.change, found.pairs, found.lost), (Change::Same, 8, 0));
    assert!(tested(&none[..8], 1.0, Thresholds::default()).is_none());
}
