//! The null space of position sequences, against algebra by hand.

use octant_earth::units::DEG;
use octant_observe::static_rank::{StaticRank, factor, static_rank};

const SIX: &[(f64, f64)] = &[
    (0.0, 0.0),
    (0.0, 90.0),
    (0.0, 180.0),
    (0.0, 270.0),
    (0.0, 180.0),
    (0.0, 90.0),
    (90.0, 90.0),
    (180.0, 90.0),
    (270.0, 90.0),
    (180.0, 90.0),
    (90.0, 90.0),
    (90.0, 180.0),
    (90.0, 270.0),
    (90.0, 180.0),
    (90.0, 90.0),
    (90.0, 0.0),
    (0.0, 0.0),
];

fn with_tilts(tilts: &[(f64, f64)], heading_deg: f64, vertical: bool) -> StaticRank {
    let stops: Vec<_> = SIX.iter().chain(tilts).map(|(a, r)| (a * DEG, r * DEG)).collect();
    static_rank(&stops, 30.5 * DEG, heading_deg * DEG, vertical)
}

fn null_space(tilts: &[(f64, f64)], vertical: bool) -> (usize, Vec<String>) {
    // The answer depends on the sequence alone: no heading may change it.
    let answers = [0.0, 20.0, 137.0].map(|heading| with_tilts(tilts, heading, vertical));
    assert_eq!(answers[0], answers[1]);
    assert_eq!(answers[0], answers[2]);
    let [first, ..] = answers;
    assert_eq!(first.rank + first.null_space.len(), first.unknowns);
    (first.rank, first.null_space)
}

#[test]
fn six_positions_leave_the_diagonal_of_g() {
    let names = ["Gxx", "Gyy", "Gzz"].map(String::from).to_vec();
    assert_eq!(null_space(&[], false), (10, names));
}

#[test]
fn two_tilts_in_different_planes_leave_the_isotropic_part_alone() {
    let isotropic = vec![String::from("Gxx + Gyy + Gzz")];
    for tilts in [
        [(0.0, 45.0), (90.0, 45.0)],
        [(45.0, 45.0), (45.0, -45.0)],
        [(45.0, 54.74), (45.0, 125.26)],
    ] {
        assert_eq!(null_space(&tilts, false), (12, isotropic.clone()), "{tilts:?}");
    }
}

#[test]
fn a_second_tilt_in_the_same_plane_adds_nothing() {
    let expected = (11, vec![String::from("Gxx"), String::from("Gyy + Gzz")]);
    assert_eq!(null_space(&[(0.0, 45.0), (0.0, -45.0)], false), expected);
    assert_eq!(null_space(&[(0.0, 45.0)], false), expected);
}

#[test]
fn vertical_drift_shows_everything() {
    for tilts in [&[][..], &[(0.0, 45.0), (90.0, 45.0)]] {
        assert_eq!(null_space(tilts, true), (13, vec![]));
    }
}

#[test]
fn tilts_that_are_hardly_tilts_do_not_count() {
    // 0.01° from a face: rank that comes from rounding of a user's angles doesn't count.
    assert_eq!(null_space(&[(0.0, 0.01), (90.0, 0.01)], false), null_space(&[], false));
    // 5° are small, but observed.
    assert_eq!(null_space(&[(0.0, 5.0), (90.0, 5.0)], false).0, 12);
}

#[test]
fn one_attitude_sees_two_combinations_and_no_attitude_none() {
    let one = static_rank(&[(0.0, 0.0)], 0.5, 0.0, false);
    // North: bx − Gxz. East: by − Gyz + cos L · azimuth.
    assert_eq!((one.rank, one.null_space.len()), (2, 11));
    assert!(one.null_space.contains(&"Gxz + bx".to_owned()), "{one:?}");
    let none = static_rank(&[], 0.5, 0.0, true);
    assert_eq!((none.rank, none.null_space.len()), (0, 13));
}

#[test]
fn at_a_pole_azimuth_leaves_no_trace() {
    let stops: Vec<_> = SIX.iter().map(|(a, r)| (a * DEG, r * DEG)).collect();
    let pole = static_rank(&stops, 90.0 * DEG, 0.0, true);
    assert_eq!((pole.rank, pole.null_space), (12, vec![String::from("azimuth")]));
}

#[test]
fn coefficients_read_as_small_fractions() {
    assert_eq!(factor(1.0), "");
    assert_eq!(factor(2.0), "2 ");
    assert_eq!(factor(0.5), "1/2 ");
    assert_eq!(factor(1.0 / 3.0), "1/3 ");
    assert_eq!(factor(0.123_456), "0.1235 ");
}

#[test]
fn the_rank_of_the_named_sequences() {
    use octant_calibration::positions::SEQUENCES;
    for (name, stops, _) in SEQUENCES {
        let stops: Vec<_> = stops.iter().map(|(a, r, _)| (a * DEG, r * DEG)).collect();
        let found = static_rank(&stops, 30.5 * DEG, 0.0, false);
        // Orthogonal attitudes alone leave the diagonal of G; tilts in two planes its trace.
        let expected = match *name {
            "six" | "twelve" | "nineteen" => 10,
            "eight-same-plane" => 11,
            _ => 12,
        };
        assert_eq!(found.rank, expected, "{name}: {:?}", found.null_space);
    }
}
