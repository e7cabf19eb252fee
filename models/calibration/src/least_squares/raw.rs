//! The same calibration in terms of raw counts, as in data sheets of MEMS units.
//!
//! A sensor's counts become SI with nominal values, `f̃ = k (raw − c)`, axis by axis, before the
//! estimator gets them. The error model is `f̃ = (I + M) f + b`, so
//! ```text
//! f = (I + M)⁻¹ (k (raw − c) − b) = A k (raw − (c + b/k)),   A = (I + M)⁻¹
//! ```
//! which is `f = T K (raw − bias)` with `bias = c + b/k`, `K_j = A_jj k_j` on the diagonal and
//! `T_ij = A_ij / A_jj`: T has a unit diagonal, and is lower triangular if M is.

use super::moves::matrix;
use nalgebra::Matrix3;
use octant_sample::Parameters;

/// Nominal values with which the counts were converted to SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// c, counts.
    pub bias_counts: [f64; 3],
    /// k, m/s² or rad/s per count.
    pub scale: [f64; 3],
}

/// `f = T K (raw − bias)`, or the same for ω.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawModel {
    /// Counts at zero.
    pub bias_counts: [f64; 3],
    /// Diagonal of K, m/s² or rad/s per count.
    pub scale: [f64; 3],
    /// T by rows, with a unit diagonal.
    pub cross: [[f64; 3]; 3],
}

/// Converts the accelerometers' parameters to raw counts; `None` if I + M_a has no inverse.
#[must_use]
pub fn accelerometer(parameters: &Parameters, nominal: &Nominal) -> Option<RawModel> {
    model(matrix(parameters.accel_matrix()), parameters.accel_bias, nominal)
}

/// Converts the gyros' parameters to raw counts; `None` if I + M_g has no inverse. G is left out.
#[must_use]
pub fn gyroscope(parameters: &Parameters, nominal: &Nominal) -> Option<RawModel> {
    model(matrix(parameters.gyro_matrix()), parameters.gyro_bias, nominal)
}

fn model(m: Matrix3<f64>, bias: [f64; 3], nominal: &Nominal) -> Option<RawModel> {
    let a = (Matrix3::identity() + m).try_inverse()?;
    let model = RawModel {
        bias_counts: core::array::from_fn(|i| nominal.bias_counts[i] + bias[i] / nominal.scale[i]),
        scale: core::array::from_fn(|j| a[(j, j)] * nominal.scale[j]),
        cross: core::array::from_fn(|i| core::array::from_fn(|j| a[(i, j)] / a[(j, j)])),
    };
    let finite = |values: &[f64; 3]| values.iter().all(|value| value.is_finite());
    let good = finite(&model.bias_counts) && finite(&model.scale) && model.cross.iter().all(finite);
    good.then_some(model)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn both_forms_turn_the_same_counts_into_the_same_force() {
        let parameters = Parameters {
            accel_bias: [0.86, 1.2, -0.97],
            accel_scale: [0.003, -0.002, 0.004],
            accel_misalignment: [0.0036, 0.009, 0.021],
            ..Parameters::default()
        };
        let nominal = Nominal { bias_counts: [32768.0, 32000.0, 100.0], scale: [2e-3, 3e-3, 4e-3] };
        let raw = Vector3::new(36000.0, 30000.0, -2500.0);
        let measured =
            Vector3::from_fn(|i, _| nominal.scale[i] * (raw[i] - nominal.bias_counts[i]));
        let a = (Matrix3::identity() + matrix(parameters.accel_matrix())).try_inverse().unwrap();
        let ours = a * (measured - Vector3::from(parameters.accel_bias));
        let model = accelerometer(&parameters, &nominal).unwrap();
        let scaled = Vector3::from_fn(|i, _| model.scale[i] * (raw[i] - model.bias_counts[i]));
        let theirs = matrix(model.cross) * scaled;
        assert!((ours - theirs).norm() < 1e-12, "{ours} {theirs}");
        for i in 0..3 {
            assert_eq!(model.cross[i][i], 1.0);
            assert!(model.cross[i][i + 1..].iter().all(|above| *above == 0.0));
        }
    }

    #[test]
    fn a_matrix_without_an_inverse_gives_none() {
        let nominal = Nominal { bias_counts: [0.0; 3], scale: [1.0; 3] };
        let parameters = Parameters { gyro_scale: [-1.0, 0.0, 0.0], ..Parameters::default() };
        assert_eq!(gyroscope(&parameters, &nominal), None);
    }
}
