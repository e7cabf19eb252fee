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
//! and alignment aren't in it: 1000 ppm of a bias of 1 °/h are 0.001 °/h, but 10⁻³ of a rate of the table between two
//! stretches doesn't matter, since only stretches at rest count.

use super::analysis::RestAnalysis;
use super::fit::variance_of;
use super::kernel::DifferenceOrder;
use super::survey::RestStretch;
use nalgebra::{Matrix4, Vector3, Vector4};
use serde::Serialize;

/// Rate of the Earth, rad/s (WGS 84).
const EARTH_RATE_RADPS: f64 = 7.292_115e-5;
/// Angle between two directions of up from which attitudes differ, rad.
const DIFFERS_RAD: f64 = 0.1;
/// Uncertainty of sin φ above which it tells nothing.
const USEFUL: f64 = 0.5;
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

/// Checks stretches at rest against Earth's rate.
#[must_use]
pub fn check(stretches: &[RestStretch], analysis: &RestAnalysis, period_s: f64) -> EarthRateCheck {
    let triad = |mean: &[f64; 6], at: usize| Vector3::new(mean[at], mean[at + 1], mean[at + 2]);
    let ups: Vec<Vector3<f64>> =
        stretches.iter().map(|stretch| triad(&stretch.mean, 3).normalize()).collect();
    let mut attitudes: Vec<Vector3<f64>> = Vec::new();
    for up in &ups {
        if attitudes.iter().all(|other| other.angle(up) > DIFFERS_RAD) {
            attitudes.push(*up);
        }
    }
    let mut check = EarthRateCheck {
        stretches: stretches.len(),
        attitudes: attitudes.len(),
        latitude_rad: None,
        latitude_interval_rad: None,
        gyro_bias_radps: None,
        cosine: None,
        headings_rad: Vec::new(),
        reason: None,
    };
    if attitudes.len() < 2 {
        check.reason =
            Some("one attitude: Earth's rate can't be told from the gyro biases".to_owned());
        return check;
    }
    // Variance of a mean of each stretch, the three gyros together.
    let variance = |stretch: &RestStretch| -> f64 {
        let tau_s = stretch.samples as f64 * period_s;
        let of = |channel: &super::analysis::ChannelAnalysis| {
            channel.noise.as_ref().map_or(f64::NAN, |noise| {
                variance_of(
                    &noise.kernel(period_s),
                    &noise.squares(),
                    DifferenceOrder::Second,
                    tau_s,
                )
            })
        };
        analysis.channels.iter().take(3).map(of).sum::<f64>() / 3.0
    };
    let variances: Vec<f64> = stretches.iter().map(variance).collect();
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for ((stretch, up), variance) in stretches.iter().zip(&ups).zip(&variances) {
        let row = Vector4::new(EARTH_RATE_RADPS, up.x, up.y, up.z);
        let scaled = row.component_mul(&Vector4::new(1.0 / EARTH_RATE_RADPS, 1.0, 1.0, 1.0));
        normal += scaled * scaled.transpose() / *variance;
        right += scaled * triad(&stretch.mean, 0).dot(up) / *variance;
    }
    let eigen = normal.symmetric_eigen();
    let most = eigen.eigenvalues.max();
    if !(most > 0.0 && most.is_finite()) {
        check.reason = Some("the stretches are too short for the noise of the gyros".to_owned());
        return check;
    }
    let (mut solution, mut covariance) = (Vector4::zeros(), Matrix4::zeros());
    let (mut rank, mut unseen) = (0, 0.0f64);
    for k in 0..4 {
        let (value, vector) = (eigen.eigenvalues[k], eigen.eigenvectors.column(k).into_owned());
        if value > RANK * most {
            rank += 1;
            solution += vector * (vector.dot(&right) / value);
            covariance += vector * vector.transpose() / value;
        } else {
            unseen = unseen.max(vector[0].abs());
        }
    }
    if unseen > 0.05 {
        check.reason = Some(format!(
            "{} attitudes that don't tell Earth's rate from the gyro biases: expected one upside down, or four in space",
            attitudes.len()
        ));
        return check;
    }
    let (sine, sigma) =
        (solution[0] / EARTH_RATE_RADPS, libm::sqrt(covariance[(0, 0)]) / EARTH_RATE_RADPS);
    if !(sigma < USEFUL) {
        check.reason = Some(format!(
            "the sine of the latitude is {} with a standard deviation of {}: the gyros are too noisy, expected below {USEFUL}",
            octant_base::number::significant(sine, 2),
            octant_base::number::significant(sigma, 2)
        ));
        return check;
    }
    let latitude = |sine: f64| libm::asin(sine.clamp(-1.0, 1.0));
    check.latitude_rad = (sine.abs() <= 1.0).then(|| latitude(sine));
    check.latitude_interval_rad =
        Some([latitude(sine - 1.96 * sigma), latitude(sine + 1.96 * sigma)]);
    if check.latitude_rad.is_none() {
        check.reason = Some(format!(
            "the rate along up is {} of Earth's, expected 1 at most: scale, alignment or motion are wrong",
            octant_base::number::significant(sine, 3)
        ));
    }
    if rank == 4 {
        let bias = Vector3::new(solution[1], solution[2], solution[3]);
        let of = |axis: usize| [bias[axis], libm::sqrt(covariance[(axis + 1, axis + 1)])];
        check.gyro_bias_radps = Some([of(0), of(1), of(2)]);
        let mut sum = [0.0, 0.0];
        for ((stretch, up), variance) in stretches.iter().zip(&ups).zip(&variances) {
            let rate = triad(&stretch.mean, 0) - bias;
            let across = rate - up * rate.dot(up);
            // The biases' own uncertainty is shared by all stretches; it counts once in each.
            let total =
                variance + (covariance[(1, 1)] + covariance[(2, 2)] + covariance[(3, 3)]) / 3.0;
            sum[0] += across.norm() / EARTH_RATE_RADPS / total;
            sum[1] += 1.0 / total;
            let x = Vector3::x() - up * up.x;
            let sigma = libm::sqrt(total) / across.norm();
            check.headings_rad.push((x.norm() > DIFFERS_RAD && sigma < 0.5).then(|| {
                // North is across; east is north × up, as up = east × north.
                let heading = libm::atan2(x.dot(&across.cross(up)), x.dot(&across));
                [heading.rem_euclid(std::f64::consts::TAU), sigma]
            }));
        }
        let shared = (covariance[(1, 1)] + covariance[(2, 2)] + covariance[(3, 3)]) / 3.0;
        let sigma = libm::sqrt(1.0 / sum[1] + shared) / EARTH_RATE_RADPS;
        check.cosine = Some([sum[0] / sum[1], sigma]);
    }
    check
}
