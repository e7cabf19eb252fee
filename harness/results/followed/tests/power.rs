//! A sample of the study of power and false alarms: `examples/power`.

use octant_followed::Followed;

#[path = "../examples/power/simulate.rs"]
mod simulate;
#[path = "../examples/power/units.rs"]
mod units;

use simulate::{Course, scored};
use units::{ADAPTIVE, HONEST, Way, adaptive, honest};

fn all(kinds: usize, unit: fn(usize, u64) -> Way, expected: Followed) {
    let course = Course::new(2.0);
    for kind in 0..kinds {
        let way = unit(kind, 100 + kind as u64);
        let score = scored(&course, &way, kind as u64);
        assert_eq!(score.verdict, expected, "{}: {score:?}", way.name);
    }
}

#[test]
fn units_that_follow_are_found_to() {
    all(HONEST, honest, Followed::Followed);
}

#[test]
fn units_that_ignore_their_samples_are_found_to() {
    all(ADAPTIVE, adaptive, Followed::NotFollowed);
}
