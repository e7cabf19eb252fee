//! Effect of the rotation in navigation on the drift by g-dependent biases.

use octant_calibration::sequence::Sequence;
use octant_earth::frames::c_cb;

/// Returns whether the mean vertical drift over the dwells of a rotation is that of g_zz alone: the
/// references of a run are closed forms for it. The case is level.
///
/// At rest the drift down by G is −g·rᵀ·G·r, where r is down in the body, so its mean has each element of
/// G with its share of the mean of r·rᵀ.
pub(super) fn leaves_g_zz_alone(rotation: &Sequence) -> bool {
    let stops = rotation.stops();
    let weights: f64 = stops.iter().map(|stop| stop.weight).sum();
    // The mean of r·rᵀ has trace 1 and no negative eigenvalue: where zz is 1, all others are 0.
    let share = stops.iter().fold(0.0, |sum, stop| {
        let down = c_cb(stop.azimuth_rad, stop.roll_rad)[(2, 2)];
        sum + stop.weight * down * down
    });
    share / weights > 1.0 - 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_calibration::positions::{NONE, SIXTEEN, TETRAHEDRAL, from_degrees};

    #[test]
    fn the_tetrahedral_rotation_mixes_all_three_axes() {
        for (stops, alone) in [(SIXTEEN, true), (NONE, true), (TETRAHEDRAL, false)] {
            assert_eq!(leaves_g_zz_alone(&from_degrees(stops, 1).unwrap()), alone);
        }
        // One short stop with another axis down is enough.
        let tilted = [(0.0, 0.0, 1.0), (0.0, 90.0, 0.001)];
        assert!(!leaves_g_zz_alone(&from_degrees(&tilted, 1).unwrap()));
    }
}
