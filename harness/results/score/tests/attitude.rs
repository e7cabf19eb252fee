//! Heading, pitch and roll of the case.

use octant_earth::frames::{c_cb, c_nc, quaternion_from_matrix};
use octant_earth::rotation::exp;
use octant_earth::units::{ARCMIN, DEG};
use octant_earth::{UnitQuaternion, Vector3};
use octant_score::attitude::CaseAngles;

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected}");
}

fn numbers(q: &UnitQuaternion<f64>) -> [f64; 4] {
    [q.w, q.i, q.j, q.k]
}

#[test]
fn errors_of_the_case_are_differences_of_its_angles_at_any_place_of_the_gimbals() {
    let (truth, computed) = ([3.13, 0.08, -0.3], [-3.12, 0.05, -0.27]);
    for gimbal in [[0.0, 0.0], [1.2, -0.7], [core::f64::consts::PI, 1.6], [20.0, 9.4]] {
        let body = |[heading, pitch, roll]: [f64; 3]| {
            let c = c_nc(heading, pitch, roll) * c_cb(gimbal[0], gimbal[1]);
            numbers(&quaternion_from_matrix(&c))
        };
        let error = CaseAngles::error(body(computed), body(truth), gimbal);
        near(error.heading_rad, computed[0] - truth[0] + 2.0 * core::f64::consts::PI, 1e-14);
        near(error.pitch_rad, -0.03, 1e-14);
        near(error.roll_rad, 0.03, 1e-14);
        let attitude = CaseAngles::of(body(truth), gimbal);
        near(attitude.heading_rad, truth[0], 1e-14);
        near(attitude.pitch_rad, truth[1], 1e-14);
        near(attitude.roll_rad, truth[2], 1e-14);
    }
}

#[test]
fn a_misalignment_shows_with_its_sign() {
    // c_nb(computed) = (I − [φ×]) c_nb(true): the computed frame is turned by −φ in n.
    let phi = Vector3::new(0.4 * ARCMIN, -0.7 * ARCMIN, 3.0 * ARCMIN);
    let truth = quaternion_from_matrix(&c_cb(0.4, 2.0));
    let computed = exp(&-phi) * truth;
    let error = CaseAngles::error(numbers(&computed), numbers(&truth), [0.4, 2.0]);
    near(error.heading_rad, -phi.z, 1e-3 * ARCMIN);
    near(error.pitch_rad, -phi.y, 4e-3 * ARCMIN);
    near(error.roll_rad, -phi.x, 4e-3 * ARCMIN);
    // At heading 90° the bow points east: pitch is about −x of n, roll about y of n.
    let east = quaternion_from_matrix(&c_nc(90.0 * DEG, 0.0, 0.0));
    let error = CaseAngles::error(numbers(&(exp(&-phi) * east)), numbers(&east), [0.0; 2]);
    near(error.pitch_rad, phi.x, 4e-3 * ARCMIN);
    near(error.roll_rad, -phi.y, 4e-3 * ARCMIN);
}

#[test]
fn tiny_errors_of_large_angles_keep_their_digits() {
    let truth = quaternion_from_matrix(&c_nc(-3.0, 0.1, 0.2));
    let computed = quaternion_from_matrix(&c_nc(-3.0 + 1e-12, 0.1, 0.2));
    let error = CaseAngles::error(numbers(&computed), numbers(&truth), [0.0; 2]);
    near(error.heading_rad, 1e-12, 2e-15);
}
