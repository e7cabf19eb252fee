//! Result of an alignment: attitude and velocity at one time, with σ and errors.

use super::attitude::CaseAngles;
use octant_earth::Matrix3;
use octant_earth::frames::case_of_phi;
use octant_earth::units::{ARCMIN, DEG};
use serde::{Deserialize, Serialize};

/// Reference that an attitude was found from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AlignmentReference {
    /// Gravity and Earth rate at rest, or a velocity that is known to be zero.
    Static,
    /// The position of a berth.
    Dockside,
    /// Attitude and velocity were handed over, or are those of an external turntable.
    External,
}

impl AlignmentReference {
    /// Name, as in the file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::Dockside => "dockside",
            Self::External => "external",
        }
    }
}

/// Alignment of one method: the way to its first attitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlignmentResult {
    /// Reference.
    pub reference: AlignmentReference,
    /// Duration, s; 0 for an attitude that was handed over.
    pub duration_s: f64,
    /// Solution at its end.
    pub solution: SolutionScore,
}

/// Error of one quantity at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointScore {
    /// Computed minus true; null without truth.
    pub error: Option<f64>,
    /// σ that the filter states; null where there is no covariance.
    pub sigma: Option<f64>,
    /// error/σ; null if one of them is.
    pub normalized: Option<f64>,
}

impl PointScore {
    fn of(error: Option<f64>, sigma: Option<f64>) -> Self {
        let sigma = sigma.filter(|sigma| sigma.is_finite());
        let pair = error.zip(sigma.filter(|sigma| *sigma > 0.0));
        Self { error, sigma, normalized: pair.map(|(error, sigma)| error / sigma) }
    }
}

/// Attitude of the case and velocity at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolutionScore {
    /// Computed heading of the case by the gimbals' encoders, deg, −180 to 180; null where the unit
    /// doesn't tell its attitude, or the gimbal angles aren't known: no encoders, and gimbals that move.
    pub heading_deg: Option<f64>,
    /// Computed pitch of the case, deg.
    pub pitch_deg: Option<f64>,
    /// Computed roll of the case, deg.
    pub roll_deg: Option<f64>,
    /// Heading error of the case, arcmin.
    pub heading_arcmin: PointScore,
    /// Pitch error of the case, arcmin.
    pub pitch_arcmin: PointScore,
    /// Roll error of the case, arcmin.
    pub roll_arcmin: PointScore,
    /// Error of the velocity over ground to the north, m/s.
    pub velocity_north_mps: PointScore,
    /// Error of the velocity over ground to the east, m/s.
    pub velocity_east_mps: PointScore,
}

/// Solution at one time, SI; `None`: not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolutionPoint {
    /// Attitude of the case, computed, with the gimbals turned back by their encoders.
    pub attitude: Option<CaseAngles>,
    /// Its error.
    pub attitude_error: Option<CaseAngles>,
    /// Error of the velocity over ground, north and east, m/s.
    pub velocity_error_mps: Option<[f64; 2]>,
}

/// Covariance of attitude and velocity at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolutionUncertainty {
    /// Covariance of φ in n (north, east, down), rad².
    pub phi: [[f64; 3]; 3],
    /// σ of the velocity over ground, north and east, m/s.
    pub velocity_mps: [f64; 2],
}

/// σ of heading, pitch and roll of the case, rad, from the covariance of φ in n, rad².
#[must_use]
pub fn case_sigma(phi: &[[f64; 3]; 3], attitude: &CaseAngles) -> [f64; 3] {
    let to_case = case_of_phi(attitude.heading_rad, attitude.pitch_rad);
    let phi = Matrix3::from_fn(|i, j| phi[i][j]);
    let case = to_case * phi * to_case.transpose();
    core::array::from_fn(|i| libm::sqrt(case[(i, i)].max(0.0)))
}

impl SolutionScore {
    /// Scores a solution, with its covariance where there is one.
    #[must_use]
    pub fn of(point: &SolutionPoint, uncertainty: Option<&SolutionUncertainty>) -> Self {
        let degrees = |of: fn(&CaseAngles) -> f64| point.attitude.as_ref().map(|a| of(a) / DEG);
        let sigma = uncertainty
            .zip(point.attitude.as_ref())
            .map(|(u, attitude)| case_sigma(&u.phi, attitude).map(|sigma| sigma / ARCMIN));
        let error = |of: fn(&CaseAngles) -> f64| {
            point.attitude_error.as_ref().map(|error| of(error) / ARCMIN)
        };
        let angle = |axis: usize, of| PointScore::of(error(of), sigma.map(|sigma| sigma[axis]));
        let velocity = |axis: usize| {
            let error = point.velocity_error_mps.map(|error| error[axis]);
            PointScore::of(error, uncertainty.map(|u| u.velocity_mps[axis]))
        };
        Self {
            heading_deg: degrees(|a| a.heading_rad),
            pitch_deg: degrees(|a| a.pitch_rad),
            roll_deg: degrees(|a| a.roll_rad),
            heading_arcmin: angle(0, |a| a.heading_rad),
            pitch_arcmin: angle(1, |a| a.pitch_rad),
            roll_arcmin: angle(2, |a| a.roll_rad),
            velocity_north_mps: velocity(0),
            velocity_east_mps: velocity(1),
        }
    }

    /// Scores with name and unit, heading first.
    #[must_use]
    pub fn points(&self) -> [(&'static str, &'static str, PointScore); 5] {
        [
            ("heading", "arcmin", self.heading_arcmin),
            ("pitch", "arcmin", self.pitch_arcmin),
            ("roll", "arcmin", self.roll_arcmin),
            ("north", "m/s", self.velocity_north_mps),
            ("east", "m/s", self.velocity_east_mps),
        ]
    }
}
