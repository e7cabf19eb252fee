//! Squares of the attitude's error at the end of a calibration, in what the filter says of it.

use crate::plant_and_core::ClosedLoop;
use nalgebra::{Matrix2, Quaternion, UnitQuaternion, Vector2};
use octant_calibration::Core;
use octant_calibration::covariance::PHI;
use octant_earth::rotation::log;
use octant_sample::{Output, Truth};

/// Squared normalized errors of heading (one degree of freedom) and tilt (two, with their correlation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeSquares {
    /// Square of the error about down over its variance.
    pub heading: f64,
    /// Form of the errors about north and east in the inverse of their covariance: 2 in the mean.
    pub tilt: f64,
    /// Standard deviation of the heading, rad.
    pub heading_sigma_rad: f64,
}

impl AttitudeSquares {
    /// Compares attitude and truth of a calibration by the filter that was accepted, or still runs.
    pub fn of(run: &ClosedLoop) -> Self {
        Self::between(&run.core, &run.output, &run.plant.truth())
    }

    /// Compares the output of a core with the truth at its sample.
    pub fn between(core: &Core, output: &Output, truth: &Truth) -> Self {
        let covariance = match (core.concluded(), core.filter()) {
            (Some(concluded), _) => concluded.phi,
            (None, Some(filter)) => std::array::from_fn(|i| {
                std::array::from_fn(|j| filter.covariance().at(PHI + i, PHI + j))
            }),
            (None, None) => panic!("no filter: {:?}", core.refusal()),
        };
        let of =
            |[w, i, j, k]: [f64; 4]| UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        // computed = (I − [φ×]) true
        let phi = -log(&(of(output.navigation.q_nb) * of(truth.q_nb).inverse()));
        let level = Vector2::new(phi.x, phi.y);
        let tilt = Matrix2::from_fn(|i, j| covariance[i][j]);
        Self {
            heading: phi.z * phi.z / covariance[2][2],
            tilt: level.dot(&(tilt.try_inverse().unwrap() * level)),
            heading_sigma_rad: covariance[2][2].sqrt(),
        }
    }
}

/// Value that a χ² of so many degrees of freedom, divided by them, exceeds with the probability of a normal deviate
/// `z` (Wilson and Hilferty, 1931).
pub fn chi_squared_limit(degrees: f64, z: f64) -> f64 {
    let spread = 2.0 / (9.0 * degrees);
    (1.0 - spread + z * spread.sqrt()).powi(3)
}

/// Prints the mean squares of heading and tilt over independent runs, and fails where one of them has less than one
/// chance in a thousand to be as small or as large.
pub fn assert_consistent(what: &str, runs: impl Iterator<Item = AttitudeSquares>) {
    let (mut heading, mut tilt, mut count) = (0.0, 0.0, 0.0);
    for squares in runs {
        (heading, tilt, count) = (heading + squares.heading, tilt + squares.tilt, count + 1.0);
    }
    let found = [("heading", heading / count, count), ("tilt", tilt / (2.0 * count), 2.0 * count)];
    println!("{what}, {count} runs: squares of heading {:.2}, tilt {:.2}", found[0].1, found[1].1);
    for (name, mean, degrees) in found {
        let [least, most] = [-3.29, 3.29].map(|z| chi_squared_limit(degrees, z).max(0.0));
        assert!(
            (least..=most).contains(&mean),
            "{what}, {name}: {mean}, expected {least} to {most}"
        );
    }
}
