//! Gyros that don't resolve Earth rate, from gravity turned between static attitudes.
//!
//! The bias is the mean rate of the first static interval. The nine terms of M_g make the rotation
//! in each move turn the gravity measured before it into the gravity measured after it
//! (D. Tedaldi, A. Pretto, E. Menegatti, *A robust and easy to implement method for IMU calibration
//! without external equipments*, ICRA 2014). Earth rate remains in the bias: that is the limit of
//! the method, and far below the noise of the gyros for which it is made.

use super::interval::StaticInterval;
use super::moves::{Compensation, Move};
use super::normal::solve;
use super::refusal::AdjustmentRefusal;
use nalgebra::{SMatrix, SVector};
use octant_earth::rotation::{exp, skew};

/// Estimates the correction to S_g and M_g (nine, in the order of the parameters), their σ, and the
/// root mean square residual of the unit gravity vector.
///
/// `moves[k]` leads from interval k to interval k + 1; the moves were integrated with
/// `compensation`; forces are compensated with `accel`.
pub(crate) fn estimate(
    intervals: &[StaticInterval],
    moves: &[Move],
    compensation: &Compensation,
    accel: &Compensation,
) -> Result<(SVector<f64, 9>, [f64; 9], f64), AdjustmentRefusal> {
    let complete = moves.iter().filter(|m| m.complete).count();
    if complete < 6 {
        return Err(AdjustmentRefusal::TooFewMoves { found: complete, needed: 6 });
    }
    let mut correction = SVector::<f64, 9>::zeros();
    for _ in 0..ITERATIONS_MAX {
        let mut information = SMatrix::<f64, 9, 9>::zeros();
        let mut right = SVector::<f64, 9>::zeros();
        let mut sum = 0.0;
        for (pair, turn) in intervals.windows(2).zip(moves).filter(|(_, turn)| turn.complete) {
            let before = accel.force(&pair[0].force_mps2).normalize();
            let after = accel.force(&pair[1].force_mps2).normalize();
            let j = turn.sensitivity(&compensation.gyro).fixed_columns::<9>(3).into_owned();
            let back = turn.rotation().inverse().to_rotation_matrix().into_inner();
            let turned = exp(&-(j * correction)) * before;
            let residual = after - back * turned;
            let rows = back * skew(&turned) * j;
            information += rows.transpose() * rows;
            right += rows.transpose() * residual;
            sum += residual.norm_squared();
        }
        let (step, covariance) = solve(&information, &right, &[true; 9])
            .map_err(|index| AdjustmentRefusal::Undetermined { parameter: 3 + index })?;
        correction += step;
        if step.amax() < 1e-12 {
            // Two of the three components of a direction are free.
            let variance = sum / (2 * complete - 9) as f64;
            let sigma = core::array::from_fn(|k| libm::sqrt(covariance[(k, k)] * variance));
            return Ok((correction, sigma, libm::sqrt(sum / (3 * complete) as f64)));
        }
    }
    Err(AdjustmentRefusal::Diverged)
}

/// Largest number of steps; scale factors wrong by a quarter need sixteen: the residuals stay large
/// while the moves are linearised about such values.
const ITERATIONS_MAX: usize = 50;
