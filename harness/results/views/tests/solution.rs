//! Attitudes, and their errors.

use nalgebra::Vector3;
use octant_earth::rotation::exp;
use octant_views::solution::{attitude_error, unit_attitude};

#[test]
fn an_error_is_told_about_the_axis_it_is_made_about() {
    let truth = exp(&Vector3::new(0.3, -1.0, 0.4));
    let phi = Vector3::new(1e-4, -2e-4, 3e-4);
    let found = attitude_error(&(exp(&phi) * truth), &truth);
    assert!((found - phi).norm() < 1e-12, "{found}");
}

#[test]
fn zeros_are_no_attitude() {
    assert_eq!(unit_attitude(&[0.0; 4]), None);
    assert!(unit_attitude(&[1.0, 0.0, 0.0, 0.0]).is_some());
    assert_eq!(unit_attitude(&[f64::NAN, 0.0, 0.0, 0.0]), None);
}
