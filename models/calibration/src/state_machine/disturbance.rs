//! A disturbance on a base at rest, and what the filter was opened by for it.

use nalgebra::{Matrix3, Vector3};

/// A disturbance of the sensors on a base at rest, and the variances added to the filter for it.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Disturbance {
    /// Turn and velocity beyond the known motion, in n, rad and m/s.
    pub(super) turned: Vector3<f64>,
    pub(super) moved: Vector3<f64>,
    /// Variances added for the turn, the velocity, and the velocity by the turn.
    pub(super) opened: [Matrix3<f64>; 3],
    /// Variance added for encoders and axes, rad².
    pub(super) axes: f64,
}

impl Disturbance {
    /// Returns the missing part of the variance along a vector, and adds it to the account.
    pub(super) fn open(&mut self, which: usize, along: Vector3<f64>) -> Matrix3<f64> {
        let square = along.norm_squared();
        if square == 0.0 {
            return Matrix3::zeros();
        }
        let there = along.dot(&(self.opened[which] * along)) / square;
        let missing = along * along.transpose() * ((square - there).max(0.0) / square);
        self.opened[which] += missing;
        missing
    }
}
