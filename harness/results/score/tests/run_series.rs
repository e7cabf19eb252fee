//! Series of bounded length keep every extreme.

use octant_score::run_series::{COLUMNS, STRETCHES_MAX, SolutionSeries};

#[test]
fn a_long_series_stays_short_and_keeps_a_lone_spike() {
    let mut series = SolutionSeries::default();
    for k in 0..1_000_000u32 {
        let spike = if k == 777_777 { -9.0 } else { 0.5 };
        series.push(f64::from(k) / 3600.0, [spike, 0.0, f64::NAN, f64::from(k), 1.0]);
    }
    let points = series.points(0);
    assert!(points.len() <= 2 * STRETCHES_MAX, "{}", points.len());
    let spike = points.iter().find(|p| p[1] == -9.0).copied().unwrap_or_default();
    assert!((spike[0] - 777_777.0 / 3600.0).abs() < 1024.0 / 3600.0, "{spike:?}");
    assert!(series.points(2).is_empty());
    let last = series.points(3).last().copied().unwrap_or_default();
    assert_eq!(last[1], 999_999.0);
}

#[test]
fn a_short_series_is_kept_whole() {
    let mut series = SolutionSeries::default();
    for k in 0..100u32 {
        series.push(f64::from(k), [f64::from(k); COLUMNS]);
    }
    assert_eq!(series.points(4).len(), 100);
}
