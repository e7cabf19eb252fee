//! Numbers of the golden files.

use octant_selftest::cases;
use octant_selftest::judge::Expectation;

#[test]
fn the_golden_files_have_what_is_asked_of_them() {
    let known = |id: &str| {
        let case = cases().into_iter().find(|case| case.id == id).unwrap();
        let Expectation::Numbers { known, .. } = case.expectation else { panic!("{id}") };
        known.len()
    };
    // Latitude and longitude at three times; all states of two calibrations.
    assert_eq!(known("free-inertial-growth"), 2 * 3);
    assert_eq!(known("posterior-sigma"), 2 * 39);
}
