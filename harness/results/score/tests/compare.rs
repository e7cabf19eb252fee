//! What a comparison of two methods tells.

use octant_score::compare::{Maxima, PairedRun, compare};
use octant_score::floor::MaximumFloor;

/// The longitude errors of a method, the same in every pair.
fn told(pairs: u64, second: f64, floor: f64) -> String {
    let run = |seed| PairedRun {
        seed,
        first: Maxima {
            longitude_24h: Some(second - 0.5 + (seed % 3) as f64 * 0.5),
            ..Maxima::default()
        },
        second: Maxima { longitude_24h: Some(second), ..Maxima::default() },
        first_refused: None,
        second_refused: None,
    };
    let runs: Vec<PairedRun> = (0..pairs).map(run).collect();
    let floor = MaximumFloor {
        hours: 24.0,
        latitude_arcmin: floor,
        longitude_arcmin: floor,
        ..MaximumFloor::default()
    };
    compare("s", "six", "eight", &runs, &[floor], Some(24.0)).words.join("; ")
}

#[test]
fn the_random_walk_hides_what_is_within_twice_of_it() {
    let hidden = "the random walk hides it";
    assert!(told(21, 7.9, 4.0).contains(hidden), "{}", told(21, 7.9, 4.0));
    assert!(!told(21, 8.1, 4.0).contains(hidden));
    assert!(told(21, 1.99, 1.0).contains(hidden));
    assert!(!told(21, 2.5, 1.0).contains(hidden));
}

#[test]
fn fewer_than_twenty_pairs_are_told_as_few() {
    let few = "seeds leave a sampling error";
    assert!(told(18, 4.0, 1.0).contains(few));
    assert!(!told(20, 4.0, 1.0).contains(few));
    assert!(!told(21, 4.0, 1.0).contains(few));
}
