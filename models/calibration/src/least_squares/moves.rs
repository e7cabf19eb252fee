//! A move between two static intervals: rotation by the gyros, and its sensitivity to their
//! parameters.

use nalgebra::{Matrix3, Quaternion, SMatrix, SVector, UnitQuaternion, Vector3};
use octant_earth::rotation::{quaternion_of, renormalize};
use octant_sample::Parameters;

/// Compensation with fixed parameters: `ω = A_g (ω̃ − b_g − G f)`, `f = A_a (f̃ − b_a)`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Compensation {
    /// (I + M_g)⁻¹.
    pub(crate) gyro: Matrix3<f64>,
    /// b_g, rad/s.
    pub(crate) gyro_bias: Vector3<f64>,
    /// G, (rad/s)/(m/s²).
    pub(crate) g: Matrix3<f64>,
    /// (I + M_a)⁻¹.
    pub(crate) accel: Matrix3<f64>,
    /// b_a, m/s².
    pub(crate) accel_bias: Vector3<f64>,
}

/// Matrix from rows.
pub(crate) fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

impl Compensation {
    /// Makes the compensation; `None` if I + M_g or I + M_a has no inverse or a parameter is not
    /// finite.
    pub(crate) fn new(parameters: &Parameters) -> Option<Self> {
        if !parameters.to_array().iter().all(|value| value.is_finite()) {
            return None;
        }
        Some(Self {
            gyro: (Matrix3::identity() + matrix(parameters.gyro_matrix())).try_inverse()?,
            gyro_bias: Vector3::from(parameters.gyro_bias),
            g: matrix(parameters.g_matrix()),
            accel: (Matrix3::identity() + matrix(parameters.accel_matrix())).try_inverse()?,
            accel_bias: Vector3::from(parameters.accel_bias),
        })
    }

    /// Compensates a measured specific force; in b, m/s².
    pub(crate) fn force(&self, measured_mps2: &Vector3<f64>) -> Vector3<f64> {
        self.accel * (measured_mps2 - self.accel_bias)
    }

    /// Compensates a measured angular rate at a (true) specific force; in b, rad/s.
    pub(crate) fn rate(&self, measured_radps: &Vector3<f64>, force: &Vector3<f64>) -> Vector3<f64> {
        self.gyro * (measured_radps - self.gyro_bias - self.g * force)
    }
}

/// Rotation by the gyros from the end of one static interval to the start of the next.
///
/// With `R` from the body at the end to the body at the start, against inertial space, integrated
/// with the parameters p₀: `R(p) = exp(J (p − p₀)) R`, to first order. From
/// `δω = −A (δb + δM ω)` and `ψ̇ = R δω` the sensitivity is
/// `J = −∫ R A [I, ω_x I, ω_y I, ω_z I] dt` for (δb, and the columns of δM).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Move {
    rotation: Quaternion<f64>,
    /// −J before the multiplication with the constant A: ∫ R dt, ∫ R ω_j dt.
    integrals: [Matrix3<f64>; 4],
    /// Duration, s.
    pub(crate) duration_s: f64,
    /// True if no sample of the move was lost or invalid.
    pub(crate) complete: bool,
}

impl Default for Move {
    fn default() -> Self {
        Self {
            rotation: Quaternion::identity(),
            integrals: [Matrix3::zeros(); 4],
            duration_s: 0.0,
            complete: true,
        }
    }
}

impl Move {
    /// Adds one sample: measured increments (rad, m/s) over `dt_s`.
    pub(crate) fn step(
        &mut self,
        delta_theta: &Vector3<f64>,
        delta_velocity: &Vector3<f64>,
        dt_s: f64,
        compensation: &Compensation,
    ) {
        let force = compensation.force(&(delta_velocity / dt_s));
        let rate = compensation.rate(&(delta_theta / dt_s), &force);
        let half = quaternion_of(&(rate * (0.5 * dt_s)));
        let middle = self.rotation * half;
        let r = UnitQuaternion::new_unchecked(middle).to_rotation_matrix().into_inner() * dt_s;
        self.integrals[0] += r;
        for j in 0..3 {
            self.integrals[j + 1] += r * rate[j];
        }
        self.rotation = renormalize(middle * half);
        self.duration_s += dt_s;
    }

    /// R: body at the end to body at the start.
    pub(crate) fn rotation(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::new_unchecked(self.rotation)
    }

    /// J for (b_g, then S_g and M_g) in the order of the parameters' vector.
    pub(crate) fn sensitivity(&self, gyro: &Matrix3<f64>) -> SMatrix<f64, 3, 12> {
        let blocks = self.integrals.map(|integral| -(integral * gyro));
        let mut j = SMatrix::<f64, 3, 12>::zeros();
        for (column, (row, of)) in GYRO_TERMS.iter().enumerate() {
            j.set_column(column, &blocks[*of].column(*row));
        }
        j
    }
}

/// Parameters 0 to 11 as (row, factor): the drift is on axis `row`, and proportional to 1 (factor
/// 0) or to the rate about axis `factor − 1`.
pub(crate) const GYRO_TERMS: [(usize, usize); 12] = [
    (0, 0),
    (1, 0),
    (2, 0),
    (0, 1),
    (1, 2),
    (2, 3),
    (0, 2),
    (0, 3),
    (1, 1),
    (1, 3),
    (2, 1),
    (2, 2),
];

/// Parameters 21 to 29 in the same way: error on axis `row`, proportional to 1 or to the specific
/// force on axis `factor − 1`.
pub(crate) const ACCEL_TERMS: [(usize, usize); 9] =
    [(0, 0), (1, 0), (2, 0), (0, 1), (1, 2), (2, 3), (1, 1), (2, 1), (2, 2)];

/// Adds a correction to the parameters, in the order of the parameters' vector.
pub(crate) fn corrected(parameters: &Parameters, correction: &SVector<f64, 30>) -> Parameters {
    let mut all = parameters.to_array();
    for (value, delta) in all.iter_mut().zip(correction.iter()) {
        *value += delta;
    }
    Parameters::from_array(&all)
}
