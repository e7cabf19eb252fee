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

/// Stops of weight 1: an azimuth, and the rolls that are visited there, in order.
macro_rules! stops {
    ($($azimuth:literal: $($roll:literal),+;)+) => { &[$($(($azimuth, $roll, 1.0)),+),+] };
}

/// The conventional six positions, visited forth and back in both planes: 17 stops.
pub const SIX: &[Degrees] = stops! {
    0.0: 0.0, 90.0, 180.0, 270.0, 180.0, 90.0; 90.0: 90.0; 180.0: 90.0; 270.0: 90.0;
    180.0: 90.0; 90.0: 90.0, 180.0, 270.0, 180.0, 90.0, 0.0; 0.0: 0.0;
};

/// The six with two tilts on the way, as second and as seventeenth stop, held twice as long.
const fn with_tilts(first: (f64, f64), second: (f64, f64)) -> [Degrees; SIX.len() + 2] {
    let mut all = [(0.0, 0.0, 1.0); SIX.len() + 2];
    let mut index = 0;
    while index < SIX.len() {
        let tilts = (index >= 1) as usize + (index >= 15) as usize;
        all[index + tilts] = SIX[index];
        index += 1;
    }
    all[1] = (first.0, first.1, 2.0);
    all[16] = (second.0, second.1, 2.0);
    all
}

/// Eight positions: the six with the tilts (0, 45) and (90, 45) on the way, held twice as long.
pub const EIGHT: &[Degrees] = &with_tilts((0.0, 45.0), (90.0, 45.0));

/// The eight positions with the tilts (45, 45) and (45, −45) at the same two places of the path:
/// from a level stop they turn both gimbals. They determine Gzz better than (0, 45) with (90, 45).
pub const EIGHT_LEVEL: &[Degrees] = &with_tilts((45.0, 45.0), (45.0, -45.0));

/// Negative control: the tilts (0, 45) and (0, −45) at the same two places. Both lie in one body
/// plane, and the second adds nothing to the first.
pub const EIGHT_SAME_PLANE: &[Degrees] = &with_tilts((0.0, 45.0), (0.0, -45.0));

/// Twelve different orientations for two gimbals, one gimbal a move: each axis up and down with two
/// headings. The angles are Octant's; the published twelve turn about axes that two gimbals don't
/// have, see [`FREE_TABLE`].
pub const TWELVE: &[Degrees] = stops! {
    0.0: 0.0; 180.0: 0.0, 90.0; 270.0: 90.0; 360.0: 90.0; 450.0: 90.0, 180.0;
    270.0: 180.0, 270.0; 360.0: 270.0; 450.0: 270.0; 540.0: 270.0;
};

/// Nineteen positions (Xie Bo, 2011) with two gimbals: y+90 ×3, y−90 ×3, z+90, x+90 ×3, x−90 ×3,
/// z+90 ×2, z−90 ×3. At azimuth −90° body y lies along the roll axis, at 0° body x does.
pub const NINETEEN: &[Degrees] = stops! {
    -90.0: 0.0, 90.0, 180.0, 270.0, 180.0, 90.0, 0.0;
    0.0: 0.0, 90.0, 180.0, 270.0, 180.0, 90.0, 0.0; 90.0: 0.0; 180.0: 0.0; 90.0: 0.0; 0.0: 0.0;
    -90.0: 0.0;
};

/// Twenty-four positions for two gimbals, one gimbal a move: four azimuths at each of six rolls 60°
/// apart. The angles are Octant's.
pub const TWENTY_FOUR: &[Degrees] = stops! {
    0.0: 0.0; 90.0: 0.0; 180.0: 0.0; 270.0: 0.0, 60.0; 180.0: 60.0; 90.0: 60.0;
    0.0: 60.0, 120.0; 90.0: 120.0; 180.0: 120.0; 270.0: 120.0, 180.0; 180.0: 180.0; 90.0: 180.0;
    0.0: 180.0, 240.0; 90.0: 240.0; 180.0: 240.0; 270.0: 240.0, 300.0; 180.0: 300.0;
    90.0: 300.0; 0.0: 300.0;
};

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
pub const SIXTEEN: &[Degrees] = stops! {
    0.0: 0.0, 180.0; 180.0: 180.0, 0.0; 0.0: 0.0; 180.0: 0.0, 180.0; 0.0: 180.0, 0.0, -180.0;
    -180.0: -180.0, 0.0; 0.0: 0.0; -180.0: 0.0, -180.0; 0.0: -180.0;
};

/// Half of [`TETRAHEDRAL`]: from the first of its attitudes to the last.
const TETRAHEDRAL_OUT: [Degrees; 15] = [
    (0.0, 0.0, 1.0),
    (0.0, 90.0, 1.0),
    (90.0, 90.0, 0.5),
    (180.0, 90.0, 0.5),
    (270.0, 90.0, 1.0),
    (270.0, 180.0, 1.0),
    (270.0, 270.0, 0.5),
    (360.0, 270.0, 1.0),
    (270.0, 270.0, 0.5),
    (180.0, 270.0, 1.0),
    (90.0, 270.0, 1.0),
    (90.0, 180.0, 1.0),
    (90.0, 90.0, 0.5),
    (180.0, 90.0, 0.5),
    (180.0, 0.0, 1.0),
];

/// Navigation: twelve attitudes with equal shares of the time, one gimbal a move, out and back the same
/// way. Attitudes of half weight are passed twice on each way.
///
/// Over them the mean of `c_nb` is zero, and that of the drift by g-dependent biases is
/// −g·tr(G)/3 about down: of nine independent terms the isotropic part alone is left, which is the
/// same in every attitude. Of [`SIXTEEN`] G_zz is left whole. These are the means over the
/// tetrahedral group, which gives the scheme its name; of the group itself two gimbals reach eight
/// attitudes, and six are among these twelve.
pub const TETRAHEDRAL: &[Degrees] = &out_and_back(TETRAHEDRAL_OUT);

const fn out_and_back<const N: usize>(out: [Degrees; N]) -> [Degrees; 30] {
    assert!(2 * N == 30);
    let mut all = [(0.0, 0.0, 1.0); 30];
    let mut index = 0;
    while index < N {
        all[index] = out[index];
        all[29 - index] = out[index];
        index += 1;
    }
    all
}

/// Navigation: gimbals at zero.
pub const NONE: &[Degrees] = &[(0.0, 0.0, 1.0)];

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

/// Sequences of turns about body axes, each in degrees.
macro_rules! turns {
    ($($name:literal: $($axis:ident $degrees:literal),+;)+) => {
        &[$(($name, &[$(($axis, $degrees)),+])),+]
    };
}

/// Published sequences for a table that turns freely about the body axes: name, and turns in
/// degrees. The first attitude is the one before the first turn.
///
/// - `nineteen`: Xie Bo, 2011.
/// - `twelve`: twelve turns, thirteen attitudes.
pub const FREE_TABLE: &[(&str, &[(BodyAxis, f64)])] = turns! {
    "nineteen":
        Y 90.0, Y 90.0, Y 90.0, Y -90.0, Y -90.0, Y -90.0, Z 90.0, X 90.0, X 90.0, X 90.0,
        X -90.0, X -90.0, X -90.0, Z 90.0, Z 90.0, Z -90.0, Z -90.0, Z -90.0;
    "twelve":
        X 90.0, X 90.0, Y 90.0, Z -90.0, Z -90.0, Y -90.0, X -90.0, X -90.0, Y -90.0, Z 90.0,
        Z 90.0, Y 90.0;
};

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
    extern crate std;

    use super::*;
    use std::vec::Vec;

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

    /// Mean over a scheme's dwells of what `of` makes of each attitude `c_nb` of a case that is level.
    fn mean(stops: &[Degrees], of: impl Fn(Matrix3<f64>) -> Matrix3<f64>) -> Matrix3<f64> {
        let weights: f64 = stops.iter().map(|stop| stop.2).sum();
        let sum = stops.iter().fold(Matrix3::zeros(), |sum, (azimuth, roll, weight)| {
            sum + of(frames::c_cb(azimuth.to_radians(), roll.to_radians())) * *weight
        });
        sum / weights
    }

    /// Drift in n by the g-dependent bias with a 1 at (row, column) of G, at rest, where the specific
    /// force is (0, 0, −g): C·G·Cᵀ·(0, 0, −1) for g = 1, as the first column.
    fn drift(stops: &[Degrees], row: usize, column: usize) -> nalgebra::Vector3<f64> {
        let mut g = Matrix3::zeros();
        g[(row, column)] = 1.0;
        -mean(stops, |c| c * g * c.transpose()).column(2)
    }

    #[test]
    fn the_tetrahedral_rotation_leaves_the_isotropic_part_of_g_alone() {
        assert!(mean(TETRAHEDRAL, |c| c).norm() < 1e-12);
        for row in 0..3 {
            for column in 0..3 {
                let expected = if row == column { -1.0 / 3.0 } else { 0.0 };
                let found = drift(TETRAHEDRAL, row, column);
                assert!(
                    (found - nalgebra::Vector3::new(0.0, 0.0, expected)).norm() < 1e-12,
                    "G_{row}{column}: {found}"
                );
            }
        }
        // Twelve attitudes with equal shares.
        let attitudes: Vec<Matrix3<f64>> = TETRAHEDRAL
            .iter()
            .map(|(azimuth, roll, _)| frames::c_cb(azimuth.to_radians(), roll.to_radians()))
            .collect();
        let mut distinct: Vec<(Matrix3<f64>, f64)> = Vec::new();
        for (attitude, stop) in attitudes.iter().zip(TETRAHEDRAL) {
            match distinct.iter_mut().find(|(known, _)| (known - attitude).norm() < 1e-9) {
                Some((_, share)) => *share += stop.2,
                None => distinct.push((*attitude, stop.2)),
            }
        }
        assert_eq!(distinct.len(), 12);
        assert!(distinct.iter().all(|(_, share)| *share == 2.0));
    }

    #[test]
    fn the_sixteen_moves_leave_g_zz_whole() {
        for row in 0..3 {
            for column in 0..3 {
                let whole = f64::from(u8::from((row, column) == (2, 2)));
                let found = drift(SIXTEEN, row, column);
                assert!((found.z + whole).abs() < 1e-12, "G_{row}{column}: {found}");
            }
        }
    }

    #[test]
    fn the_tetrahedral_rotation_turns_one_gimbal_a_move_and_closes() {
        let pairs = TETRAHEDRAL.iter().zip(TETRAHEDRAL.iter().skip(1));
        let moved: Vec<_> = pairs.map(|(a, b)| ((b.0 - a.0).abs(), (b.1 - a.1).abs())).collect();
        // At its turning point it stands still: the way back begins where the way out ends.
        assert!(moved.iter().enumerate().all(|(index, way)| match index {
            14 => *way == (0.0, 0.0),
            _ => *way == (90.0, 0.0) || *way == (0.0, 90.0),
        }));
        assert_eq!(TETRAHEDRAL[29], TETRAHEDRAL[0]);
    }

    #[test]
    fn the_sixteen_moves_close() {
        let (azimuth, roll, _) = SIXTEEN[15];
        assert_eq!((azimuth, roll), (0.0, -180.0), "one X+ before zero");
        assert!(moves(SIXTEEN).all(|(azimuth, roll)| azimuth != roll));
    }
}
