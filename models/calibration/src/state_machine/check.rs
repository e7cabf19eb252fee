//! Checks of a configuration before a core is made from it.

use crate::config::{
    AidingMode, Alignment, AngleMeasurements, Base, BaseMotion, CaseRest, CoreConfig, Estimator,
    Further, SwayNoise,
};
use crate::further::FurtherGroup;

use crate::inertial_alignment::SHORTEST_S;
use crate::schedule::DoesNotFit;

/// Longest period of the reference for a filter that estimates the sway, ns: a sway of 5 s and more is
/// seen more than twice a period.
const SWAY_PERIOD_MAX_NS: u64 = 2_000_000_000;

/// Longest calibration or navigation, s: thirty years. Its number of ticks is small enough for all
/// later multiplications.
const DURATION_MAX_S: f64 = 1e9;

/// Reason why a configuration can't be run.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CoreConfigError {
    /// The sequence doesn't fit into the calibration time.
    #[error(transparent)]
    DoesNotFit(#[from] DoesNotFit),
    /// A period is not usable.
    #[error("{field} is {found_ns} ns, {expected} is expected")]
    Period {
        /// Name of the field.
        field: &'static str,
        /// Value found, ns.
        found_ns: u64,
        /// Values expected.
        expected: &'static str,
    },
    /// A number that must be positive and finite isn't.
    #[error("{field} is {found}, a positive number is expected")]
    NotPositive {
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: f64,
    },
    /// A number that must be finite isn't.
    #[error("{field} is {found}, a finite number is expected")]
    NotFinite {
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: f64,
    },
    /// Longer than any procedure.
    #[error("{field} is {found_s} s, at most {DURATION_MAX_S} s are expected")]
    TooLong {
        /// Name of the field.
        field: &'static str,
        /// Value found, s.
        found_s: f64,
    },
    /// A navigation can't be planned any more.
    #[error("plan another navigation: the calibration has ended")]
    CalibrationOver,
    /// A part of the configuration that can't change in a core that runs.
    #[error(
        "{part} differs from the configuration that the core was made with: it can't change in a core that runs"
    )]
    Fixed {
        /// Name of the part.
        part: &'static str,
    },
    /// A test for identical counts that every sample would fail.
    #[error("the number of identical samples is {found}, at least 2 are expected")]
    StuckSamples {
        /// Value found.
        found: u32,
    },
    /// The latitude is too close to a pole for a local-level frame.
    #[error("latitude is {found_rad} rad, within ±1.56 (±89.4 deg) is expected")]
    Latitude {
        /// Value found, rad.
        found_rad: f64,
    },
    /// A coloured sway without the reference that shows it.
    #[error("the sway is coloured and the reference a velocity, a position is expected")]
    SwayWithoutPosition,
    /// A coloured sway beside further states.
    #[error("the sway is coloured and further states are on, one of the two is expected")]
    SwayWithFurther,
    /// Gimbal angles as measurements of attitude where the case moves.
    #[error(
        "gimbal angles or the rest of the case are measurements and the base moves, a base at rest is expected"
    )]
    AnglesOnMovingBase,
    /// Errors that follow the temperature beside angles as measurements.
    #[error(
        "errors follow the temperature and gimbal angles are measurements, one of the two is expected"
    )]
    TemperatureWithAngles,
    /// A temperature that is no number.
    #[error("reference of the temperature is {found_c} degC, a finite number is expected")]
    ReferenceTemperature {
        /// Value found, °C.
        found_c: f64,
    },
    /// The estimator can't be set up.
    #[error("set up the estimator: {0}")]
    Estimator(#[from] crate::least_squares::AdjustmentRefusal),
    /// Too short for an alignment in the inertial frame.
    #[error("inertial alignment takes {found_s} s, at least {SHORTEST_S} s are expected")]
    Short {
        /// Value found, s.
        found_s: f64,
    },
    /// The alignment takes longer than the instrument rests.
    #[error("the alignment takes {alignment_s} s, and the first stop is held for {dwell_s} s only")]
    Alignment {
        /// Time of the alignment, s.
        alignment_s: f64,
        /// Dwell at the first stop, s.
        dwell_s: f64,
    },
    /// Neither a calibration nor navigation: there is nothing to do.
    #[error("neither a calibration nor a navigation is configured")]
    Nothing,
}

fn positive(field: &'static str, found: f64) -> Result<(), CoreConfigError> {
    if found > 0.0 && found.is_finite() {
        Ok(())
    } else {
        Err(CoreConfigError::NotPositive { field, found })
    }
}

/// Checks the further states: those that are on need a prior, and a process its time.
fn check_further(further: &Further) -> Result<(), CoreConfigError> {
    for group in FurtherGroup::ALL {
        if let Some(sigma) = further.of(group).sigma() {
            positive("prior of a further state", sigma)?;
        }
    }
    if let Some(AngleMeasurements { sigma_rad, curve_sigma_rad, groups: _ }) = &further.angles {
        positive("sigma of the gimbal angles", *sigma_rad)?;
        if *curve_sigma_rad != 0.0 {
            positive("sigma of the encoders' curve", *curve_sigma_rad)?;
        }
    }
    if let Some(CaseRest { wander_rad_per_sqrt_s, range_rad, jitter_rad }) = further.rest {
        positive("jitter of the case at rest", jitter_rad)?;
        positive("range of the case at rest", range_rad)?;
        if wander_rad_per_sqrt_s != 0.0 {
            positive("wander of the case at rest", wander_rad_per_sqrt_s)?;
        }
    }
    if further.follows_temperature() && further.attitude_at_rest().is_some() {
        return Err(CoreConfigError::TemperatureWithAngles);
    }
    if let Some(found_c) = further.temperature.and_then(|temperature| temperature.reference_c)
        && !found_c.is_finite()
    {
        return Err(CoreConfigError::ReferenceTemperature { found_c });
    }
    if further.of(FurtherGroup::GyroGaussMarkov).sigma().is_some() {
        positive("correlation time of the gyros", further.gyro_correlation_time_s)?;
    }
    if further.of(FurtherGroup::AccelGaussMarkov).sigma().is_some() {
        positive("correlation time of the accelerometers", further.accel_correlation_time_s)?;
    }
    let walk = further.gyro_rate_random_walk;
    if walk == 0.0 { Ok(()) } else { positive("rate random walk of the gyros", walk) }
}

pub(super) fn check(config: &CoreConfig) -> Result<(), CoreConfigError> {
    let period_ns = config.sample_period_ns;
    if period_ns == 0 || period_ns > 1_000_000_000 {
        return Err(CoreConfigError::Period {
            field: "sample period",
            found_ns: period_ns,
            expected: "1 ns to 1 s",
        });
    }
    if !(config.site.latitude_rad.abs() <= 1.56) {
        return Err(CoreConfigError::Latitude { found_rad: config.site.latitude_rad });
    }
    let finite = |field, found: f64| {
        if found.is_finite() { Ok(()) } else { Err(CoreConfigError::NotFinite { field, found }) }
    };
    let duration = |field, found_s: f64| {
        positive(field, found_s)?;
        if found_s <= DURATION_MAX_S {
            Ok(())
        } else {
            Err(CoreConfigError::TooLong { field, found_s })
        }
    };
    finite("longitude", config.site.longitude_rad)?;
    finite("height", config.site.height_m)?;
    finite("angle random walk", config.noise.angle_random_walk)?;
    finite("velocity random walk", config.noise.velocity_random_walk)?;
    for value in config.initial_parameters.to_array() {
        finite("an initial parameter", value)?;
    }
    if let Alignment::Given { q_nb, velocity_mps } = &config.alignment {
        for value in q_nb.coords.iter().chain(velocity_mps.iter()) {
            finite("the given alignment", *value)?;
        }
    }
    if let Some(found @ 0..2) = config.screening.stuck_samples {
        return Err(CoreConfigError::StuckSamples { found });
    }
    if let Some(gate) = config.screening.gate {
        positive("gate of the innovations", gate.nis)?;
    }
    let screening = &config.screening;
    finite("encoder sigma", screening.encoder_sigma_rad)?;
    for value in [screening.resolution, screening.vibration] {
        finite("resolution or vibration of the increments", value.0 + value.1)?;
    }
    if let Some(limit) = screening.drift_sigmas {
        positive("limit of the drift", limit)?;
    }
    if let Base::Moving(motion) = screening.base {
        let BaseMotion { angle_rad, rate_radps, acceleration_radps2, force_mps2, jerk_mps3 } =
            motion;
        for value in [angle_rad, rate_radps, acceleration_radps2, force_mps2, jerk_mps3] {
            finite("a bound of the base's motion", value)?;
        }
    }
    positive("turntable rate", config.turntable.rate_radps)?;
    positive("turntable acceleration", config.turntable.acceleration_radps2)?;
    match config.alignment {
        Alignment::Given { .. } => {}
        Alignment::Coarse { duration_s } => duration("coarse alignment duration", duration_s)?,
        Alignment::Inertial { duration_s } => {
            duration("inertial alignment duration", duration_s)?;
            if duration_s < SHORTEST_S {
                return Err(CoreConfigError::Short { found_s: duration_s });
            }
        }
    }
    if let Some(calibration) = &config.calibration {
        duration("calibration duration", calibration.duration_s)?;
        if let Estimator::Kalman(kalman) = &calibration.estimator {
            if kalman.aiding_period_ns == 0 || !kalman.aiding_period_ns.is_multiple_of(period_ns) {
                return Err(CoreConfigError::Period {
                    field: "aiding period",
                    found_ns: kalman.aiding_period_ns,
                    expected: "a multiple of the sample period",
                });
            }
            let (AidingMode::Velocity { sigma_mps: sigma }
            | AidingMode::Position { sigma_m: sigma }) = kalman.aiding;
            positive("aiding sigma", sigma)?;
            check_further(&kalman.further)?;
            if kalman.further.attitude_at_rest().is_some() && screening.base != Base::Still {
                return Err(CoreConfigError::AnglesOnMovingBase);
            }
            if kalman.sway == SwayNoise::Coloured {
                if kalman.further.has_border() {
                    return Err(CoreConfigError::SwayWithFurther);
                }
                if !matches!(kalman.aiding, AidingMode::Position { .. }) {
                    return Err(CoreConfigError::SwayWithoutPosition);
                }
                if kalman.aiding_period_ns > SWAY_PERIOD_MAX_NS {
                    return Err(CoreConfigError::Period {
                        field: "aiding period",
                        found_ns: kalman.aiding_period_ns,
                        expected: "2 s at most with a coloured sway",
                    });
                }
            }
        }
    }
    if let Some(navigation) = &config.navigation {
        duration("navigation dwell", navigation.dwell_s)?;
        if let Some(duration_s) = navigation.duration_s {
            duration("navigation duration", duration_s)?;
        }
    }
    if config.calibration.is_none() && config.navigation.is_none() {
        return Err(CoreConfigError::Nothing);
    }
    Ok(())
}
