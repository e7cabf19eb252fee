//! The published sequences, as data: cumulative gimbal angles in degrees (azimuth, roll, weight).
//!
//! The angles of the paper's own eight positions are not published; these are Octant's, and so are
//! those of the twelve and the twenty-four for two gimbals. The two tilts of the eight lie in
//! different body planes: a second tilt in the same plane adds nothing.
//!
//! Tables of turns about body axes, as they are published for three-axis tables, are in
//! [`FREE_TABLE`].

use crate::sequence::{Sequence, SequenceError, Stop};
use nalgebra::Matrix3;
use octant_earth::{frames, rotation};

/// A stop: azimuth and roll in degrees, cumulative, and dwell relative to weight 1.
pub type Degrees = (f64, f64, f64);

/// The conventional six positions, visited forth and back in both planes: 17 stops.
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

/// The eight positions with the tilts (45, 45) and (45, −45) at the same two places of the path:
/// from a level stop they turn both gimbals. They determine Gzz better than (0, 45) with (90, 45).
pub const EIGHT_LEVEL: &[Degrees] = &[
    (0.0, 0.0, 1.0),
    (45.0, 45.0, 2.0),
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
    (45.0, -45.0, 2.0),
    (90.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
];

/// Negative control: the tilts (0, 45) and (0, −45) at the same two places. Both lie in one body
/// plane, and the second adds nothing to the first.
pub const EIGHT_SAME_PLANE: &[Degrees] = &[
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
    (0.0, -45.0, 2.0),
    (90.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
];

/// Twelve different orientations for two gimbals, one gimbal a move: each axis up and down with two
/// headings. The angles are Octant's; the published twelve turn about axes that two gimbals don't
/// have, see [`FREE_TABLE`].
pub const TWELVE: &[Degrees] = &[
    (0.0, 0.0, 1.0),
    (180.0, 0.0, 1.0),
    (180.0, 90.0, 1.0),
    (270.0, 90.0, 1.0),
    (360.0, 90.0, 1.0),
    (450.0, 90.0, 1.0),
    (450.0, 180.0, 1.0),
    (270.0, 180.0, 1.0),
    (270.0, 270.0, 1.0),
    (360.0, 270.0, 1.0),
    (450.0, 270.0, 1.0),
    (540.0, 270.0, 1.0),
];

/// Nineteen positions (Xie Bo, 2011) with two gimbals: y+90 ×3, y−90 ×3, z+90, x+90 ×3, x−90 ×3,
/// z+90 ×2, z−90 ×3. At azimuth −90° body y lies along the roll axis, at 0° body x does.
pub const NINETEEN: &[Degrees] = &[
    (-90.0, 0.0, 1.0),
    (-90.0, 90.0, 1.0),
    (-90.0, 180.0, 1.0),
    (-90.0, 270.0, 1.0),
    (-90.0, 180.0, 1.0),
    (-90.0, 90.0, 1.0),
    (-90.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
    (0.0, 90.0, 1.0),
    (0.0, 180.0, 1.0),
    (0.0, 270.0, 1.0),
    (0.0, 180.0, 1.0),
    (0.0, 90.0, 1.0),
    (0.0, 0.0, 1.0),
    (90.0, 0.0, 1.0),
    (180.0, 0.0, 1.0),
    (90.0, 0.0, 1.0),
    (0.0, 0.0, 1.0),
    (-90.0, 0.0, 1.0),
];

/// Twenty-four positions for two gimbals, one gimbal a move: four azimuths at each of six rolls 60°
/// apart. The angles are Octant's.
pub const TWENTY_FOUR: &[Degrees] = &[
    (0.0, 0.0, 1.0),
    (90.0, 0.0, 1.0),
    (180.0, 0.0, 1.0),
    (270.0, 0.0, 1.0),
    (270.0, 60.0, 1.0),
    (180.0, 60.0, 1.0),
    (90.0, 60.0, 1.0),
    (0.0, 60.0, 1.0),
    (0.0, 120.0, 1.0),
    (90.0, 120.0, 1.0),
    (180.0, 120.0, 1.0),
    (270.0, 120.0, 1.0),
    (270.0, 180.0, 1.0),
    (180.0, 180.0, 1.0),
    (90.0, 180.0, 1.0),
    (0.0, 180.0, 1.0),
    (0.0, 240.0, 1.0),
    (90.0, 240.0, 1.0),
    (180.0, 240.0, 1.0),
    (270.0, 240.0, 1.0),
    (270.0, 300.0, 1.0),
    (180.0, 300.0, 1.0),
    (90.0, 300.0, 1.0),
    (0.0, 300.0, 1.0),
];

/// Named sequences of a calibration: name, stops, and a description in one line.
pub const SEQUENCES: &[(&str, &[Degrees], &str)] = &[
    ("six", SIX, "the conventional method: six orthogonal attitudes, 17 stops"),
    ("eight", EIGHT, "the six with two tilts in different body planes, 19 stops"),
    (
        "eight-level",
        EIGHT_LEVEL,
        "the six with the tilts (45, 45) and (45, -45), which turn both gimbals, 19 stops",
    ),
    (
        "eight-same-plane",
        EIGHT_SAME_PLANE,
        "a negative control: both tilts in one body plane, 19 stops",
    ),
    ("twelve", TWELVE, "each axis up and down with two headings, angles of our own, 12 stops"),
    (
        "nineteen",
        NINETEEN,
        "the 19 positions of Xie Bo (2011), about body y, x and z from azimuth -90 deg, 19 stops",
    ),
    (
        "twenty-four",
        TWENTY_FOUR,
        "four azimuths at six rolls 60 deg apart, angles of our own, 24 stops",
    ),
];

/// Finds the stops of a named sequence of [`SEQUENCES`].
#[must_use]
pub fn named(name: &str) -> Option<&'static [Degrees]> {
    SEQUENCES.iter().find(|(known, ..)| *known == name).map(|(_, stops, _)| *stops)
}

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

/// A body axis to turn about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyAxis {
    /// Body x.
    X,
    /// Body y.
    Y,
    /// Body z.
    Z,
}

use BodyAxis::{X, Y, Z};

/// Published sequences for a table that turns freely about the body axes: name, and turns in
/// degrees. The first attitude is the one before the first turn.
///
/// - `nineteen`: Xie Bo, 2011.
/// - `twelve`: twelve turns, thirteen attitudes.
pub const FREE_TABLE: &[(&str, &[(BodyAxis, f64)])] = &[
    (
        "nineteen",
        &[
            (Y, 90.0),
            (Y, 90.0),
            (Y, 90.0),
            (Y, -90.0),
            (Y, -90.0),
            (Y, -90.0),
            (Z, 90.0),
            (X, 90.0),
            (X, 90.0),
            (X, 90.0),
            (X, -90.0),
            (X, -90.0),
            (X, -90.0),
            (Z, 90.0),
            (Z, 90.0),
            (Z, -90.0),
            (Z, -90.0),
            (Z, -90.0),
        ],
    ),
    (
        "twelve",
        &[
            (X, 90.0),
            (X, 90.0),
            (Y, 90.0),
            (Z, -90.0),
            (Z, -90.0),
            (Y, -90.0),
            (X, -90.0),
            (X, -90.0),
            (Y, -90.0),
            (Z, 90.0),
            (Z, 90.0),
            (Y, 90.0),
        ],
    ),
];

fn about(axis: BodyAxis, degrees: f64) -> Matrix3<f64> {
    let angle_rad = degrees.to_radians();
    match axis {
        X => rotation::rx(angle_rad),
        Y => rotation::ry(angle_rad),
        Z => rotation::rz(angle_rad),
    }
}

/// Iterates over the attitudes `c_cb` of a sequence of turns about body axes: `start`, and the
/// attitude after each turn.
pub fn attitudes(
    start: Matrix3<f64>,
    turns: &[(BodyAxis, f64)],
) -> impl Iterator<Item = Matrix3<f64>> + '_ {
    let after = turns.iter().scan(start, |c_cb, (axis, degrees)| {
        *c_cb *= about(*axis, *degrees);
        Some(*c_cb)
    });
    core::iter::once(start).chain(after)
}

/// Finds the first turn whose attitude two gimbals can't reach, starting from azimuth `azimuth_deg`
/// at roll 0: an attitude that isn't `Rx(roll) · Rz(azimuth)`, in which body z stays at right
/// angles to the roll axis. Returns its index; `None`: they reach all.
#[must_use]
pub fn unreachable_turn(azimuth_deg: f64, turns: &[(BodyAxis, f64)]) -> Option<usize> {
    let start = frames::c_cb(azimuth_deg.to_radians(), 0.0);
    // The roll axis is case x: the first row of c_cb. Published angles are whole degrees.
    attitudes(start, turns).skip(1).position(|c_cb| c_cb[(0, 2)].abs() > 1e-9)
}

/// Makes a sequence from degrees.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn moves(stops: &[Degrees]) -> impl Iterator<Item = (bool, bool)> + '_ {
        stops.windows(2).map(|pair| (pair[0].0 != pair[1].0, pair[0].1 != pair[1].1))
    }

    #[test]
    fn every_name_is_a_sequence_and_moves() {
        for (name, stops, _) in SEQUENCES {
            assert_eq!(named(name), Some(*stops));
            from_degrees(stops, 1).unwrap();
            for (azimuth, roll) in moves(stops) {
                assert!(azimuth || roll, "{name}");
                // The tilts of these two are reached by both gimbals together.
                let both = ["eight-level", "eight-same-plane"].contains(name);
                assert!(azimuth != roll || both, "{name}: one gimbal a move");
            }
        }
        assert_eq!(named("seven"), None);
    }

    #[test]
    fn the_eight_are_the_six_with_two_double_tilts() {
        for stops in [EIGHT, EIGHT_LEVEL, EIGHT_SAME_PLANE] {
            assert_eq!(stops.len(), SIX.len() + 2);
            let mut rest = stops.iter().filter(|stop| stop.2 == 1.0);
            assert!(SIX.iter().all(|stop| rest.next() == Some(stop)) && rest.next().is_none());
            assert_eq!((stops[1].2, stops[16].2), (2.0, 2.0));
        }
    }

    #[test]
    fn orientations_are_different() {
        for stops in [TWELVE, TWENTY_FOUR] {
            let attitude = |stop: &Degrees| frames::c_cb(stop.0.to_radians(), stop.1.to_radians());
            for (i, a) in stops.iter().enumerate() {
                for b in &stops[i + 1..] {
                    assert!((attitude(a) - attitude(b)).norm() > 0.5, "{a:?} {b:?}");
                }
            }
        }
        // Down in body is ± each axis, twice.
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let down = |stop: &&Degrees| {
                    let c_cb = frames::c_cb(stop.0.to_radians(), stop.1.to_radians());
                    (c_cb[(2, axis)] - sign).abs() < 1e-9
                };
                assert_eq!(TWELVE.iter().filter(down).count(), 2, "{axis} {sign}");
            }
        }
    }

    #[test]
    fn nineteen_turns_about_the_body_axes_of_its_source() {
        let (_, turns) = FREE_TABLE[0];
        let start = frames::c_cb(NINETEEN[0].0.to_radians(), NINETEEN[0].1.to_radians());
        assert_eq!(turns.len() + 1, NINETEEN.len());
        for (c_cb, stop) in attitudes(start, turns).zip(NINETEEN) {
            let ours = frames::c_cb(stop.0.to_radians(), stop.1.to_radians());
            assert!((c_cb - ours).norm() < 1e-12, "{stop:?}");
        }
        assert_eq!(unreachable_turn(-90.0, turns), None);
        // From azimuth 0 body y is at right angles to the roll axis: the first turn tips z over.
        assert_eq!(unreachable_turn(0.0, turns), Some(0));
    }

    #[test]
    fn two_gimbals_do_not_reach_the_published_twelve() {
        let (_, turns) = FREE_TABLE[1];
        assert_eq!(turns.len(), 12);
        // At azimuth 0, x x are rolls; the third turn, about y, tips z onto the roll axis.
        assert_eq!(unreachable_turn(0.0, turns), Some(2));
        for azimuth in [-90.0, 90.0, 180.0] {
            assert!(unreachable_turn(azimuth, turns).is_some(), "{azimuth}");
        }
    }

    #[test]
    fn the_sixteen_moves_close() {
        let (azimuth, roll, _) = SIXTEEN[15];
        assert_eq!((azimuth, roll), (0.0, -180.0), "one X+ before zero");
        assert!(moves(SIXTEEN).all(|(azimuth, roll)| azimuth != roll));
    }
}
