//! Physical references for the scores: closed forms for the drift that g-dependent biases and random
//! walk cause with any method.

use super::floor::{Floor, FloorSummary};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::units::{ARCMIN, DEG_PER_HOUR_PER_G};
use octant_sample::parameters::ParameterGroup;
use serde::{Deserialize, Serialize};

/// Analytic references of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnalyticReference {
    /// Schuler period of the site, min.
    pub schuler_period_min: f64,
    /// Effect of an uncompensated g_zz of 5e-4 deg/h/g at this site.
    pub table_g_zz: VerticalDrift,
    /// Effect of this run's g_zz without compensation; null if it isn't known.
    pub true_g_zz: Option<VerticalDrift>,
    /// Effect of the error of the estimated g_zz, after compensation.
    pub residual_g_zz: Option<VerticalDrift>,
    /// Effect of the error of the baseline's estimated g_zz, after compensation.
    pub baseline_residual_g_zz: Option<VerticalDrift>,
    /// Lower limit of σ for the isotropic part of G in a calibration of this length, deg/h/g.
    pub isotropic_g_sigma_floor_deg_per_h_per_g: Option<f64>,
    /// Errors from the noise of the sensors alone, all parameters and the attitude exact.
    pub random_walk: Option<FloorSummary>,
}

/// Drift from the vertical gyro error that g_zz causes in the navigation scheme, in which every other
/// bias averages out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VerticalDrift {
    /// g_zz, deg/h/g.
    pub g_zz_deg_per_h_per_g: f64,
    /// Secular longitude error with its sign, arcmin per day.
    pub longitude_arcmin_per_day: f64,
    /// Largest latitude error with its sign, half a sidereal day after the start, arcmin.
    pub latitude_bound_arcmin: f64,
}

/// Drift of a residual g_zz (rad/s per m/s², measured − true and not compensated).
///
/// Turning about x and z by half turns, the body's z axis points up as long as down, and G f keeps
/// one component that never changes sign in n: a gyro error down of −g_zz·g. In inertial space a
/// drift that is constant in n grows only along the Earth's axis p = (cos L, 0, −sin L), and that
/// is a longitude error: δλ̇ = ε·p = g_zz·g·sin L. The part at right angles to p turns with the
/// Earth and returns after a sidereal day: δL = (g_zz·g·cos L/Ω)(1 − cos Ωt). See Britting,
/// *Inertial Navigation Systems Analysis*, ch. 7.
#[must_use]
pub fn vertical_drift(g_zz: f64, latitude_rad: f64, height_m: f64) -> VerticalDrift {
    let earth = Ellipsoid::at(latitude_rad, height_m);
    let drift = g_zz * earth.gravity_mps2;
    VerticalDrift {
        g_zz_deg_per_h_per_g: g_zz / ParameterGroup::GDependent.si_per_unit(),
        longitude_arcmin_per_day: drift * earth.sin_latitude * 86_400.0 / ARCMIN,
        latitude_bound_arcmin: 2.0 * drift * earth.cos_latitude / EARTH_RATE_RADPS / ARCMIN,
    }
}

/// Smallest σ of the isotropic part of G after a calibration of `duration_s`, rad/s per m/s².
///
/// G proportional to the unit matrix is a constant gyro error along f in every attitude: no turn of
/// a gimbal changes it. It shows as azimuth that wanders, and azimuth is measured through the east
/// gyro against Ω cos L, with angle random walk N (rad/√s): the slope of a line in white noise of
/// density (N/Ω cos L)² has σ = √12·N/(Ω cos L·T^1.5). That is a rate; over g it is a G.
#[must_use]
pub fn isotropic_g_sigma(
    angle_random_walk: f64,
    latitude_rad: f64,
    height_m: f64,
    duration_s: f64,
) -> f64 {
    let earth = Ellipsoid::at(latitude_rad, height_m);
    let rate = libm::sqrt(12.0) * angle_random_walk
        / (EARTH_RATE_RADPS * earth.cos_latitude * duration_s * libm::sqrt(duration_s));
    rate / earth.gravity_mps2
}

/// Inputs of the references, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceInput {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
    /// Heading of the case, rad.
    pub heading_rad: f64,
    /// Angle random walk of the gyros, rad/√s.
    pub angle_random_walk: f64,
    /// Noise density of the accelerometers, (m/s²)/√Hz.
    pub velocity_random_walk: f64,
    /// Length of the calibration, s.
    pub calibration_s: Option<f64>,
    /// Length of the navigation, s.
    pub navigation_s: Option<f64>,
    /// True g_zz, if it is known.
    pub true_g_zz: Option<f64>,
    /// Estimated g_zz of the method.
    pub estimated_g_zz: Option<f64>,
    /// Estimated g_zz of the baseline; zero if it has none.
    pub baseline_estimated_g_zz: Option<f64>,
}

/// All references of one run.
#[must_use]
pub fn reference(input: &ReferenceInput) -> AnalyticReference {
    let drift = |g_zz| vertical_drift(g_zz, input.latitude_rad, input.height_m);
    let residual =
        |estimate: Option<f64>| input.true_g_zz.zip(estimate).map(|(truth, e)| drift(truth - e));
    let earth = Ellipsoid::at(input.latitude_rad, input.height_m);
    AnalyticReference {
        schuler_period_min: earth.schuler_period_s() / 60.0,
        table_g_zz: drift(5e-4 * DEG_PER_HOUR_PER_G),
        true_g_zz: input.true_g_zz.map(drift),
        residual_g_zz: residual(input.estimated_g_zz),
        baseline_residual_g_zz: residual(input.baseline_estimated_g_zz),
        isotropic_g_sigma_floor_deg_per_h_per_g: input.calibration_s.filter(|t| *t > 0.0).map(
            |t| {
                isotropic_g_sigma(input.angle_random_walk, input.latitude_rad, input.height_m, t)
                    / ParameterGroup::GDependent.si_per_unit()
            },
        ),
        random_walk: input.navigation_s.filter(|t| *t >= 60.0).map(|t| {
            Floor::new(
                input.latitude_rad,
                input.height_m,
                input.angle_random_walk,
                input.velocity_random_walk,
            )
            .at_heading(input.heading_rad)
            .summary(t)
        }),
    }
}
