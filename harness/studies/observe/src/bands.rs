//! Bands of an error over an ensemble.

use super::covariance::MotionError;
use octant_earth::frames::case_of_phi;
use octant_earth::units::ARCMIN;
use octant_statistics::normal;
use serde::{Deserialize, Serialize};

/// A signed error over the ensemble.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorBand {
    /// Mean.
    pub mean: f64,
    /// σ about the mean.
    pub sigma: f64,
    /// 5th percentile.
    pub p5: f64,
    /// Median.
    pub p50: f64,
    /// 95th percentile.
    pub p95: f64,
}

impl ErrorBand {
    /// Band of a normal distribution.
    #[must_use]
    pub fn of(mean: f64, sigma: f64) -> Self {
        let percentile = |p: f64| mean + sigma * normal::quantile(p);
        Self { mean, sigma, p5: percentile(0.05), p50: mean, p95: percentile(0.95) }
    }
}

/// Attitude error of the case and velocity error over the ensemble at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolutionBands {
    /// Heading error, arcmin.
    pub heading_arcmin: ErrorBand,
    /// Pitch error, arcmin.
    pub pitch_arcmin: ErrorBand,
    /// Roll error, arcmin.
    pub roll_arcmin: ErrorBand,
    /// Error of the velocity to the north, m/s.
    pub velocity_north_mps: ErrorBand,
    /// Error of the velocity to the east, m/s.
    pub velocity_east_mps: ErrorBand,
}

impl SolutionBands {
    /// Bands of an attitude and velocity error, at the mean heading and pitch of the case, rad.
    #[must_use]
    pub fn of(at: &MotionError, heading_rad: f64, pitch_rad: f64) -> Self {
        let to_case = case_of_phi(heading_rad, pitch_rad);
        let mean = to_case * at.mean_phi_rad;
        let covariance = to_case * at.phi_rad2 * to_case.transpose();
        let angle = |axis: usize| {
            ErrorBand::of(
                mean[axis] / ARCMIN,
                libm::sqrt(covariance[(axis, axis)].max(0.0)) / ARCMIN,
            )
        };
        let velocity = |axis: usize| {
            ErrorBand::of(at.mean_mps[axis], libm::sqrt(at.variances_m2ps2[axis].max(0.0)))
        };
        Self {
            heading_arcmin: angle(0),
            pitch_arcmin: angle(1),
            roll_arcmin: angle(2),
            velocity_north_mps: velocity(0),
            velocity_east_mps: velocity(1),
        }
    }

    /// Bands in the order of the scores of a navigation: heading, pitch, roll, north, east.
    #[must_use]
    pub fn all(&self) -> [ErrorBand; 5] {
        [
            self.heading_arcmin,
            self.pitch_arcmin,
            self.roll_arcmin,
            self.velocity_north_mps,
            self.velocity_east_mps,
        ]
    }
}
