//! Errors of the navigation solution: attitude of the case, and velocity.

use octant_earth::units::ARCMIN;
use octant_endpoint::Tells;
use octant_sample::{Output, Truth};
use octant_score::attitude::CaseAngles;

/// Attitude error of the case, with NaN for roll and pitch where they aren't told; `None` where unit or source don't tell an attitude.
pub(super) fn attitude_error(tells: Tells, output: &Output, truth: &Truth) -> Option<CaseAngles> {
    let known = tells.attitude && truth.q_nb.iter().all(|q| q.is_finite());
    let computed = output.navigation.q_nb;
    known.then(|| {
        let error = CaseAngles::error(computed, truth.q_nb, truth.gimbal_rad);
        // Roll and pitch of a heading alone are those of no one.
        if tells.tilt { error } else { CaseAngles::of_heading(error.heading_rad) }
    })
}

/// Errors of a solution at one time, as far as they are known.
#[derive(Clone, Copy, Debug)]
pub(super) struct SolutionErrors {
    /// Latitude and longitude, rad.
    pub(super) position_error_rad: Option<[f64; 2]>,
    /// Attitude of the case.
    pub(super) attitude_error: Option<CaseAngles>,
    /// Velocity over ground, north and east, m/s.
    pub(super) velocity_error_mps: Option<[f64; 2]>,
}

/// Error of latitude and longitude, rad; `None` where the unit doesn't tell a position.
pub(super) fn position_error(tells: Tells, output: &Output, truth: &Truth) -> Option<[f64; 2]> {
    let computed = &output.navigation;
    let error =
        [computed.latitude_rad - truth.latitude_rad, computed.longitude_rad - truth.longitude_rad];
    tells.position.then_some(error)
}

/// Error of the velocity over ground, north and east, m/s; `None` where unit or source don't tell a
/// velocity.
pub(super) fn velocity_error(tells: Tells, output: &Output, truth: &Truth) -> Option<[f64; 2]> {
    let [north, east, _] = truth.velocity_mps;
    let known = tells.velocity && north.is_finite() && east.is_finite();
    let [computed_north, computed_east, _] = output.navigation.velocity_mps;
    known.then_some([computed_north - north, computed_east - east])
}

/// Errors of attitude, arcmin, and velocity, m/s, in the order of
/// [`octant_score::run_series::SolutionSeries::push`].
pub(super) fn errors(attitude: Option<CaseAngles>, velocity_mps: Option<[f64; 2]>) -> [f64; 5] {
    let arcmin = |of: fn(&CaseAngles) -> f64| attitude.as_ref().map_or(f64::NAN, of) / ARCMIN;
    let [north, east] = velocity_mps.unwrap_or([f64::NAN; 2]);
    [arcmin(|a| a.heading_rad), arcmin(|a| a.pitch_rad), arcmin(|a| a.roll_rad), north, east]
}

/// Device time of an output, h.
pub(super) fn hours(output: &Output) -> f64 {
    output.device_time.seconds() / 3600.0
}
