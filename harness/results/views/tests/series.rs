//! Curves in bounded memory.

use octant_views::series::{POINTS_MAX, Series};

#[test]
fn a_long_curve_keeps_its_shape_in_bounded_memory() {
    let mut series = Series::default();
    for k in 0..1_000_000 {
        series.push(f64::from(k), 2.0 * f64::from(k));
    }
    let points = series.points();
    assert!(points.len() > POINTS_MAX / 2 - 2 && points.len() <= POINTS_MAX);
    assert_eq!(points[0], (0.0, 0.0));
    assert!(points.iter().all(|(x, y)| *y == 2.0 * x));
    let step = points[1].0;
    assert!(points.windows(2).all(|pair| pair[1].0 - pair[0].0 == step), "equal distances");
    assert!(points[points.len() - 1].0 + step >= 999_999.0, "to the end");
    series.push(f64::NAN, 1.0);
    assert_eq!(series.points().len(), points_after(&series));
}

fn points_after(series: &Series) -> usize {
    series.points().iter().filter(|(x, _)| x.is_finite()).count()
}
