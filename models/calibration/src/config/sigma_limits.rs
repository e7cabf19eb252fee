//! Largest standard deviations of a calibration that is published.

use super::{CoreConfig, Kalman};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterGroup};

/// Heading and tilt may be this many times as uncertain as before the calibration.
const OF_PRIOR: f64 = 2.0;
/// Heading may be this many times as uncertain as white noise of the gyros leaves it where Earth rate is averaged
/// over the calibration. That of the presets is 2 to 3.
const OF_EARTH_RATE: f64 = 10.0;
/// Tilt may be this many times as large as the accelerometers' biases made it before the calibration.
const OF_BIAS: f64 = 2.0;

/// Limits that the configuration gives; where it gives none, heading and tilt have that of the instrument's grade, and a
/// parameter has none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct SigmaLimits {
    /// Heading, rad.
    pub heading_rad: Option<f64>,
    /// Tilt about north and east, the larger one, rad.
    pub tilt_rad: Option<f64>,
    /// Parameters by group, in the order of [`ParameterGroup::ALL`], SI.
    pub parameters: [Option<f64>; 7],
}

/// Quantity with a limit of its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum UncertainQuantity {
    /// Heading.
    Heading,
    /// Tilt.
    Tilt,
    /// Parameter, by its index.
    Parameter(u8),
}

impl UncertainQuantity {
    /// Name for a sentence.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Heading => "the heading",
            Self::Tilt => "the tilt",
            Self::Parameter(index) => NAMES[usize::from(index) % PARAMETER_COUNT],
        }
    }

    fn group(self) -> Option<ParameterGroup> {
        let Self::Parameter(index) = self else { return None };
        ParameterGroup::ALL.into_iter().find(|group| group.range().contains(&usize::from(index)))
    }

    /// Key of the limit in a scenario, below `procedure.calibration.refuse_above_sigma`.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Heading => "heading",
            Self::Tilt => "tilt",
            Self::Parameter(_) => self.group().map_or("", ParameterGroup::name),
        }
    }

    /// Unit in which people read it.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.group().map_or("arcmin", ParameterGroup::unit)
    }

    /// The unit in SI.
    #[must_use]
    pub fn si_per_unit(self) -> f64 {
        self.group().map_or(octant_earth::units::ARCMIN, ParameterGroup::si_per_unit)
    }
}

impl SigmaLimits {
    /// Limits of heading and tilt, rad, of the instrument's grade: by what the filter knew before the calibration (`kalman` is
    /// the one that runs, after the alignment) and by the noise that the gyros are said to have. Infinite for a filter
    /// without a gate, the bare one.
    #[must_use]
    pub fn attitude_of_grade(config: &CoreConfig, kalman: &Kalman, duration_s: f64) -> (f64, f64) {
        if config.screening.gate.is_none() {
            return (f64::INFINITY, f64::INFINITY);
        }
        let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
        let north_rate = EARTH_RATE_RADPS * earth.cos_latitude.abs();
        let averaged = config.noise.angle_random_walk / (north_rate * libm::sqrt(duration_s));
        let [north, east, azimuth] = kalman.prior.attitude_rad;
        let bias = kalman.prior.of(ParameterGroup::AccelBias) / earth.gravity_mps2;
        (
            (OF_PRIOR * azimuth).max(OF_EARTH_RATE * averaged),
            (OF_PRIOR * north.max(east)).max(OF_BIAS * bias),
        )
    }

    /// Returns the first standard deviation above its limit, with both: of heading and tilt, rad, and of the parameters, SI.
    /// A standard deviation that is no number is above any limit.
    #[must_use]
    pub fn exceeded(
        &self,
        of_grade: (f64, f64),
        attitude: (f64, f64),
        parameters: &[f64; PARAMETER_COUNT],
    ) -> Option<(UncertainQuantity, f64, f64)> {
        let heading = self.heading_rad.unwrap_or(of_grade.0);
        let tilt = self.tilt_rad.unwrap_or(of_grade.1);
        let above = |sigma: f64, limit: f64| !(sigma <= limit);
        if above(attitude.0, heading) {
            return Some((UncertainQuantity::Heading, attitude.0, heading));
        }
        if above(attitude.1, tilt) {
            return Some((UncertainQuantity::Tilt, attitude.1, tilt));
        }
        for (group, limit) in ParameterGroup::ALL.into_iter().zip(self.parameters) {
            let Some(limit) = limit else { continue };
            if let Some(i) = group.range().find(|i| above(parameters[*i], limit)) {
                return Some((UncertainQuantity::Parameter(i as u8), parameters[i], limit));
            }
        }
        None
    }
}
