//! Points of a curve, thinned to the resolution of a screen, however long the run.

/// Maximum number of points kept; beyond, every second one is dropped and half as many of the
/// following ones are kept.
pub const POINTS_MAX: usize = 2048;

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
