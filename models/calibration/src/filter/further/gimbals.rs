//! Gimbal angles as measurements: their settings, their counts and their reference.

use crate::config::{AngleMeasurements, CaseRest};
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
    /// Growth of the variance of the case's attitude, rad²/s; 0: a constant.
    pub(super) wander_rad2_per_s: f64,
    /// Turn of the case that contradicts a case at rest, rad.
    pub(super) range_rad: f64,
    pub(super) tally: AngleTally,
    /// `None` where no case is said to rest.
    pub(super) travel: Option<CaseTravel>,
}

impl GimbalAngleMeasurement {
    /// Makes the measurement; `rest`: the case is known to turn by no more than that.
    pub(super) fn new(angles: &AngleMeasurements, rest: Option<CaseRest>) -> Self {
        let wander = rest.map_or(0.0, |rest| rest.wander_rad_per_sqrt_s);
        Self {
            variance_rad2: angles.sigma_rad * angles.sigma_rad,
            curve_sigma_rad: angles.curve_sigma_rad,
            wander_rad2_per_s: wander * wander,
            range_rad: rest.map_or(f64::INFINITY, |rest| rest.range_rad),
            tally: AngleTally::default(),
            travel: rest.map(|_| CaseTravel::default()),
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

/// Attitude of the case at the first measurement with its variances about the axes of n, and the turn that exceeded
/// the range by most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct CaseTravel {
    /// Attitude of the case at the first measurement of the present stop.
    axes: Option<UnitQuaternion<f64>>,
    pub(super) first: Option<(UnitQuaternion<f64>, [f64; 3])>,
    /// Turn and limit, rad.
    pub(super) beyond: Option<(f64, f64)>,
}

impl CaseTravel {
    /// Attitude of the case with which a stop is linearised; `moved`: it is another one.
    pub(super) fn axes(&mut self, q_nc: &UnitQuaternion<f64>, moved: bool) -> UnitQuaternion<f64> {
        if moved {
            self.axes = None;
        }
        *self.axes.get_or_insert(*q_nc)
    }
}
