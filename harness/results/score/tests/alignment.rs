//! Attitude and velocity at one time with their σ.

use octant_earth::Matrix3;
use octant_earth::frames::{c_nc, quaternion_from_matrix};
use octant_earth::rotation::exp;
use octant_earth::units::{ARCMIN, DEG};
use octant_earth::{UnitQuaternion, Vector3};
use octant_score::alignment::{SolutionPoint, SolutionScore, SolutionUncertainty, case_sigma};
use octant_score::attitude::CaseAngles;

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected}");
}

#[test]
fn sigmas_of_the_case_are_those_of_its_errors() {
    // Each column of a square root of the covariance is a φ; its error of the case, found by
    // turning the attitude, adds to the variance.
    let attitude = CaseAngles { heading_rad: 2.0, pitch_rad: 0.3, roll_rad: -0.2 };
    let root = Matrix3::new(3.0, 0.0, 0.0, 1.0, 2.0, 0.0, -4.0, 0.5, 20.0) * 1e-7;
    let phi = root * root.transpose();
    let found = case_sigma(&core::array::from_fn(|i| [0, 1, 2].map(|j| phi[(i, j)])), &attitude);
    let truth = quaternion_from_matrix(&c_nc(2.0, 0.3, -0.2));
    let numbers = |q: &UnitQuaternion<f64>| [q.w, q.i, q.j, q.k];
    let mut variance = [0.0; 3];
    for column in root.column_iter() {
        let computed = exp(&-Vector3::new(column[0], column[1], column[2])) * truth;
        let error = CaseAngles::error(numbers(&computed), numbers(&truth), [0.0; 2]);
        let errors = [error.heading_rad, error.pitch_rad, error.roll_rad];
        variance.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error * error);
    }
    for axis in 0..3 {
        near(found[axis] / variance[axis].sqrt(), 1.0, 1e-5);
    }
}

#[test]
fn a_score_has_what_is_known() {
    let point = SolutionPoint {
        attitude: Some(CaseAngles { heading_rad: 90.0 * DEG, ..CaseAngles::default() }),
        attitude_error: Some(CaseAngles {
            heading_rad: 6.0 * ARCMIN,
            pitch_rad: ARCMIN,
            roll_rad: -3.0 * ARCMIN,
        }),
        velocity_error_mps: Some([0.02, -0.01]),
    };
    let mut phi = [[0.0; 3]; 3];
    (phi[0][0], phi[1][1], phi[2][2]) =
        (ARCMIN * ARCMIN, 4.0 * ARCMIN * ARCMIN, 9.0 * ARCMIN * ARCMIN);
    let uncertainty = SolutionUncertainty { phi, velocity_mps: [0.01, 0.01] };
    let score = SolutionScore::of(&point, Some(&uncertainty));
    near(score.heading_deg.unwrap(), 90.0, 1e-12);
    near(score.heading_arcmin.normalized.unwrap(), 2.0, 1e-12);
    // The bow points east: pitch is about north (σ 1 arcmin), roll about east (σ 2 arcmin).
    near(score.pitch_arcmin.sigma.unwrap(), 1.0, 1e-12);
    near(score.roll_arcmin.normalized.unwrap(), -1.5, 1e-12);
    near(score.velocity_north_mps.normalized.unwrap(), 2.0, 1e-12);
    let without = SolutionScore::of(&point, None);
    assert_eq!(without.heading_arcmin.sigma, None);
    assert_eq!(without.heading_arcmin.normalized, None);
    near(without.roll_arcmin.error.unwrap(), -3.0, 1e-12);
    let nothing = SolutionScore::of(&SolutionPoint::default(), Some(&uncertainty));
    assert_eq!((nothing.heading_deg, nothing.heading_arcmin.error), (None, None));
}
