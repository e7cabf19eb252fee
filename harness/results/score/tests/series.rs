//! Series for plots keep their extremes.

use octant_score::series::{BUCKETS_MAX, ErrorSeries};

#[test]
fn a_series_of_a_million_points_stays_short_and_keeps_its_extremes() {
    let mut series = ErrorSeries::new();
    for k in 0..1_000_000u32 {
        let t = f64::from(k) / 3600.0;
        let spike = if k == 777_777 { 9.0 } else { 0.0 };
        series.push([t, libm::sin(t), libm::cos(3.0 * t) - spike]);
    }
    let points = series.points();
    assert!(points.len() <= 2002, "{}", points.len());
    assert_eq!(points[0][0], 0.0);
    assert_eq!(points[points.len() - 1][0], 277.7775);
    assert!(points.iter().any(|p| p[2] < -8.0), "the spike is lost");
    assert!(points.windows(2).all(|w| w[0][0] < w[1][0]));
}

#[test]
fn a_short_series_is_kept_whole() {
    let mut series = ErrorSeries::new();
    for k in 0..100u32 {
        series.push([f64::from(k), 0.0, f64::from(k)]);
    }
    assert_eq!(series.points().len(), 100);
}

#[test]
fn extremes_of_every_bucket_survive_its_merging() {
    // The first merge comes with the next point after the last bucket.
    for extreme in [0, 1, 250, 251, BUCKETS_MAX - 2, BUCKETS_MAX - 1] {
        let mut series = ErrorSeries::new();
        for k in 0..=BUCKETS_MAX {
            let latitude = if k == extreme { 5.0 } else { 0.0 };
            series.push([k as f64, latitude, 0.0]);
        }
        assert!(series.points().contains(&[extreme as f64, 5.0, 0.0]), "{extreme}");
    }
}
