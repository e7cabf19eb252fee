//! Size effect: specific force that a proof mass feels away from the centre of rotation.

use nalgebra::{Matrix3, Vector3};
use octant_earth::rotation::skew;

/// Rate of the body at the end of the last interval, from mean rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SizeEffect {
    /// Mean rate over the last interval, and rate at its end, rad/s.
    last: Option<(Vector3<f64>, Vector3<f64>)>,
}

impl SizeEffect {
    /// Takes an interval: its turn (b, rad) and length. Returns ∫([ω̇×] + [ω×]²) dt, 1/s: row i times
    /// r_i is the velocity that accelerometer i gains by its arm.
    ///
    /// The rate at the end of an interval is extrapolated from the mean rates of two, so that a rate
    /// that changes evenly is exact. The changes of rate telescope: no error accumulates.
    #[inline]
    pub(crate) fn step(&mut self, dtheta: &Vector3<f64>, interval_s: f64) -> Matrix3<f64> {
        let mean = dtheta * (1.0 / interval_s);
        let (before, start) = self.last.unwrap_or((mean, mean));
        let end = mean + (mean - before) * 0.5;
        self.last = Some((mean, end));
        let square = mean * dtheta.transpose();
        skew(&(end - start)) + square - Matrix3::from_diagonal_element(square.trace())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn about z with constant acceleration: −ω² along the arm, ω̇ across it.
    #[test]
    fn a_steady_acceleration_is_exact() {
        let (dt, acceleration) = (0.005, 0.2);
        let rate = |t: f64| 0.1 + acceleration * t;
        let mut effect = SizeEffect::default();
        let mut sum = Matrix3::zeros();
        for k in 0..200 {
            let t = f64::from(k) * dt;
            let turn = 0.5 * (rate(t) + rate(t + dt)) * dt;
            let felt = effect.step(&Vector3::new(0.0, 0.0, turn), dt);
            // The first two intervals don't know the acceleration yet.
            if k >= 2 {
                sum += felt;
            }
        }
        let (from, to) = (rate(2.0 * dt), rate(200.0 * dt));
        let square = (to.powi(3) - from.powi(3)) / (3.0 * acceleration);
        let expected =
            Matrix3::new(-square, from - to, 0.0, to - from, -square, 0.0, 0.0, 0.0, 0.0);
        assert!((sum - expected).amax() < 1e-6, "{sum} {expected}");
    }
}
