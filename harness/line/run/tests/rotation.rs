//! Rotations that leave the drift to g_zz alone.

use octant_calibration::positions::{NONE, SIXTEEN, TETRAHEDRAL, from_degrees};
use octant_run::assemble::leaves_g_zz_alone;

#[test]
fn the_tetrahedral_rotation_mixes_all_three_axes() {
    for (stops, alone) in [(SIXTEEN, true), (NONE, true), (TETRAHEDRAL, false)] {
        assert_eq!(leaves_g_zz_alone(&from_degrees(stops, 1).unwrap()), alone);
    }
    // One short stop with another axis down is enough.
    let tilted = [(0.0, 0.0, 1.0), (0.0, 90.0, 0.001)];
    assert!(!leaves_g_zz_alone(&from_degrees(&tilted, 1).unwrap()));
}
