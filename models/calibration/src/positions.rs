//! The published sequences, as data: cumulative gimbal angles in degrees (azimuth, roll, weight).
//!
//! The angles of the paper's own eight positions are not published; these are ours. The two tilts
//! lie in different body planes: two in the same plane add nothing to one.

use crate::sequence::{Sequence, SequenceError, Stop};

type Degrees = (f64, f64, f64);

/// The conventional six positions, walked there and back in both planes: 17 stops.
pub const SIX: &[Degrees] = &[
    (0.0, 0.0, 1.0),
    (0.0, 90.0, 1.0),
    (0.0, 180.0, 1.0),
    (0.0, 270.0, 1.0),
    (0.0, 180.0, 1.0),
    (0.0, 90.0, 1.0),
    (90.0, 90.0, 1.0),
    (180.0, 90.0, 1.0),
    (270.0, 90.0, 1.0),
    (180.0, 90.0, 1.0),
    (90.0, 90.0, 1.0),
    (90.0, 180.0, 1.0),
    (90.0, 270.0, 1.0),
    (90.0, 180.0, 1.0),
    (90.0, 90.0, 1.0),
    (90.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
];

/// Eight positions: the six with the tilts (0, 45) and (90, 45) on the way, held twice as long.
pub const EIGHT: &[Degrees] = &[
    (0.0, 0.0, 1.0),
    (0.0, 45.0, 2.0),
    (0.0, 90.0, 1.0),
    (0.0, 180.0, 1.0),
    (0.0, 270.0, 1.0),
    (0.0, 180.0, 1.0),
    (0.0, 90.0, 1.0),
    (90.0, 90.0, 1.0),
    (180.0, 90.0, 1.0),
    (270.0, 90.0, 1.0),
    (180.0, 90.0, 1.0),
    (90.0, 90.0, 1.0),
    (90.0, 180.0, 1.0),
    (90.0, 270.0, 1.0),
    (90.0, 180.0, 1.0),
    (90.0, 90.0, 1.0),
    (90.0, 45.0, 2.0),
    (90.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
];

/// Navigation: sixteen moves of 180°, X+ Z+ X− Z− Z+ X+ Z− X− X− Z− X+ Z+ Z− X− Z+ X+ (X roll, Z
/// azimuth). The sixteenth move leads back to the first stop.
pub const SIXTEEN: &[Degrees] = &[
    (0.0, 0.0, 1.0),
    (0.0, 180.0, 1.0),
    (180.0, 180.0, 1.0),
    (180.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
    (180.0, 0.0, 1.0),
    (180.0, 180.0, 1.0),
    (0.0, 180.0, 1.0),
    (0.0, 0.0, 1.0),
    (0.0, -180.0, 1.0),
    (-180.0, -180.0, 1.0),
    (-180.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
    (-180.0, 0.0, 1.0),
    (-180.0, -180.0, 1.0),
    (0.0, -180.0, 1.0),
];

/// A sequence from degrees.
///
/// # Errors
/// As [`Sequence::new`].
pub fn from_degrees(stops: &[Degrees], passes: u32) -> Result<Sequence, SequenceError> {
    if stops.len() > crate::sequence::STOPS_MAX {
        return Err(SequenceError::TooLong { found: stops.len() });
    }
    let mut held = [Stop::default(); crate::sequence::STOPS_MAX];
    for (stop, (azimuth_deg, roll_deg, weight)) in held.iter_mut().zip(stops) {
        *stop = Stop {
            azimuth_rad: azimuth_deg.to_radians(),
            roll_rad: roll_deg.to_radians(),
            weight: *weight,
        };
    }
    Sequence::new(&held[..stops.len()], passes)
}
