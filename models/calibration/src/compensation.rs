//! Compensation: the inverse of the sensors' error model, on increments.
//!
//! ```text
//! f = (I + M_a)⁻¹ (f̃ − b_a)
//! ω = (I + M_g)⁻¹ (ω̃ − b_g − G f)
//! ```

use nalgebra::{Matrix3, Vector3};
use octant_sample::Parameters;

/// Inverse error model, ready to be applied to every sample.
///
/// Both triads are computed directly from the measured increments, so that the rates don't wait for
/// the forces: with `K = (I + M_g)⁻¹ G (I + M_a)⁻¹` the second equation is
///
/// `ω = (I + M_g)⁻¹ ω̃ − K f̃ − ((I + M_g)⁻¹ b_g − K b_a)`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "state", serde(from = "Inverse", into = "Inverse"))]
pub struct Compensation {
    inverse: Inverse,
    /// K, see above, (rad/s)/(m/s²).
    cross: Matrix3<f64>,
    /// Offsets subtracted per second, rad and m/s.
    gyro_offset: Vector3<f64>,
    accel_offset: Vector3<f64>,
}

/// Data from which the compensation is computed; the part that a state holds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
struct Inverse {
    gyro_inverse: Matrix3<f64>,
    accel_inverse: Matrix3<f64>,
    g_dependent: Matrix3<f64>,
    gyro_bias: Vector3<f64>,
    accel_bias: Vector3<f64>,
}

impl From<Inverse> for Compensation {
    fn from(inverse: Inverse) -> Self {
        let cross = inverse.gyro_inverse * inverse.g_dependent * inverse.accel_inverse;
        Self {
            inverse,
            cross,
            gyro_offset: inverse.gyro_inverse * inverse.gyro_bias - cross * inverse.accel_bias,
            accel_offset: inverse.accel_inverse * inverse.accel_bias,
        }
    }
}

impl From<Compensation> for Inverse {
    fn from(compensation: Compensation) -> Self {
        compensation.inverse
    }
}

fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

impl Compensation {
    /// Makes the inverse model of these parameters. If a matrix has no inverse (errors of the size
    /// of one), it is left out; no real sensor has such errors.
    #[must_use]
    pub fn new(parameters: &Parameters) -> Self {
        let inverse = |errors: [[f64; 3]; 3]| {
            (Matrix3::identity() + matrix(errors)).try_inverse().unwrap_or_else(Matrix3::identity)
        };
        Self::from(Inverse {
            gyro_inverse: inverse(parameters.gyro_matrix()),
            accel_inverse: inverse(parameters.accel_matrix()),
            g_dependent: matrix(parameters.g_matrix()),
            gyro_bias: Vector3::from(parameters.gyro_bias),
            accel_bias: Vector3::from(parameters.accel_bias),
        })
    }

    /// Returns the true increments (Δθ, Δv) in b for measured ones over `interval_s`.
    #[must_use]
    #[inline]
    pub fn apply(
        &self,
        delta_theta: &Vector3<f64>,
        delta_velocity: &Vector3<f64>,
        interval_s: f64,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let Inverse { gyro_inverse, accel_inverse, .. } = &self.inverse;
        let dv = accel_inverse * delta_velocity - self.accel_offset * interval_s;
        let dtheta = (gyro_inverse * delta_theta - self.gyro_offset * interval_s)
            - self.cross * delta_velocity;
        (dtheta, dv)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_sample::parameters::PARAMETER_COUNT;

    #[test]
    fn compensation_inverts_the_error_model() {
        let mut all = [0.0; PARAMETER_COUNT];
        for (i, value) in all.iter_mut().enumerate() {
            *value = 1e-3 * (i as f64 - 14.0);
        }
        let p = Parameters::from_array(&all);
        let (omega, f) = (Vector3::new(0.1, -0.2, 0.3), Vector3::new(1.0, 2.0, -9.8));
        let dt = 0.005;
        let measured_f = f + matrix(p.accel_matrix()) * f + Vector3::from(p.accel_bias);
        let measured_omega = omega
            + matrix(p.gyro_matrix()) * omega
            + Vector3::from(p.gyro_bias)
            + matrix(p.g_matrix()) * f;
        let (dtheta, dv) =
            Compensation::new(&p).apply(&(measured_omega * dt), &(measured_f * dt), dt);
        assert!((dtheta - omega * dt).amax() < 1e-17);
        assert!((dv - f * dt).amax() < 1e-15);
    }
}
