//! Solutions of the core, and their errors.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::rotation::log;
use octant_sample::{Mode, Output, Truth};

/// Returns whether a core in this mode has a solution that can be compared with the truth.
#[must_use]
pub const fn is_solution(mode: Mode) -> bool {
    matches!(mode, Mode::Calibrating | Mode::Navigating | Mode::Done)
}

/// Attitude as a unit quaternion; `None` for one that isn't: a core that hasn't aligned yet has zeros.
#[must_use]
pub fn unit_attitude(q_wxyz: &[f64; 4]) -> Option<UnitQuaternion<f64>> {
    let [w, x, y, z] = *q_wxyz;
    let q = Quaternion::new(w, x, y, z);
    let norm = q.norm();
    ((norm - 1.0).abs() < 1e-3).then(|| UnitQuaternion::new_normalize(q))
}

/// Errors of a solution: navigation minus truth, north, east, down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigationErrors {
    /// Position, m, with the radii of curvature at the true position.
    pub position_ned_m: [f64; 3],
    /// Velocity, m/s.
    pub velocity_ned_mps: [f64; 3],
    /// Rotation vector that turns the true attitude into the estimated one, rad.
    pub attitude_ned_rad: Option<[f64; 3]>,
}

impl NavigationErrors {
    /// Compares an output with the truth of its epoch.
    #[must_use]
    pub fn of(output: &Output, truth: &Truth) -> Self {
        let navigation = &output.navigation;
        let earth = Ellipsoid::at(truth.latitude_rad, truth.height_m);
        let latitude_rad = navigation.latitude_rad - truth.latitude_rad;
        let longitude_rad = navigation.longitude_rad - truth.longitude_rad;
        let attitude_ned_rad = unit_attitude(&navigation.q_nb)
            .zip(unit_attitude(&truth.q_nb))
            .map(|(estimated, truth)| attitude_error(&estimated, &truth).into());
        Self {
            position_ned_m: [
                latitude_rad * earth.meridian_radius_m,
                longitude_rad * earth.transverse_radius_m * earth.cos_latitude,
                truth.height_m - navigation.height_m,
            ],
            velocity_ned_mps: std::array::from_fn(|i| {
                navigation.velocity_mps[i] - truth.velocity_mps[i]
            }),
            attitude_ned_rad,
        }
    }
}

/// Rotation vector in n, rad, that turns the true attitude into the estimated one.
#[must_use]
pub fn attitude_error(
    estimated_nb: &UnitQuaternion<f64>,
    true_nb: &UnitQuaternion<f64>,
) -> Vector3<f64> {
    log(&(estimated_nb * true_nb.inverse()))
}
