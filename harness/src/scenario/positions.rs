//! Named position sequences: cumulative gimbal angles (azimuth, roll) and dwell weights.

use octant_calibration::sequence::Stop;
use octant_earth::units::DEG;

/// The conventional method: both gimbals through their four quarters, 17 stops.
const SIX: [(i16, i16); 17] = [
    (0, 0),
    (0, 90),
    (0, 180),
    (0, 270),
    (0, 180),
    (0, 90),
    (90, 90),
    (180, 90),
    (270, 90),
    (180, 90),
    (90, 90),
    (90, 180),
    (90, 270),
    (90, 180),
    (90, 90),
    (90, 0),
    (0, 0),
];

/// Nineteen positions (Xie Bo, 2011): y+90 ×3, y−90 ×3, z+90, x+90 ×3, x−90 ×3, z+90 ×2, z−90 ×3.
/// At azimuth −90° body y lies along the roll axis, at 0° body x does, so both gimbals reach all of
/// it. Published tables that turn about body y at roll 180° (twelve positions) are out of reach of
/// two gimbals with this order.
const NINETEEN: [(i16, i16); 19] = [
    (-90, 0),
    (-90, 90),
    (-90, 180),
    (-90, 270),
    (-90, 180),
    (-90, 90),
    (-90, 0),
    (0, 0),
    (0, 90),
    (0, 180),
    (0, 270),
    (0, 180),
    (0, 90),
    (0, 0),
    (90, 0),
    (180, 0),
    (90, 0),
    (0, 0),
    (-90, 0),
];

/// Moves of the navigation scheme, 180° each: (gimbal, sign).
const SIXTEEN: [(char, i16); 16] = [
    ('x', 1),
    ('z', 1),
    ('x', -1),
    ('z', -1),
    ('z', 1),
    ('x', 1),
    ('z', -1),
    ('x', -1),
    ('x', -1),
    ('z', -1),
    ('x', 1),
    ('z', 1),
    ('z', -1),
    ('x', -1),
    ('z', 1),
    ('x', 1),
];

fn stop(azimuth_deg: i16, roll_deg: i16, weight: f64) -> Stop {
    Stop { azimuth_rad: f64::from(azimuth_deg) * DEG, roll_rad: f64::from(roll_deg) * DEG, weight }
}

/// The stops of a named calibration sequence.
pub(crate) fn named(name: &str) -> Option<Vec<Stop>> {
    let six = || SIX.iter().map(|(azimuth, roll)| stop(*azimuth, *roll, 1.0));
    match name {
        "six" => Some(six().collect()),
        "eight" => {
            let mut stops: Vec<Stop> = six().collect();
            // The tilts lie in different body planes: two in the same plane add nothing.
            stops.insert(15, stop(90, 45, 2.0));
            stops.insert(1, stop(0, 45, 2.0));
            Some(stops)
        }
        "nineteen" => {
            Some(NINETEEN.iter().map(|(azimuth, roll)| stop(*azimuth, *roll, 1.0)).collect())
        }
        _ => None,
    }
}

/// The 16-move rotation while navigating: the stop before each move. The last move ends at the
/// first stop, where the next round begins.
pub(crate) fn sixteen() -> Vec<Stop> {
    let (mut azimuth, mut roll) = (0, 0);
    SIXTEEN
        .iter()
        .map(|(gimbal, sign)| {
            let here = stop(azimuth, roll, 1.0);
            *(if *gimbal == 'x' { &mut roll } else { &mut azimuth }) += sign * 180;
            here
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::keys::POSITIONS;
    use super::*;
    use octant_calibration::sequence::Sequence;

    #[test]
    fn every_name_is_a_checked_sequence_that_moves_one_gimbal_at_a_time() {
        for (name, _) in POSITIONS {
            let stops = named(name).unwrap();
            Sequence::new(&stops, 1).unwrap();
            for pair in stops.windows(2) {
                let azimuth = pair[0].azimuth_rad != pair[1].azimuth_rad;
                let roll = pair[0].roll_rad != pair[1].roll_rad;
                assert!(azimuth != roll, "{name}: {pair:?}");
            }
        }
    }

    #[test]
    fn six_has_17_stops_and_eight_19_with_two_double_tilts() {
        assert_eq!(named("six").unwrap().len(), 17);
        let eight = named("eight").unwrap();
        assert_eq!(eight.len(), 19);
        assert_eq!(eight[1], stop(0, 45, 2.0));
        assert_eq!(eight[16], stop(90, 45, 2.0));
        assert_eq!(eight[17], stop(90, 0, 1.0));
        assert_eq!(eight.iter().filter(|stop| stop.weight == 2.0).count(), 2);
    }

    #[test]
    fn nineteen_turns_about_the_body_axes_of_its_source() {
        use octant_earth::{Matrix3, frames, rotation};
        let turns: [(char, f64); 18] = [
            [('y', 1.0); 3].as_slice(),
            &[('y', -1.0); 3],
            &[('z', 1.0)],
            &[('x', 1.0); 3],
            &[('x', -1.0); 3],
            &[('z', 1.0); 2],
            &[('z', -1.0); 3],
        ]
        .concat()
        .try_into()
        .unwrap();
        let stops = named("nineteen").unwrap();
        for (pair, (axis, sign)) in stops.windows(2).zip(turns) {
            let [from, to] = [0, 1].map(|i| frames::c_cb(pair[i].azimuth_rad, pair[i].roll_rad));
            let about = match axis {
                'x' => rotation::rx,
                'y' => rotation::ry,
                _ => rotation::rz,
            };
            let turn: Matrix3<f64> = from * about(sign * 90.0 * DEG);
            assert!((turn - to).norm() < 1e-12, "{axis} {sign}: {pair:?}");
        }
    }

    #[test]
    fn the_sixteen_moves_close() {
        let stops = sixteen();
        assert_eq!(stops.len(), 16);
        assert_eq!(stops[15], stop(0, -180, 1.0), "one X+ before zero");
        Sequence::new(&stops, 1).unwrap();
    }
}
