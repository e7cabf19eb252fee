//! Points of a curve, thinned to the resolution of a screen, however long the run.

/// Maximum number of points kept; beyond, every second one is dropped and half as many of the
/// following ones are kept.
const POINTS_MAX: usize = 2048;

/// Curve that is thinned as it grows.
#[derive(Clone, Debug, Default)]
pub struct Series {
    points: Vec<(f64, f64)>,
    /// Number of points left out after each one that is kept.
    left_out: u64,
    seen: u64,
}

impl Series {
    /// Adds a point.
    pub fn push(&mut self, x: f64, y: f64) {
        if !x.is_finite() || !y.is_finite() {
            return;
        }
        if self.seen.is_multiple_of(self.left_out + 1) {
            self.points.push((x, y));
        }
        self.seen += 1;
        if self.points.len() > POINTS_MAX {
            let mut odd = false;
            self.points.retain(|_| {
                odd = !odd;
                odd
            });
            self.left_out = 2 * self.left_out + 1;
        }
    }

    /// Removes all points.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Returns the kept points, in order.
    #[must_use]
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
