//! Latitude from Earth's rate in stretches at several attitudes.
//!
//! In stretch i the gyros have the mean ω̃ᵢ = ωᵢ + b, and the accelerometers the direction of up, uᵢ. Earth's rate along
//! up is Ω sin φ at any attitude:
//!
//! ```text
//! ω̃ᵢ·uᵢ = Ω sin φ + b·uᵢ
//! ```
//!
//! That is linear in sin φ and the biases b. It tells the latitude where Ω sin φ can be told from the biases: two
//! positions upside down against each other do, turns about the vertical don't. With all of b known, the rate across
//! up, |ω̃ᵢ − b − up part| = Ω cos φ, is a second latitude and points north: the heading of body x in each stretch.
//!
//! The uncertainty of a mean is the Allan deviation of the fitted terms over the length of its stretch. Errors of scale
//! and alignment aren't in it: only stretches at rest count, so that they are parts of Earth's rate and of the biases.

use super::analysis::{ChannelAnalysis, RestAnalysis};
use super::fit::variance_of;
use super::kernel::DifferenceOrder;
use super::survey::RestStretch;
use nalgebra::{Matrix4, Vector3, Vector4};
use octant_base::number::significant;
use serde::Serialize;

/// Rate of the Earth, rad/s (WGS 84).
const EARTH_RATE_RADPS: f64 = 7.292_115e-5;
/// Angle between two directions of up from which attitudes differ, rad.
const DIFFERS_RAD: f64 = 0.1;
/// Standard deviation of sin φ, and of a heading in rad, above which it tells nothing.
const USEFUL: f64 = 0.5;
/// Part of the latitude's unknown that may stay untold.
const UNSEEN: f64 = 0.05;
/// Smallest eigenvalue, against the largest, of equations that are told apart.
const RANK: f64 = 1e-3;

/// Earth's rate in several attitudes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EarthRateCheck {
    /// Number of stretches.
    pub stretches: usize,
    /// Number of attitudes, by the direction of up.
    pub attitudes: usize,
    /// Latitude, rad, with its interval of 95 %; none where it can't be told, for a reason.
    pub latitude_rad: Option<f64>,
    /// Interval of 95 %, rad.
    pub latitude_interval_rad: Option<[f64; 2]>,
    /// Gyro biases, rad/s, and their σ, where all are told.
    pub gyro_bias_radps: Option<[[f64; 2]; 3]>,
    /// Latitude's cosine from the rate across up, with its σ.
    pub cosine: Option<[f64; 2]>,
    /// Headings of body x by stretch, rad from north by east, with σ; none where body x is near the vertical.
    pub headings_rad: Vec<Option<[f64; 2]>>,
    /// Why no latitude is told.
    pub reason: Option<String>,
}

/// A stretch with what the check takes of it.
struct Attitude {
    rate: Vector3<f64>,
    up: Vector3<f64>,
    /// Variance of the mean of a gyro.
    variance: f64,
}

/// Solution of the linear equations: Ω sin φ as its first element, biases.
struct Solution {
    values: Vector4<f64>,
    covariance: Matrix4<f64>,
    rank: usize,
    /// Part of the first element that isn't told.
    unseen: f64,
}

/// Checks stretches at rest against Earth's rate.
#[must_use]
pub fn check(stretches: &[RestStretch], analysis: &RestAnalysis, period_s: f64) -> EarthRateCheck {
    let all: Vec<Attitude> =
        stretches.iter().map(|stretch| attitude(stretch, analysis, period_s)).collect();
    let mut ups: Vec<Vector3<f64>> = Vec::new();
    for Attitude { up, .. } in &all {
        if ups.iter().all(|other| other.angle(up) > DIFFERS_RAD) {
            ups.push(*up);
        }
    }
    let mut check = EarthRateCheck {
        stretches: stretches.len(),
        attitudes: ups.len(),
        latitude_rad: None,
        latitude_interval_rad: None,
        gyro_bias_radps: None,
        cosine: None,
        headings_rad: Vec::new(),
        reason: None,
    };
    if ups.len() < 2 {
        check.reason =
            Some("one attitude: Earth's rate can't be told from the gyro biases".to_owned());
        return check;
    }
    let Some(solution) = solve(&all) else {
        check.reason = Some("the stretches are too short for the noise of the gyros".to_owned());
        return check;
    };
    if solution.unseen > UNSEEN {
        check.reason = Some(format!(
            "{} attitudes don't tell Earth's rate from the gyro biases, expected one upside down, or four in space",
            ups.len()
        ));
        return check;
    }
    let sine = solution.values[0] / EARTH_RATE_RADPS;
    let sigma = libm::sqrt(solution.covariance[(0, 0)]) / EARTH_RATE_RADPS;
    if !(sigma < USEFUL) {
        check.reason = Some(format!(
            "the sine of the latitude is {} with a standard deviation of {}, expected below {USEFUL}: the gyros are too noisy",
            significant(sine, 2),
            significant(sigma, 2)
        ));
        return check;
    }
    if !(sine.abs() - 1.96 * sigma <= 1.0) {
        check.reason = Some(format!(
            "the rate along up is {} of Earth's, expected 1 at most: scale, alignment or motion are wrong",
            significant(sine, 3)
        ));
        return check;
    }
    let latitude = |sine: f64| libm::asin(sine.clamp(-1.0, 1.0));
    check.latitude_rad = Some(latitude(sine));
    check.latitude_interval_rad =
        Some([latitude(sine - 1.96 * sigma), latitude(sine + 1.96 * sigma)]);
    if solution.rank == 4 {
        across(&mut check, &all, &solution);
    }
    check
}

fn attitude(stretch: &RestStretch, analysis: &RestAnalysis, period_s: f64) -> Attitude {
    let triad =
        |at: usize| Vector3::new(stretch.mean[at], stretch.mean[at + 1], stretch.mean[at + 2]);
    let tau_s = stretch.samples as f64 * period_s;
    let of = |channel: &ChannelAnalysis| {
        channel.noise.as_ref().map_or(f64::NAN, |noise| {
            let (kernel, squares) = (noise.kernel(period_s), noise.squares());
            variance_of(&kernel, &squares, DifferenceOrder::Second, tau_s)
        })
    };
    let variance = analysis.channels.iter().take(3).map(of).sum::<f64>() / 3.0;
    Attitude { rate: triad(0), up: triad(3).normalize(), variance }
}

/// Solves ω̃·u = Ω sin φ + b·u by weighted least squares, where it can be solved.
fn solve(all: &[Attitude]) -> Option<Solution> {
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for Attitude { rate, up, variance } in all {
        let row = Vector4::new(1.0, up.x, up.y, up.z);
        normal += row * row.transpose() / *variance;
        right += row * rate.dot(up) / *variance;
    }
    if !normal.iter().all(|value| value.is_finite()) {
        return None;
    }
    let eigen = normal.symmetric_eigen();
    let most = eigen.eigenvalues.max();
    let mut solution =
        Solution { values: Vector4::zeros(), covariance: Matrix4::zeros(), rank: 0, unseen: 0.0 };
    for k in 0..4 {
        let (value, vector) = (eigen.eigenvalues[k], eigen.eigenvectors.column(k).into_owned());
        if value > RANK * most {
            solution.rank += 1;
            solution.values += vector * (vector.dot(&right) / value);
            solution.covariance += vector * vector.transpose() / value;
        } else {
            solution.unseen = solution.unseen.max(vector[0].abs());
        }
    }
    (most > 0.0).then_some(solution)
}

/// Adds biases, the rate across up, and headings.
fn across(check: &mut EarthRateCheck, all: &[Attitude], solution: &Solution) {
    let covariance = &solution.covariance;
    let bias = Vector3::new(solution.values[1], solution.values[2], solution.values[3]);
    let of = |axis: usize| [bias[axis], libm::sqrt(covariance[(axis + 1, axis + 1)])];
    check.gyro_bias_radps = Some([of(0), of(1), of(2)]);
    // The uncertainty of the biases is shared by all stretches: no mean of them makes it smaller.
    let shared = (covariance[(1, 1)] + covariance[(2, 2)] + covariance[(3, 3)]) / 3.0;
    let (mut sum, mut weights) = (0.0, 0.0);
    for Attitude { rate, up, variance } in all {
        let rate = rate - bias;
        let across = rate - up * rate.dot(up);
        let total = variance + shared;
        sum += across.norm() / EARTH_RATE_RADPS / total;
        weights += 1.0 / total;
        let x = Vector3::x() - up * up.x;
        let sigma = libm::sqrt(total) / across.norm();
        check.headings_rad.push((x.norm() > DIFFERS_RAD && sigma < USEFUL).then(|| {
            // Across is north, and north × up is east.
            let heading = libm::atan2(x.dot(&across.cross(up)), x.dot(&across));
            [heading.rem_euclid(std::f64::consts::TAU), sigma]
        }));
    }
    check.cosine = Some([sum / weights, libm::sqrt(1.0 / weights + shared) / EARTH_RATE_RADPS]);
}
