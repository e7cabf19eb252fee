//! Gimbal angles as measurements: their settings, their counts and their reference.

use crate::config::AngleMeasurements;
use nalgebra::UnitQuaternion;

/// Counts of the angles as measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct AngleTally {
    /// Measurements used.
    pub used: u64,
    /// Measurements rejected by the gate.
    pub rejected: u64,
    /// Rejections in a row, so far.
    pub in_a_row: u32,
    /// Sum of NIS over the measurements used.
    pub nis_sum: f64,
    /// True once the angles contradicted the gyros for good.
    pub slipped: bool,
}

/// Settings and counts of the measurement.
#[derive(Clone, Debug)]
pub(super) struct GimbalAngleMeasurement {
    pub(super) variance_rad2: f64,
    pub(super) curve_sigma_rad: f64,
    pub(super) tally: AngleTally,
}

impl GimbalAngleMeasurement {
    pub(super) fn new(angles: &AngleMeasurements) -> Self {
        Self {
            variance_rad2: angles.sigma_rad * angles.sigma_rad,
            curve_sigma_rad: angles.curve_sigma_rad,
            tally: AngleTally::default(),
        }
    }
}

/// Reference of the gimbal angles as measurements.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct GimbalReference {
    /// Attitude of the case; `None` before the first angles.
    pub(super) q_nc: Option<UnitQuaternion<f64>>,
    /// Angles at the last measurement, azimuth and roll, rad; `None`: the stop isn't known.
    pub(super) at: Option<[f64; 2]>,
}
