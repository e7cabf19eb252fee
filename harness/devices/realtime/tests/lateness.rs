//! Histograms of lateness.

use octant_realtime::lateness::{LARGEST_NS, LatenessHistogram};
use proptest::prelude::*;

#[test]
fn nothing_is_late_where_nothing_was() {
    let figures = LatenessHistogram::new().figures();
    assert_eq!((figures.count, figures.p99_us, figures.max_us), (0, 0.0, 0.0));
    assert!(LatenessHistogram::new().rows().is_empty());
}

#[test]
fn longer_than_a_minute_counts_as_one_and_the_largest_is_exact() {
    let mut lateness = LatenessHistogram::new();
    lateness.record(u64::MAX);
    assert_eq!(lateness.max_ns(), u64::MAX);
    assert_eq!(lateness.count(), 1);
    let near = lateness.quantile_ns(0.5) as f64 / LARGEST_NS as f64;
    assert!((1.0..1.15).contains(&near), "{near}");
}

proptest! {
    #[test]
    fn quantiles_are_those_of_the_sorted_values(
        mut values in prop::collection::vec(0u64..2_000_000_000, 1..400),
        share in 0.0f64..=1.0,
    ) {
        let mut lateness = LatenessHistogram::new();
        let mut halves = [LatenessHistogram::new(), LatenessHistogram::new()];
        for (index, value) in values.iter().enumerate() {
            lateness.record(*value);
            halves[index % 2].record(*value);
        }
        values.sort_unstable();
        let rank = ((share * values.len() as f64).ceil() as usize).clamp(1, values.len());
        let expected = values[rank - 1] as f64;
        let found = lateness.quantile_ns(share) as f64;
        prop_assert!((found - expected).abs() <= 1e-3 * expected + 1.0, "{found} {expected}");
        prop_assert_eq!(lateness.max_ns(), values[values.len() - 1]);
        let total: u64 = lateness.rows().iter().map(|(_, count)| count).sum();
        prop_assert_eq!(total, values.len() as u64);
        prop_assert!(lateness.rows().windows(2).all(|two| two[0].0 < two[1].0));
        let [mut one, other] = halves;
        one.add(&other);
        prop_assert_eq!(one.figures(), lateness.figures());
    }
}
