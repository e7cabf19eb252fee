//! Sine and cosine of an angle that moves slowly: from a reference that is renewed rarely.

use nalgebra::Vector3;

/// Largest distance from the reference, rad. Within it the series below are exact to a bit or two.
const REACH_RAD: f64 = 0.1;

/// Sine and cosine of a small angle, |angle| ≤ 0.1 rad.
#[inline]
pub(crate) fn small_sincos(angle: f64) -> (f64, f64) {
    let y = angle * angle;
    let sin = angle
        - angle * y * (1.0 / 6.0 - y * (1.0 / 120.0 - y * (1.0 / 5040.0 - y * (1.0 / 362_880.0))));
    let cos = 1.0
        - y * (0.5 - y * (1.0 / 24.0 - y * (1.0 / 720.0 - y * (1.0 / 40320.0 - y / 3_628_800.0))));
    (sin, cos)
}

/// Reference angle, near which sines and cosines are computed.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Near {
    angle: f64,
    sin: f64,
    cos: f64,
}

impl Near {
    pub(crate) fn new(angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self { angle, sin, cos }
    }

    /// Sine and cosine of `angle`.
    #[inline]
    pub(crate) fn sincos(&mut self, angle: f64) -> (f64, f64) {
        let difference = angle - self.angle;
        if difference == 0.0 {
            return (self.sin, self.cos);
        }
        if difference.abs() > REACH_RAD {
            *self = Self::new(angle);
            return (self.sin, self.cos);
        }
        let (s, c) = small_sincos(difference);
        (self.sin * c + self.cos * s, self.cos * c - self.sin * s)
    }
}

/// `Rx(angle)ᵀ v` for sine and cosine of the angle.
#[inline]
pub(crate) fn rx_t(v: &Vector3<f64>, (s, c): (f64, f64)) -> Vector3<f64> {
    Vector3::new(v.x, c * v.y + s * v.z, c * v.z - s * v.y)
}

/// `Ry(angle)ᵀ v`.
#[inline]
pub(crate) fn ry_t(v: &Vector3<f64>, (s, c): (f64, f64)) -> Vector3<f64> {
    Vector3::new(c * v.x - s * v.z, v.y, s * v.x + c * v.z)
}

/// `Rz(angle)ᵀ v`.
#[inline]
pub(crate) fn rz_t(v: &Vector3<f64>, (s, c): (f64, f64)) -> Vector3<f64> {
    Vector3::new(c * v.x + s * v.y, c * v.y - s * v.x, v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_agrees_with_libm_over_a_turn() {
        let mut near = Near::new(0.0);
        for i in 0..100_000 {
            let angle = f64::from(i) * 1e-4;
            let (s, c) = near.sincos(angle);
            assert!((s - libm::sin(angle)).abs() < 4e-16, "{angle}");
            assert!((c - libm::cos(angle)).abs() < 4e-16, "{angle}");
        }
    }

    #[test]
    fn transposed_rotations_undo_those_of_the_earth_crate() {
        let v = Vector3::new(0.3, -0.7, 0.2);
        let sc = libm::sincos(0.83);
        assert!((octant_earth::rotation::rx(0.83) * rx_t(&v, sc) - v).norm() < 1e-15);
        assert!((octant_earth::rotation::ry(0.83) * ry_t(&v, sc) - v).norm() < 1e-15);
        assert!((octant_earth::rotation::rz(0.83) * rz_t(&v, sc) - v).norm() < 1e-15);
    }
}
