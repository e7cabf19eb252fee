//! Slips of gimbals against encoders, and the tolerance of a set point.

use crate::config::Screening;
use nalgebra::UnitQuaternion;
use octant_sample::GimbalAngles;
use octant_sample::counts::GIMBAL_LSB_RAD;

const DEG: f64 = core::f64::consts::PI / 180.0;

/// Largest difference of encoder and set point in a dwell, rad: a coarse limit, and a fine one if
/// the gimbals are checked. A servo reaches its set point, so the fine limit is the larger of a
/// tenth of a degree and a difference that an encoder of this σ shows once in 1e15 readings.
const COARSE_TOLERANCE_RAD: f64 = 0.5 * DEG;
const TOLERANCE_RAD: f64 = 0.1 * DEG;
const TOLERANCE_SIGMAS: f64 = 8.0;

/// Attitude of the case at the last comparison, with the encoder angles.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Slips {
    pub(super) last: Option<(UnitQuaternion<f64>, GimbalAngles)>,
    /// Number of slips so far.
    pub(super) count: u64,
}

/// Tolerance of encoder against set point, counts.
pub(super) fn tolerance_counts(screening: &Screening) -> u64 {
    let tolerance = if screening.gimbals {
        TOLERANCE_RAD.max(TOLERANCE_SIGMAS * screening.encoder_sigma_rad)
    } else {
        COARSE_TOLERANCE_RAD
    };
    (tolerance / GIMBAL_LSB_RAD) as u64
}
