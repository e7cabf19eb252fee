//! Compensation: the inverse of the sensors' error model, on increments.
//!
//! ```text
//! f = (I + M_a)⁻¹ (f̃ − b_a)
//! ω = (I + M_g)⁻¹ (ω̃ − b_g − G f)
//! ```

use nalgebra::{Matrix3, Vector3};
use octant_sample::Parameters;

/// The inverse error model for one sample period, ready to be applied to every sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Compensation {
    gyro_inverse: Matrix3<f64>,
    accel_inverse: Matrix3<f64>,
    g_dependent: Matrix3<f64>,
    gyro_bias: Vector3<f64>,
    accel_bias: Vector3<f64>,
}

fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

impl Compensation {
    /// The inverse model of these parameters. A model that can't be inverted (errors of the size of
    /// one) leaves the matrix out; no real sensor has one.
    #[must_use]
    pub fn new(parameters: &Parameters) -> Self {
        let inverse = |errors: [[f64; 3]; 3]| {
            (Matrix3::identity() + matrix(errors)).try_inverse().unwrap_or_else(Matrix3::identity)
        };
        Self {
            gyro_inverse: inverse(parameters.gyro_matrix()),
            accel_inverse: inverse(parameters.accel_matrix()),
            g_dependent: matrix(parameters.g_matrix()),
            gyro_bias: Vector3::from(parameters.gyro_bias),
            accel_bias: Vector3::from(parameters.accel_bias),
        }
    }

    /// True increments (Δθ, Δv) in b from measured ones over `interval_s`.
    #[must_use]
    #[inline]
    pub fn apply(
        &self,
        delta_theta: &Vector3<f64>,
        delta_velocity: &Vector3<f64>,
        interval_s: f64,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let dv = self.accel_inverse * (delta_velocity - self.accel_bias * interval_s);
        let dtheta =
            self.gyro_inverse * (delta_theta - self.gyro_bias * interval_s - self.g_dependent * dv);
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
