//! Accelerometers from the norm of gravity: `|(I + M_a)⁻¹ (f̃ − b_a)| = g` in every static interval.
//!
//! Nine unknowns, Gauss-Newton, every interval with the same weight: the residuals of such
//! instruments come from model errors and not from white noise, which a longer mean would reduce.

use super::interval::StaticInterval;
use super::moves::{ACCEL_TERMS, Compensation, corrected};
use super::normal::solve;
use super::refusal::AdjustmentRefusal;
use nalgebra::{SMatrix, SVector};
use octant_sample::Parameters;

/// Estimates the accelerometers' parameters. Returns all parameters with these replaced, their σ,
/// and the root mean square of `|f| − g`, m/s².
pub(crate) fn estimate(
    intervals: &[StaticInterval],
    initial: &Parameters,
    gravity_mps2: f64,
) -> Result<(Parameters, [f64; 9], f64), AdjustmentRefusal> {
    if intervals.len() < 10 {
        return Err(AdjustmentRefusal::TooFewIntervals { found: intervals.len(), needed: 10 });
    }
    let mut parameters = *initial;
    for _ in 0..ITERATIONS_MAX {
        let compensation = Compensation::new(&parameters).ok_or(AdjustmentRefusal::Diverged)?;
        let mut information = SMatrix::<f64, 9, 9>::zeros();
        let mut right = SVector::<f64, 9>::zeros();
        let mut sum = 0.0;
        for interval in intervals {
            let (residual, row) = norm_row(&compensation, interval, gravity_mps2);
            information += row * row.transpose();
            right += row * residual;
            sum += residual * residual;
        }
        let (step, covariance) = solve(&information, &right, &[true; 9])
            .map_err(|index| AdjustmentRefusal::Undetermined { parameter: 21 + index })?;
        let mut all = SVector::<f64, 30>::zeros();
        all.fixed_rows_mut::<9>(21).copy_from(&step);
        parameters = corrected(&parameters, &all);
        if step.amax() < 1e-12 {
            let variance = sum / (intervals.len() - 9) as f64;
            let sigma = core::array::from_fn(|k| libm::sqrt(covariance[(k, k)] * variance));
            return Ok((parameters, sigma, libm::sqrt(sum / intervals.len() as f64)));
        }
    }
    Err(AdjustmentRefusal::Diverged)
}

/// Largest number of Gauss-Newton steps; biases wrong by 0.1 g need six.
const ITERATIONS_MAX: usize = 30;

/// `g − |f|` of an interval, and the gradient of `|f|` with respect to the nine parameters:
/// `d|f|/db = −n'A` and `d|f|/dM_ij = −(n'A)_i f_j` with `n = f/|f|`, `A = (I + M_a)⁻¹`.
pub(crate) fn norm_row(
    compensation: &Compensation,
    interval: &StaticInterval,
    gravity_mps2: f64,
) -> (f64, SVector<f64, 9>) {
    let force = compensation.force(&interval.force_mps2);
    let norm = force.norm();
    let gradient = -(compensation.accel.transpose() * force) / norm;
    let row = SVector::from_fn(|k, _| {
        let (axis, of) = ACCEL_TERMS[k];
        gradient[axis] * if of == 0 { 1.0 } else { force[of - 1] }
    });
    (gravity_mps2 - norm, row)
}
