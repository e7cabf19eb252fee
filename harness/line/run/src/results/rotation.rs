//! Effect of the rotation in navigation on the drift by g-dependent biases.

use octant_calibration::sequence::Sequence;
use octant_earth::frames::c_cb;

/// Returns whether the mean vertical drift over the dwells of a rotation is that of g_zz alone: the
/// references of a run are closed forms for it. The case is level.
///
/// At rest the drift down by G is −g·rᵀ·G·r, where r is down in the body, so its mean has each element of
/// G with its share of the mean of r·rᵀ.
#[must_use]
pub fn leaves_g_zz_alone(rotation: &Sequence) -> bool {
    let stops = rotation.stops();
    let weights: f64 = stops.iter().map(|stop| stop.weight).sum();
    // The mean of r·rᵀ has trace 1 and no negative eigenvalue: where zz is 1, all others are 0.
    let share = stops.iter().fold(0.0, |sum, stop| {
        let down = c_cb(stop.azimuth_rad, stop.roll_rad)[(2, 2)];
        sum + stop.weight * down * down
    });
    share / weights > 1.0 - 1e-9
}
