//! Joint adjustment of static intervals in unknown (or known) attitudes, tied by the moves.
//!
//! Unknowns: the thirty parameters, and the attitude error θ of each interval, in b:
//! `c_nb = c_nb⁰ exp([θ×])`, so `c_bn v = v⁰ + [v⁰×] θ`. Each interval measures
//! ```text
//! f̃ = (I + M_a) f + b_a          f = c_bn (0, 0, −g)
//! ω̃ = (I + M_g) ω + b_g + G f    ω = c_bn ω_ie
//! ```
//! and each move, with its rotation R over a time t, `R = c_bn(0) exp(ω_ie t) c_nb(1)`.
//! Attitudes are eliminated as soon as the next one is tied to them, so that one matrix of 36 × 36
//! suffices for any number of intervals.

use super::interval::StaticInterval;
use super::moves::{ACCEL_TERMS, Compensation, GYRO_TERMS, Move, matrix};
use super::normal::solve;
use super::refusal::{AdjustmentRefusal, RESIDUAL_RMS_MAX};
use crate::standstill::{AverageUncertainty, JointAttitude};
use nalgebra::{Matrix3, Matrix6, SMatrix, SVector, UnitQuaternion, Vector3};
use octant_earth::rotation::{exp, log, skew};
use octant_sample::Parameters;

/// White noise of the sensors, variance per axis times duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Specific force, (m/s²)²·s.
    pub(crate) force: Vector3<f64>,
    /// Angular rate, rad²/s.
    pub(crate) rate: Vector3<f64>,
}

/// A move at the present parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn {
    rotation: UnitQuaternion<f64>,
    sensitivity: SMatrix<f64, 3, 12>,
    duration_s: f64,
    complete: bool,
}

impl Turn {
    /// Makes the turn of a move that was integrated with `compensation`, of the parameters
    /// `integrated_with`.
    pub(crate) fn new(
        of: &Move,
        compensation: &Compensation,
        integrated_with: &Parameters,
        parameters: &Parameters,
    ) -> Self {
        let sensitivity = of.sensitivity(&compensation.gyro);
        let (from, to) = (integrated_with.to_array(), parameters.to_array());
        let change = SVector::<f64, 12>::from_fn(|i, _| to[i] - from[i]);
        Self {
            rotation: exp(&(sensitivity * change)) * of.rotation(),
            sensitivity,
            duration_s: of.duration_s,
            complete: of.complete,
        }
    }
}

/// Prior knowledge of an attitude: a standard deviation of θ about three axes in b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AttitudePrior {
    /// Orthonormal axes in b, as columns.
    pub(crate) axes: Matrix3<f64>,
    /// Standard deviations, rad.
    pub(crate) sigma_rad: Vector3<f64>,
}

/// Number of unknowns: the parameters, the previous attitude, the present attitude.
const SIZE: usize = 36;
type Row = SVector<f64, SIZE>;

/// Sensitivity to the parameters and to the attitude of an interval.
pub(crate) type Sensitivity = SVector<f64, 33>;

/// Sensitivity of an axis' specific force to the parameters, at the force in b.
pub(crate) fn parameters_of_force(force: &Vector3<f64>, axis: usize) -> Sensitivity {
    let mut row = Sensitivity::zeros();
    for (k, (at, of)) in ACCEL_TERMS.iter().enumerate() {
        if *at == axis {
            row[21 + k] = if *of == 0 { 1.0 } else { force[of - 1] };
        }
    }
    row
}

/// The adjustment, interval by interval.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    information: SMatrix<f64, SIZE, SIZE>,
    right: Row,
    squares: f64,
    /// Number of measurements minus eliminated unknowns.
    freedom: usize,
    previous: Option<UnitQuaternion<f64>>,
    parameters: Parameters,
    gravity: Vector3<f64>,
    earth_rate: Vector3<f64>,
    noise: Noise,
    estimated: [bool; 30],
}

#[cfg(feature = "state")]
octant_state::state! {
    Chain {
        values: information, right, squares, freedom, previous;
        parts: ;
        kept: parameters, gravity, earth_rate, noise, estimated;
        check: |chain: &Self| octant_state::check_count("freedom", chain.freedom as u64)
    }
}

/// Solution of the adjustment.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    pub(crate) correction: SVector<f64, 30>,
    covariance: SMatrix<f64, 30, 30>,
    /// Uncertainty of the compensated means of the last interval.
    pub(crate) average: AverageUncertainty,
    /// Root of the mean square of the residuals in units of their noise.
    pub(crate) residual_rms: f64,
    estimated: [bool; 30],
}

impl Solution {
    /// Returns whether the last correction is small against the noise.
    pub(crate) fn settled(&self) -> bool {
        (0..30).all(|i| {
            !self.estimated[i]
                || self.correction[i].abs() <= 0.01 * libm::sqrt(self.covariance[(i, i)])
        })
    }

    /// Refuses the solution if the residuals are far above their noise.
    pub(crate) fn consistent(&self) -> Result<(), AdjustmentRefusal> {
        if self.residual_rms <= RESIDUAL_RMS_MAX {
            Ok(())
        } else {
            Err(AdjustmentRefusal::Inconsistent { residual_rms: self.residual_rms })
        }
    }

    /// σ of the estimated parameters, NaN for the others. Residuals above the noise widen it.
    pub(crate) fn sigma(&self) -> [f64; 30] {
        let factor = self.residual_rms.max(1.0);
        core::array::from_fn(|i| {
            if self.estimated[i] { factor * libm::sqrt(self.covariance[(i, i)]) } else { f64::NAN }
        })
    }
}

impl Chain {
    pub(crate) fn new(
        parameters: &Parameters,
        gravity: Vector3<f64>,
        earth_rate: Vector3<f64>,
        noise: Noise,
        estimated: [bool; 30],
    ) -> Self {
        Self {
            information: SMatrix::zeros(),
            right: Row::zeros(),
            squares: 0.0,
            freedom: 0,
            previous: None,
            parameters: *parameters,
            gravity,
            earth_rate,
            noise,
            estimated,
        }
    }

    /// Adds an interval, linearised at the attitude `q_nb`, and the move before it.
    pub(crate) fn interval(
        &mut self,
        interval: &StaticInterval,
        q_nb: &UnitQuaternion<f64>,
        turn: Option<&Turn>,
        prior: Option<&AttitudePrior>,
    ) {
        let force = q_nb.inverse() * self.gravity;
        let rate = q_nb.inverse() * self.earth_rate;
        let g = matrix(self.parameters.g_matrix());
        let accel = Matrix3::identity() + matrix(self.parameters.accel_matrix());
        let gyro = Matrix3::identity() + matrix(self.parameters.gyro_matrix());
        let force_residual =
            interval.force_mps2 - accel * force - Vector3::from(self.parameters.accel_bias);
        let rate_residual = interval.rate_radps
            - gyro * rate
            - Vector3::from(self.parameters.gyro_bias)
            - g * force;
        for axis in 0..3 {
            let (of_force, of_rate) = self.rows(&force, &rate, axis);
            let wide = |of: &Sensitivity| {
                let mut row = Row::zeros();
                row.fixed_rows_mut::<30>(0).copy_from(&of.fixed_rows::<30>(0));
                row.fixed_rows_mut::<3>(33).copy_from(&of.fixed_rows::<3>(30));
                row
            };
            let (force_row, rate_row) = (wide(&of_force), wide(&of_rate));
            self.add(force_row, force_residual[axis], self.noise.force[axis] / interval.duration_s);
            self.add(rate_row, rate_residual[axis], self.noise.rate[axis] / interval.duration_s);
        }
        if let Some(prior) = prior {
            for k in 0..3 {
                let mut row = Row::zeros();
                row.fixed_rows_mut::<3>(33).copy_from(&prior.axes.column(k));
                self.add(row, 0.0, prior.sigma_rad[k] * prior.sigma_rad[k]);
            }
        }
        if let Some(before) = self.previous {
            if let Some(turn) = turn.filter(|turn| turn.complete) {
                self.tie(&before, q_nb, turn);
            }
            self.eliminate_previous();
        } else {
            self.shift();
        }
        self.freedom -= 3;
        self.previous = Some(*q_nb);
    }

    /// Sensitivity of an axis' mean force and mean rate to the parameters and to the attitude.
    fn rows(
        &self,
        force: &Vector3<f64>,
        rate: &Vector3<f64>,
        axis: usize,
    ) -> (Sensitivity, Sensitivity) {
        let g = matrix(self.parameters.g_matrix());
        let accel = Matrix3::identity() + matrix(self.parameters.accel_matrix());
        let gyro = Matrix3::identity() + matrix(self.parameters.gyro_matrix());
        let force_turn = accel * skew(force);
        let rate_turn = gyro * skew(rate) + g * skew(force);
        let mut of_force = parameters_of_force(force, axis);
        of_force.fixed_rows_mut::<3>(30).copy_from(&force_turn.row(axis).transpose());
        let mut of_rate = Sensitivity::zeros();
        for (k, (at, of)) in GYRO_TERMS.iter().enumerate() {
            if *at == axis {
                of_rate[k] = if *of == 0 { 1.0 } else { rate[of - 1] };
            }
        }
        of_rate.fixed_rows_mut::<3>(12 + 3 * axis).copy_from(force);
        of_rate.fixed_rows_mut::<3>(30).copy_from(&rate_turn.row(axis).transpose());
        (of_force, of_rate)
    }

    /// Uncertainty of the compensated means of the last interval, without the residuals; its attitude by the whole
    /// adjustment. Covariance of the means by the parameters `p`, less what compensation removes of
    /// its noise `n`: `H P Hᵀ − H C − Cᵀ Hᵀ`, where `C`, the covariance of p with n, is `P rᵀ` with the rows `r` of the
    /// interval, whose part of the parameters is `H`, and with the posterior covariance `P` of parameters and attitude.
    /// NaN where the attitude isn't determined.
    #[inline(never)]
    fn average(&self) -> AverageUncertainty {
        let mut known = [true; 33];
        known[..30].copy_from_slice(&self.estimated);
        let information = self.information.fixed_view::<33, 33>(0, 0).into_owned();
        let right = self.right.fixed_rows::<33>(0).into_owned();
        let (force_noise, rate_noise) = (self.noise.force, self.noise.rate);
        let Ok((correction, covariance)) = solve(&information, &right, &known) else {
            let parameters = Matrix6::repeat(f64::NAN);
            return AverageUncertainty {
                parameters,
                force_noise,
                rate_noise,
                joint: None,
                residuals: (0.0, 0),
            };
        };
        let q_nb = self.previous.unwrap_or_default();
        let (force, rate) = (q_nb.inverse() * self.gravity, q_nb.inverse() * self.earth_rate);
        let mut rows = SMatrix::<f64, 6, 33>::zeros();
        for axis in 0..3 {
            let (of_force, of_rate) = self.rows(&force, &rate, axis);
            rows.row_mut(axis).copy_from(&of_force.transpose());
            rows.row_mut(3 + axis).copy_from(&of_rate.transpose());
        }
        for i in (0..30).filter(|i| !self.estimated[*i]) {
            rows.column_mut(i).fill(0.0);
        }
        let of_parameters = rows.fixed_view::<6, 30>(0, 0);
        let with_noise = of_parameters * (covariance.fixed_view::<30, 33>(0, 0) * rows.transpose());
        let of_parameters_alone =
            of_parameters * covariance.fixed_view::<30, 30>(0, 0) * of_parameters.transpose();
        AverageUncertainty {
            parameters: of_parameters_alone - with_noise - with_noise.transpose(),
            force_noise,
            rate_noise,
            joint: Some(JointAttitude {
                q_nb: q_nb * exp(&correction.fixed_rows::<3>(30).into_owned()),
                covariance: covariance.fixed_view::<3, 3>(30, 30).into_owned(),
            }),
            residuals: (0.0, 0),
        }
    }

    /// `exp(ψ) R = exp(−θ₀) Q exp(θ₁)` with `Q = c_bn(0) exp(ω_ie t) c_nb(1)`, so with
    /// `ρ = log(R Q⁻¹)` the measurement is `ρ = −J δp − θ₀ + Q θ₁`.
    fn tie(&mut self, before: &UnitQuaternion<f64>, after: &UnitQuaternion<f64>, turn: &Turn) {
        let predicted = before.inverse() * exp(&(self.earth_rate * turn.duration_s)) * after;
        let residual = log(&(turn.rotation * predicted.inverse()));
        let q = predicted.to_rotation_matrix().into_inner();
        // The axes turn through the move: their mean noise is used for each.
        let variance = self.noise.rate.mean() * turn.duration_s;
        for axis in 0..3 {
            let mut row = Row::zeros();
            row.fixed_rows_mut::<12>(0).copy_from(&-turn.sensitivity.row(axis).transpose());
            row[30 + axis] = -1.0;
            row.fixed_rows_mut::<3>(33).copy_from(&q.row(axis).transpose());
            self.add(row, residual[axis], variance);
        }
    }

    fn add(&mut self, mut row: Row, residual: f64, variance: f64) {
        for i in 0..30 {
            if !self.estimated[i] {
                row[i] = 0.0;
            }
        }
        let weight = 1.0 / variance;
        self.information.ger(weight, &row, &row, 1.0);
        self.right += row * (weight * residual);
        self.squares += weight * residual * residual;
        self.freedom += 1;
    }

    /// Eliminates the previous attitude (Schur complement); the present one takes its place.
    fn eliminate_previous(&mut self) {
        let block = self.information.fixed_view::<3, 3>(30, 30).into_owned();
        // Gravity and Earth rate, or a prior, determine every attitude; the information of an
        // undetermined one is zero, and there is nothing to pass on.
        let inverse = block.try_inverse().unwrap_or_default();
        let to = self.information.fixed_view::<36, 3>(0, 30).into_owned();
        let part = self.right.fixed_rows::<3>(30).into_owned();
        let gain = to * inverse;
        self.information -= gain * to.transpose();
        self.right -= gain * part;
        self.squares -= part.dot(&(inverse * part));
        self.shift();
    }

    fn shift(&mut self) {
        for i in 0..SIZE {
            let moved = self.information.fixed_view::<1, 3>(i, 33).into_owned();
            self.information.fixed_view_mut::<1, 3>(i, 30).copy_from(&moved);
            self.information.fixed_view_mut::<1, 3>(i, 33).fill(0.0);
        }
        for i in 0..SIZE {
            let moved = self.information.fixed_view::<3, 1>(33, i).into_owned();
            self.information.fixed_view_mut::<3, 1>(30, i).copy_from(&moved);
            self.information.fixed_view_mut::<3, 1>(33, i).fill(0.0);
        }
        let moved = self.right.fixed_rows::<3>(33).into_owned();
        self.right.fixed_rows_mut::<3>(30).copy_from(&moved);
        self.right.fixed_rows_mut::<3>(33).fill(0.0);
    }

    /// Eliminates the last attitude and solves for the parameters.
    pub(crate) fn solve(&mut self) -> Result<Solution, AdjustmentRefusal> {
        let average = self.average();
        self.eliminate_previous();
        let information = self.information.fixed_view::<30, 30>(0, 0).into_owned();
        let right = self.right.fixed_rows::<30>(0).into_owned();
        let (correction, covariance) = solve(&information, &right, &self.estimated)
            .map_err(|parameter| AdjustmentRefusal::Undetermined { parameter })?;
        let unknowns = self.estimated.iter().filter(|estimated| **estimated).count();
        let squares = (self.squares - correction.dot(&right)).max(0.0);
        let freedom = self.freedom.saturating_sub(unknowns);
        let residual_rms = if freedom > 0 { libm::sqrt(squares / freedom as f64) } else { 0.0 };
        let average = AverageUncertainty { residuals: (squares, freedom), ..average };
        let estimated = self.estimated;
        Ok(Solution { correction, covariance, average, residual_rms, estimated })
    }
}
