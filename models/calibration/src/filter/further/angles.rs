//! Gimbal angles as a measurement of attitude, for a case at rest.
//!
//! With the reading of a gimbal, measured − true, `ε = c cos(angle) + s sin(angle) + curve + noise`, the
//! attitude of the body is
//!
//! ```text
//! C_nb = exp([ψ×]) C_nc · Rx(roll − ε_r) · Ry(η) · Rz(azimuth − ε_a) · exp([μ×])
//! ```
//!
//! C_nc is the reference: what is known of the case's attitude, whose error ψ (n, rad) is a state without an
//! estimate, because each is turned into the reference at once. The measurement is the rotation vector z of the
//! navigated attitude against the predicted one, in n. With the errors of the states, true − estimated, and
//! u_x = C_nc e_x, u_y = C_nc Rx e_y, u_z = C_nc Rx Ry e_z, the axes of the gimbals in n:
//!
//! ```text
//! z = −φ + δψ + u_x δr + u_y δη + u_z δa + C_nc Rx Ry Rz (I + ½[μ×]) δμ
//! δr = −(cos r δc_r + sin r δs_r + δcurve_r),   δa likewise
//! ```
//!
//! A zero error of the roll encoder turns the case about its own x, and one of the azimuth encoder the body about
//! its own z: no measurement of these angles tells either from ψ and μ, and they are no states. All others appear
//! as different functions of the two angles, and eight positions show each.

#[cfg(test)]
mod tests;

use super::FurtherStates;
use super::border::{BORDER_COUNT, Border, BorderRow, CASE, CURVE, places};
use super::gimbals::{AngleTally, GimbalReference};
use crate::config::ErrorModel;
use crate::covariance::{Covariance, CovarianceRow, DR, PHI, STATE_COUNT};
use crate::error_model::computer_frame_error;
use crate::further::FurtherGroup;
use crate::strapdown::Strapdown;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::rotation::{exp, log, rx, ry, rz, skew};
use octant_sample::GimbalAngles;

/// NIS (three axes) above which angles are rejected: six σ, as the gate of a hardened core.
pub const ANGLE_GATE_NIS: f64 = 36.0;
/// Rejections in a row after which the angles are never believed again: an encoder or a gimbal has slipped.
const REJECTIONS_MAX: u32 = 5;
/// Standard deviation of the case's attitude before the first angles, rad: larger than every error of the first
/// attitude, and small enough to be a number beside the noise.
const CASE_SIGMA_RAD: f64 = 0.1;
/// Turn of a gimbal that makes another stop, rad: beyond any noise, and far below any move.
const ANOTHER_STOP_RAD: f64 = 1e-3;

/// Result of one measurement of the angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleResult {
    /// Normalized innovation squared over three axes.
    pub nis: f64,
    /// True if the gate rejected it.
    pub rejected: bool,
}

/// Effect of the states of the border on z, a row for each axis of n.
pub type AngleRows = [BorderRow; 3];

/// Estimates that a prediction of the attitude rests on.
struct Estimates {
    mounting: Vector3<f64>,
    non_orthogonality_rad: f64,
    /// Cosine and sine of azimuth, of roll.
    eccentricity_rad: [f64; 4],
    curve_rad: [f64; 2],
}

impl Estimates {
    fn of(value: &BorderRow) -> Self {
        let eccentricity = places(FurtherGroup::EncoderEccentricity).start;
        let mounting = places(FurtherGroup::GimbalMounting).start;
        Self {
            mounting: Vector3::from_fn(|i, _| value[mounting + i]),
            non_orthogonality_rad: value[places(FurtherGroup::GimbalNonOrthogonality).start],
            eccentricity_rad: core::array::from_fn(|i| value[eccentricity + i]),
            curve_rad: [value[CURVE], value[CURVE + 1]],
        }
    }
}

/// Attitude of the body in the case by measured angles (azimuth, roll; rad), and the rows of all states.
fn predict(
    c_nc: &Matrix3<f64>,
    [azimuth, roll]: [f64; 2],
    estimates: &Estimates,
) -> (Matrix3<f64>, AngleRows) {
    let ((sin_a, cos_a), (sin_r, cos_r)) = (libm::sincos(azimuth), libm::sincos(roll));
    let [cos_of_a, sin_of_a, cos_of_r, sin_of_r] = estimates.eccentricity_rad;
    let off_azimuth = cos_of_a * cos_a + sin_of_a * sin_a + estimates.curve_rad[0];
    let off_roll = cos_of_r * cos_r + sin_of_r * sin_r + estimates.curve_rad[1];
    let outer = rx(roll - off_roll);
    let leant = outer * ry(estimates.non_orthogonality_rad);
    let inner = leant * rz(azimuth - off_azimuth);
    let mounted = *exp(&estimates.mounting).to_rotation_matrix().matrix();
    let (x, y, z) = (c_nc.column(0), c_nc * outer.column(1), c_nc * leant.column(2));
    let mounting = c_nc * inner * (Matrix3::identity() + skew(&estimates.mounting) * 0.5);
    let mut rows = [[0.0; BORDER_COUNT]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        row[CASE + i] = 1.0;
        for axis in 0..3 {
            row[places(FurtherGroup::GimbalMounting).start + axis] = mounting[(i, axis)];
        }
        row[places(FurtherGroup::GimbalNonOrthogonality).start] = y[i];
        let at = places(FurtherGroup::EncoderEccentricity).start;
        (row[at], row[at + 1]) = (-z[i] * cos_a, -z[i] * sin_a);
        (row[at + 2], row[at + 3]) = (-x[i] * cos_r, -x[i] * sin_r);
        (row[CURVE], row[CURVE + 1]) = (-z[i], -x[i]);
    }
    (inner * mounted, rows)
}

/// z and its rows: the attitude `q_nb` against that of a body in the case `q_nc` by measured angles (azimuth, roll;
/// rad), with the estimates `value`.
pub(super) fn residual(
    q_nb: &UnitQuaternion<f64>,
    q_nc: &UnitQuaternion<f64>,
    angles_rad: [f64; 2],
    value: &BorderRow,
) -> (Vector3<f64>, AngleRows) {
    let c_nc = q_nc.to_rotation_matrix();
    let (c_cb, rows) = predict(c_nc.matrix(), angles_rad, &Estimates::of(value));
    let q_cb = octant_earth::frames::quaternion_from_matrix(&c_cb);
    (log(&(q_nb * (q_nc * q_cb).inverse())), rows)
}

/// Effect of the states of the border on z where nothing is estimated yet: for an analysis. `c_nc` is the attitude
/// of the case; angles (azimuth, roll) in rad.
#[must_use]
pub fn angle_rows(c_nc: &Matrix3<f64>, angles_rad: [f64; 2]) -> AngleRows {
    predict(c_nc, angles_rad, &Estimates::of(&[0.0; BORDER_COUNT])).1
}

/// Effect of the 39 states on z.
pub(super) fn rows_of_errors(model: ErrorModel, earth: &Ellipsoid) -> [CovarianceRow; 3] {
    let mut rows = [[0.0; 40]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        row[PHI + i] = -1.0;
        if model == ErrorModel::Psi {
            for axis in 0..3 {
                let unit = Vector3::from_fn(|j, _| if j == axis { 1.0 } else { 0.0 });
                row[DR + axis] = -computer_frame_error(&unit, earth)[i];
            }
        }
    }
    rows
}

/// Covariance of all states with one axis of z.
struct WithAxis {
    errors: CovarianceRow,
    border: BorderRow,
}

impl WithAxis {
    fn of(row: &CovarianceRow, own_row: &BorderRow, errors: &Covariance, border: &Border) -> Self {
        let mut with = Self { errors: [0.0; 40], border: [0.0; BORDER_COUNT] };
        for (i, h) in row.iter().enumerate().filter(|(_, h)| **h != 0.0) {
            for (out, p) in with.errors.iter_mut().zip(&errors.rows()[i]) {
                *out += h * p;
            }
            for (out, cross) in with.border.iter_mut().zip(&border.cross) {
                *out += h * cross[i];
            }
        }
        for (k, h) in own_row.iter().enumerate().filter(|(_, h)| **h != 0.0) {
            for (out, p) in with.errors.iter_mut().zip(&border.cross[k]) {
                *out += h * p;
            }
            for (out, p) in with.border.iter_mut().zip(&border.own[k]) {
                *out += h * p;
            }
        }
        with
    }

    /// Covariance with an axis of z, by its rows.
    fn with(&self, row: &CovarianceRow, own_row: &BorderRow) -> f64 {
        let sum = |a: &[f64; 40], b: &[f64; 40]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        sum(&self.errors, row) + sum(&self.border, own_row)
    }
}

impl FurtherStates {
    /// Counts of the angles; `None` where they are no measurements.
    pub(in crate::filter) fn angle_tally(&self) -> Option<&AngleTally> {
        self.angles.as_ref().map(|angles| &angles.tally)
    }

    /// Turns the estimated error of the case's attitude into the reference.
    pub(super) fn fold_case(&mut self) {
        // Without angles its place may be another state's.
        if self.angles.is_none() {
            return;
        }
        let Border { value, reference, .. } = &mut self.border;
        let psi = Vector3::new(value[CASE], value[CASE + 1], value[CASE + 2]);
        if let Some(q_nc) = &mut reference.q_nc
            && psi != Vector3::zeros()
        {
            *q_nc = UnitQuaternion::new_normalize((exp(&psi) * *q_nc).into_inner());
        }
        value[CASE..CASE + 3].fill(0.0);
    }

    /// Uses the angles of gimbals at rest: gate, update of `errors` and of the border. `x` takes the estimates of the
    /// 39 error states. `None` where angles are no measurements, or aren't believed any more.
    pub(in crate::filter) fn measure_angles(
        &mut self,
        gimbal: GimbalAngles,
        strapdown: &Strapdown,
        model: ErrorModel,
        errors: &mut Covariance,
        x: &mut [f64; STATE_COUNT],
    ) -> Option<AngleResult> {
        let angles = self.angles.as_ref().filter(|angles| !angles.tally.slipped)?;
        let (r, curve_sigma) = (angles.variance_rad2, angles.curve_sigma_rad);
        let angles_rad = [gimbal.azimuth_rad(), gimbal.roll_rad()];
        let moved = self.border.stop_at(angles_rad, curve_sigma);
        let [w, i, j, k] = strapdown.navigation().q_nb;
        let q_nb = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        let q_nc = if let Some(q_nc) = self.border.reference.q_nc {
            q_nc
        } else {
            let (turn, _) =
                residual(&q_nb, &UnitQuaternion::identity(), angles_rad, &self.border.value);
            (0..3).for_each(|axis| self.border.renew(CASE + axis, CASE_SIGMA_RAD));
            *self.border.reference.q_nc.insert(exp(&turn))
        };
        let (z, of_reference) = residual(&q_nb, &q_nc, angles_rad, &self.border.value);
        let rows = self.rows_of_stop(&q_nc, angles_rad, moved).unwrap_or(of_reference);
        let of_errors = rows_of_errors(model, strapdown.earth());

        let with = |axis: usize, errors: &Covariance, border: &Border| {
            WithAxis::of(&of_errors[axis], &rows[axis], errors, border)
        };
        let all: [WithAxis; 3] = core::array::from_fn(|axis| with(axis, errors, &self.border));
        let s = Matrix3::from_fn(|i, j| all[i].with(&of_errors[j], &rows[j]))
            + Matrix3::from_diagonal_element(r);
        let nis = z.dot(&(s.try_inverse()? * z));
        let tally = &mut self.angles.as_mut()?.tally;
        if !nis.is_finite() {
            return None;
        }
        if nis > ANGLE_GATE_NIS {
            tally.rejected += 1;
            tally.in_a_row += 1;
            tally.slipped = tally.in_a_row >= REJECTIONS_MAX;
            return Some(AngleResult { nis, rejected: true });
        }
        tally.used += 1;
        tally.in_a_row = 0;
        tally.nis_sum += nis;
        let mut moved = [0.0; BORDER_COUNT];
        for axis in 0..3 {
            let WithAxis { errors: of_39, border: of_border } = with(axis, errors, &self.border);
            let (row, own_row) = (&of_errors[axis], &rows[axis]);
            let scale = 1.0
                / libm::sqrt(WithAxis { errors: of_39, border: of_border }.with(row, own_row) + r);
            let expected = x.iter().zip(row).map(|(x, h)| x * h).sum::<f64>()
                + moved.iter().zip(own_row).map(|(x, h)| x * h).sum::<f64>();
            let innovation = scale * (z[axis] - expected);
            let (of_39, of_border) = (of_39.map(|c| c * scale), of_border.map(|c| c * scale));
            errors.subtract_square(&of_39, false);
            for (x, gain) in x.iter_mut().zip(&of_39) {
                *x += gain * innovation;
            }
            for (moved, (gain, is_estimated)) in
                moved.iter_mut().zip(of_border.iter().zip(&self.estimated))
            {
                *moved += if *is_estimated { gain * innovation } else { 0.0 };
            }
            self.subtract(&of_39, &of_border);
        }
        for (value, moved) in self.border.value.iter_mut().zip(&moved) {
            *value += moved;
        }
        self.fold_case();
        self.follow_case();
        Some(AngleResult { nis, rejected: false })
    }

    /// Rows of the states at a stop of a case at rest; `None` where no case is said to rest.
    ///
    /// Within a stop they are those of its first reference. An angle with 0.1° of uncertainty and the case's heading are
    /// seen as one sum there. Were the axes turned with each correction of the tilt, 1″ a time, the filter would take
    /// their difference for observed (as in simultaneous localization and mapping: Huang, Mourikis and Roumeliotis,
    /// "Observability-based rules for designing consistent EKF SLAM estimators", 2010).
    fn rows_of_stop(
        &mut self,
        q_nc: &UnitQuaternion<f64>,
        angles_rad: [f64; 2],
        moved: bool,
    ) -> Option<AngleRows> {
        let angles = self.angles.as_mut()?;
        let axes = angles.travel.as_mut()?.axes(q_nc, moved);
        let value = Estimates::of(&self.border.value);
        Some(predict(axes.to_rotation_matrix().matrix(), angles_rad, &value).1)
    }

    /// Subtracts the square of a normalized gain from the border. Two states that are considered keep their covariance
    /// (Schmidt).
    fn subtract(&mut self, of_39: &CovarianceRow, of_border: &BorderRow) {
        for (row, gain) in self.border.cross.iter_mut().zip(of_border) {
            for (p, u) in row.iter_mut().zip(of_39) {
                *p -= gain * u;
            }
        }
        for (k, row) in self.border.own.iter_mut().enumerate() {
            for (l, p) in row.iter_mut().enumerate() {
                if self.estimated[k] || self.estimated[l] {
                    *p -= of_border[k] * of_border[l];
                }
            }
        }
    }
}

impl Border {
    /// Tells the border at which angles (azimuth, roll; rad) the gimbals rest. After a move of a gimbal the rest of its
    /// encoder's error curve is another one.
    /// Returns whether this stop is another one.
    pub(super) fn stop_at(&mut self, angles_rad: [f64; 2], curve_sigma_rad: f64) -> bool {
        let GimbalReference { at, .. } = self.reference;
        let mut moved = false;
        for axis in 0..2 {
            let same = at.is_some_and(|at| (at[axis] - angles_rad[axis]).abs() < ANOTHER_STOP_RAD);
            if !same {
                self.renew(CURVE + axis, curve_sigma_rad);
                moved = true;
            }
        }
        self.reference.at = Some(angles_rad);
        moved
    }
}
