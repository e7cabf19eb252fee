//! System error model over one interval, in phi-angle and psi-angle form: growth of the errors.
//!
//! Phi-angle form (Zheng, Han and Zheng, 2015, eq. 1 to 3), errors computed − true:
//! ```text
//! φ̇ = −(ω_ie + ω_en) × φ + δω_in − C ε
//! δv̇ = f × φ − (2ω_ie + ω_en) × δv − (2δω_ie + δω_en) × v + δg + C ∇
//! δṙ = −ω_en × δr + δv
//! ```
//! Psi-angle form (Benson, 1975): the attitude error is counted from the computer frame, which is
//! turned from the true one by δθ = (δr_E/R_N, −δr_N/R_M, −δr_E tan L/R_N), so φ = ψ + δθ:
//! ```text
//! ψ̇ = −(ω_ie + ω_en) × ψ − C ε
//! δv̇ = f × ψ − (2ω_ie + ω_en) × δv + δg + C ∇      δg = (−g/R_M δr_N, −g/R_N δr_E, 2g/R δr_D)
//! δṙ = −ω_en × δr + δv
//! ```
//! The parameters are states too, with no dynamics. They count true − estimated, so that ε = δb +
//! δM ω + δG f and ∇ = δb_a + δM_a f are the errors that remain after compensation.

use crate::config::ErrorModel;
use crate::covariance::{CovarianceRow, DR, DV, MOVING, PARAMETERS, PHI, Transition};
use nalgebra::{Matrix3, Vector3};
use octant_earth::ellipsoid::Ellipsoid;

/// Rows and columns of M_g in the order of its off-diagonal states.
const GYRO_OFF_DIAGONAL: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];
/// Rows and columns of M_a in the order of its off-diagonal states.
const ACCEL_OFF_DIAGONAL: [(usize, usize); 3] = [(1, 0), (2, 0), (2, 1)];

/// Error states of the accelerometers' parameters.
const ACCELEROMETERS: core::ops::Range<usize> = PARAMETERS + 21..PARAMETERS + 30;

/// Motion in a short interval, as far as errors depend on it. Accurate to second order in its
/// length as long as the body turns by less than about a degree.
#[derive(Clone, Copy, Debug)]
pub struct MotionInterval {
    /// Length, s.
    pub interval_s: f64,
    /// Attitude in the middle of the interval.
    pub c_nb: Matrix3<f64>,
    /// Integrated rate in b, rad.
    pub delta_theta: Vector3<f64>,
    /// Integrated specific force in b, m/s.
    pub delta_velocity: Vector3<f64>,
    /// Integrated specific force in n, m/s.
    pub delta_velocity_n: Vector3<f64>,
    /// Velocity over ground in n, m/s.
    pub velocity_mps: Vector3<f64>,
}

impl Transition {
    /// Advances the transition over one interval: `Φ ← (I + F h) Φ`, with the attitude error at the
    /// middle of the interval driving velocity, and the velocity error at the middle driving
    /// position and transport rate.
    pub fn advance(&mut self, model: ErrorModel, interval: &MotionInterval, earth: &Ellipsoid) {
        let input = parameter_input(interval, [true; 3], true);
        self.advance_in(model, interval, earth, input);
    }

    /// Advances the transition over an interval in which known motion replaced some of the gyros
    /// (x, y, z) or the accelerometers: their parameters had no effect. Specific force that isn't
    /// measured is assumed to be that of a base at rest in n, and turns with no attitude error.
    pub fn advance_bridged(
        &mut self,
        model: ErrorModel,
        interval: &MotionInterval,
        earth: &Ellipsoid,
        gyros_used: [bool; 3],
        accelerometers_used: bool,
    ) {
        let input = parameter_input(interval, gyros_used, accelerometers_used);
        let mut interval = *interval;
        if !accelerometers_used {
            interval.delta_velocity_n = Vector3::zeros();
        }
        self.advance_in(model, &interval, earth, input);
    }

    fn advance_in(
        &mut self,
        model: ErrorModel,
        interval: &MotionInterval,
        earth: &Ellipsoid,
        input: [CovarianceRow; 6],
    ) {
        advance_columns(&mut self.rows, model, interval, earth, input, ACCELEROMETERS);
    }
}

/// Advances columns of a transition's moving rows over an interval, as [`Transition::advance`]:
/// `input` is their contribution to φ and δv in it. Those of `accelerometers` drive the velocity.
#[inline(always)]
pub fn advance_columns<const N: usize>(
    rows: &mut [[f64; N]; MOVING],
    model: ErrorModel,
    interval: &MotionInterval,
    earth: &Ellipsoid,
    input: [[f64; N]; 6],
    accelerometers: core::ops::Range<usize>,
) {
    match model {
        ErrorModel::Phi => advance_by::<true, N>(rows, interval, earth, input, accelerometers),
        ErrorModel::Psi => advance_by::<false, N>(rows, interval, earth, input, accelerometers),
    }
}

fn advance_by<const PHI_ANGLE: bool, const N: usize>(
    rows: &mut [[f64; N]; MOVING],
    interval: &MotionInterval,
    earth: &Ellipsoid,
    mut input: [[f64; N]; 6],
    accelerometers: core::ops::Range<usize>,
) {
    let h = interval.interval_s;
    let v = &interval.velocity_mps;
    let (rm, rn) = (earth.meridian_radius_m, earth.transverse_radius_m);
    let tan_latitude = earth.sin_latitude / earth.cos_latitude;
    let w_ie = earth.earth_rate() * h;
    let w_en = earth.transport_rate(v) * h;
    let w_in = w_ie + w_en;
    let w_coriolis = w_ie + w_in;
    let f = &interval.delta_velocity_n;

    // δω_ie h and δω_en h by δv_N, δv_E, δr_N, δr_D; zero in psi-angle form.
    let on = if PHI_ANGLE { 1.0 } else { 0.0 };
    let ie_x_rn = on * w_ie.z / rm;
    let ie_z_rn = -on * w_ie.x / rm;
    let en_x_ve = on * h / rn;
    let en_x_rd = on * h * v.y / (rn * rn);
    let en_y_vn = -on * h / rm;
    let en_y_rd = -on * h * v.x / (rm * rm);
    let en_z_ve = -on * h * tan_latitude / rn;
    let en_z_rn = -on * h * v.y / (rn * rm * earth.cos_latitude * earth.cos_latitude);
    let en_z_rd = -on * h * v.y * tan_latitude / (rn * rn);
    let g = earth.gravity_mps2 * h;
    let (g_n, g_e) = ((on - 1.0) * g / rm, (on - 1.0) * g / rn);
    let g_d = 2.0 * g / rm;

    // Errors at the middle of the interval close the Schuler loop: with those at its start an
    // oscillation would grow by (ω h)²/4 in each. Of the velocity there the parts of tilt and
    // accelerometers count, which a reference lets cancel; in psi-angle form of the position
    // there that of the velocity.
    let half = 0.5 * h;
    let half_f = f * 0.5;
    for j in accelerometers {
        let (vn, ve) = (0.5 * input[3][j], 0.5 * input[4][j]);
        input[0][j] += en_x_ve * ve;
        input[1][j] += en_y_vn * vn;
        input[2][j] += en_z_ve * ve;
    }
    for j in 0..N {
        let phi = [rows[PHI][j], rows[PHI + 1][j], rows[PHI + 2][j]];
        let dv = [rows[DV][j], rows[DV + 1][j], rows[DV + 2][j]];
        let dr = [rows[DR][j], rows[DR + 1][j], rows[DR + 2][j]];

        let (vn, ve) = (
            dv[0] + (half_f.y * phi[2] - half_f.z * phi[1]),
            dv[1] + (half_f.z * phi[0] - half_f.x * phi[2]),
        );
        let ie = [ie_x_rn * dr[0], 0.0, ie_z_rn * dr[0]];
        let en = [
            en_x_ve * ve + en_x_rd * dr[2],
            en_y_vn * vn + en_y_rd * dr[2],
            en_z_ve * ve + en_z_rn * dr[0] + en_z_rd * dr[2],
        ];
        let phi_new = [
            phi[0] - (w_in.y * phi[2] - w_in.z * phi[1]) + ie[0] + en[0] + input[0][j],
            phi[1] - (w_in.z * phi[0] - w_in.x * phi[2]) + en[1] + input[1][j],
            phi[2] - (w_in.x * phi[1] - w_in.y * phi[0]) + ie[2] + en[2] + input[2][j],
        ];
        let m =
            [0.5 * (phi[0] + phi_new[0]), 0.5 * (phi[1] + phi_new[1]), 0.5 * (phi[2] + phi_new[2])];
        // a = (2δω_ie + δω_en) h; −a × v = v × a.
        let a = [2.0 * ie[0] + en[0], en[1], 2.0 * ie[2] + en[2]];
        let c = &w_coriolis;
        let mut dv_new = [
            dv[0] + (f.y * m[2] - f.z * m[1]) - (c.y * dv[2] - c.z * dv[1])
                + (v.y * a[2] - v.z * a[1])
                + input[3][j],
            dv[1] + (f.z * m[0] - f.x * m[2]) - (c.z * dv[0] - c.x * dv[2])
                + (v.z * a[0] - v.x * a[2])
                + input[4][j],
            dv[2] + (f.x * m[1] - f.y * m[0]) - (c.x * dv[1] - c.y * dv[0])
                + (v.x * a[1] - v.y * a[0])
                + g_d * dr[2]
                + input[5][j],
        ];
        if !PHI_ANGLE {
            dv_new[0] += g_n * (dr[0] + half * dv[0]);
            dv_new[1] += g_e * (dr[1] + half * dv[1]);
        }
        let dr_new = [
            dr[0] + half * (dv[0] + dv_new[0]) - (w_en.y * dr[2] - w_en.z * dr[1]),
            dr[1] + half * (dv[1] + dv_new[1]) - (w_en.z * dr[0] - w_en.x * dr[2]),
            dr[2] + half * (dv[2] + dv_new[2]) - (w_en.x * dr[1] - w_en.y * dr[0]),
        ];
        for axis in 0..3 {
            rows[PHI + axis][j] = phi_new[axis];
            rows[DV + axis][j] = dv_new[axis];
            rows[DR + axis][j] = dr_new[axis];
        }
    }
}

/// Contribution of the parameter errors to φ (rows 0 to 2) and δv (rows 3 to 5) in the interval.
fn parameter_input(
    interval: &MotionInterval,
    gyros_used: [bool; 3],
    accelerometers_used: bool,
) -> [CovarianceRow; 6] {
    let h = interval.interval_s;
    let (dtheta, dv) = (&interval.delta_theta, &interval.delta_velocity);
    let mut input: [CovarianceRow; 6] = [[0.0; 40]; 6];
    for i in 0..3 {
        let full = [interval.c_nb[(i, 0)], interval.c_nb[(i, 1)], interval.c_nb[(i, 2)]];
        let c: [f64; 3] =
            core::array::from_fn(|axis| if gyros_used[axis] { full[axis] } else { 0.0 });
        let phi = &mut input[i][PARAMETERS..];
        for axis in 0..3 {
            phi[axis] = -c[axis] * h;
            phi[3 + axis] = -c[axis] * dtheta[axis];
            for column in 0..3 {
                phi[12 + 3 * axis + column] = -c[axis] * dv[column];
            }
        }
        for (k, (row, column)) in GYRO_OFF_DIAGONAL.into_iter().enumerate() {
            phi[6 + k] = -c[row] * dtheta[column];
        }
        let c = if accelerometers_used { full } else { [0.0; 3] };
        let velocity = &mut input[3 + i][PARAMETERS..];
        for axis in 0..3 {
            velocity[21 + axis] = c[axis] * h;
            velocity[24 + axis] = c[axis] * dv[axis];
        }
        for (k, (row, column)) in ACCEL_OFF_DIAGONAL.into_iter().enumerate() {
            velocity[27 + k] = c[row] * dv[column];
        }
    }
    input
}

/// Rotation δθ of the computer frame from the true one by a position error (m; n, e, d), rad.
#[must_use]
pub fn computer_frame_error(dr: &Vector3<f64>, earth: &Ellipsoid) -> Vector3<f64> {
    let east = dr.y / earth.transverse_radius_m;
    Vector3::new(
        east,
        -dr.x / earth.meridian_radius_m,
        -east * earth.sin_latitude / earth.cos_latitude,
    )
}
