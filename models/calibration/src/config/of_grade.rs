//! Limits of heading and tilt that follow from the instrument's grade, where the configuration gives none.

use super::{CoreConfig, Kalman};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_sample::parameters::ParameterGroup;

/// Heading and tilt may be this many times as uncertain as before the calibration.
const OF_PRIOR: f64 = 2.0;
/// Heading may be this many times as uncertain as white noise of the gyros leaves it where Earth rate is averaged
/// over the calibration. That of the presets is 2 to 3.
const OF_EARTH_RATE: f64 = 10.0;
/// Tilt may be this many times as large as the accelerometers' biases made it before the calibration.
const OF_BIAS: f64 = 2.0;

impl CoreConfig {
    /// Limits of heading and tilt, rad, of the instrument's grade: by what the filter knew before the calibration (`kalman` is
    /// the one that runs, after the alignment) and by the noise that the gyros are said to have. Infinite for a filter
    /// without a gate, the bare one.
    #[must_use]
    pub fn attitude_of_grade(&self, kalman: &Kalman, duration_s: f64) -> (f64, f64) {
        if self.screening.gate.is_none() {
            return (f64::INFINITY, f64::INFINITY);
        }
        let earth = Ellipsoid::at(self.site.latitude_rad, self.site.height_m);
        let north_rate = EARTH_RATE_RADPS * earth.cos_latitude.abs();
        let averaged = self.noise.angle_random_walk / (north_rate * libm::sqrt(duration_s));
        let [north, east, azimuth] = kalman.prior.attitude_rad;
        let bias = kalman.prior.of(ParameterGroup::AccelBias) / earth.gravity_mps2;
        (
            (OF_PRIOR * azimuth).max(OF_EARTH_RATE * averaged),
            (OF_PRIOR * north.max(east)).max(OF_BIAS * bias),
        )
    }
}
