//! Angles across north.

use crate::assert_near;
use octant_heading::angle::{band, difference, heading, mean, rounded};

#[test]
fn differences_are_within_half_a_turn_with_their_sign() {
    for (angle, from, expected) in [
        (1.0, 359.0, 2.0),
        (359.0, 1.0, -2.0),
        (180.0, 0.0, 180.0),
        (0.0, 180.0, 180.0),
        (721.5, 1.0, 0.5),
        (-0.25, 359.5, 0.25),
    ] {
        assert_near(difference(angle, from), expected, 1e-12);
    }
}

#[test]
fn a_mean_across_north_is_at_north() {
    assert_near(difference(mean(&[359.0, 1.0]).unwrap(), 0.0), 0.0, 1e-12);
    assert_near(mean(&[359.0, 0.5, 359.5]).unwrap(), 359.0 + 2.0 / 3.0, 1e-12);
    assert_near(band(&[359.9, 0.3, 359.6]).unwrap(), 0.7, 1e-12);
    assert_eq!(mean(&[]), None);
    assert_eq!(band(&[]), None);
}

#[test]
fn a_heading_is_below_360() {
    assert_eq!(heading(360.0), 0.0);
    assert_eq!(heading(-1e-20), 0.0);
    assert_near(heading(-0.1), 359.9, 1e-12);
    assert_eq!(rounded(359.96, 0.1), 0.0);
    assert_near(rounded(12.34, 0.1), 12.3, 1e-12);
    assert_eq!(rounded(12.345, 0.0), 12.345);
}
