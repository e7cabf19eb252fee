//! The errors that a filter takes into account beside the thirty parameters.

use crate::error::Problem;
use crate::keys::{
    AccelPerKelvinUse, AccelUse, AngleUse, At, CalibrationKeys, CaseRestKeys, DrawnAccelerations,
    DrawnAccelsPerKelvin, DrawnAngles, DrawnGyrosPerKelvin, DrawnLengths, DrawnQuadratics,
    DrawnRatios, DrawnScalesPerKelvin, EstimatorName, FurtherKeys, GimbalAnglesKeys,
    GyroPerKelvinUse, GyroUse, LeverUse, QuadraticUse, RatioUse, ScalePerKelvinUse, ScenarioKeys,
};
use crate::model::{CalibrationSpec, Method, MotionSpec, ParameterDistribution, Scenario};
use octant_calibration::config as core;
use octant_calibration::further::FurtherGroup;
use octant_plant::config as plant;

/// Reads the further states of a calibration.
pub(super) fn further(
    keys: &CalibrationKeys,
    motion: &MotionSpec,
) -> Result<core::Further, Problem> {
    let further = core::Further {
        rest: keys.aiding.rest.as_ref().map(rest),
        ..keys.further.as_ref().map_or_else(core::Further::default, of)
    };
    if further == core::Further::default() {
        return Ok(further);
    }
    if further.rest.is_some() {
        check_rest(keys, motion, &further)?;
    }
    if keys.further.is_none() {
        return Ok(further);
    }
    if !matches!(*keys.estimator, EstimatorName::Kalman) {
        return Err(keys.further.problem(format!(
            "found with estimator = {:?}, expected \"kalman\", whose states they are",
            keys.estimator.text
        )));
    }
    if further.has_states() && *keys.aiding.sway == core::SwayNoise::Coloured {
        return Err(keys.further.problem(
            "found with aiding.sway = \"coloured\", expected \"white\": the filter has room for one of the two",
        ));
    }
    if further.angles.is_some() && further.follows_temperature() {
        return Err(keys.further.problem(
            "found gimbal_angles with errors that follow the temperature, expected one of the two: the filter has room for one",
        ));
    }
    if further.angles.is_some() && matches!(motion, MotionSpec::Dockside(_)) {
        return Err(keys.further.problem(
            "found gimbal_angles with motion.kind = \"dockside\", expected \"static\": the angles show the attitude of the \
             body in a case, which has to stand still",
        ));
    }
    Ok(further)
}

/// Refuses a case at rest where it isn't one, or where nothing measures it.
fn check_rest(
    keys: &CalibrationKeys,
    motion: &MotionSpec,
    further: &core::Further,
) -> Result<(), Problem> {
    let found = &keys.aiding.rest;
    if !matches!(*keys.estimator, EstimatorName::Kalman) {
        return Err(found.problem(format!(
            "found with estimator = {:?}, expected \"kalman\": least squares takes every case for one at rest",
            keys.estimator.text
        )));
    }
    if matches!(motion, MotionSpec::Dockside(_)) {
        return Err(found.problem(
            "found with motion.kind = \"dockside\", expected \"static\": a case that moves isn't at rest",
        ));
    }
    if further.follows_temperature() {
        return Err(found.problem(
            "found with errors that follow the temperature, expected one of the two: the filter has room for one",
        ));
    }
    Ok(())
}

/// Case at rest.
fn rest(keys: &CaseRestKeys) -> core::CaseRest {
    core::CaseRest {
        wander_rad_per_sqrt_s: keys.wander,
        range_rad: keys.range,
        jitter_rad: keys.jitter,
    }
}

fn of(keys: &FurtherKeys) -> core::Further {
    let treatment = |group| {
        let found = match group {
            FurtherGroup::AccelLever => keys.accel_lever.as_ref().map(LeverUse::treatment),
            FurtherGroup::GyroAsymmetry => keys.gyro_asymmetry.as_ref().map(RatioUse::treatment),
            FurtherGroup::AccelAsymmetry => keys.accel_asymmetry.as_ref().map(RatioUse::treatment),
            FurtherGroup::AccelQuadratic => {
                keys.accel_quadratic.as_ref().map(QuadraticUse::treatment)
            }
            FurtherGroup::GyroGaussMarkov => {
                keys.gyro_gauss_markov.as_ref().map(GyroUse::treatment)
            }
            FurtherGroup::AccelGaussMarkov => {
                keys.accel_gauss_markov.as_ref().map(AccelUse::treatment)
            }
            FurtherGroup::Deflection => keys.deflection.as_ref().map(AngleUse::treatment),
            FurtherGroup::GravityAnomaly => keys.gravity_anomaly.as_ref().map(AccelUse::treatment),
            FurtherGroup::GyroBiasTemperature => {
                keys.gyro_bias_temperature.as_ref().map(GyroPerKelvinUse::treatment)
            }
            FurtherGroup::GyroScaleTemperature => {
                keys.gyro_scale_temperature.as_ref().map(ScalePerKelvinUse::treatment)
            }
            FurtherGroup::AccelBiasTemperature => {
                keys.accel_bias_temperature.as_ref().map(AccelPerKelvinUse::treatment)
            }
            FurtherGroup::AccelScaleTemperature => {
                keys.accel_scale_temperature.as_ref().map(ScalePerKelvinUse::treatment)
            }
            FurtherGroup::GimbalMounting
            | FurtherGroup::GimbalNonOrthogonality
            | FurtherGroup::EncoderEccentricity => None,
        };
        found.unwrap_or_default()
    };
    let temperature = core::TemperatureErrors {
        groups: FurtherGroup::OF_TEMPERATURE.map(treatment),
        reference_c: keys.temperature_reference_c,
    };
    // As with times below: a reference without what follows it is none.
    let is_off = temperature.groups == [core::FurtherUse::Off; 4];
    let groups = std::array::from_fn(|index| treatment(FurtherGroup::ALL[index]));
    // A time without its process is none, so that a table without groups is as good as no table.
    let time = |is_there: bool, time_s| if is_there { time_s } else { 0.0 };
    core::Further {
        groups,
        gyro_correlation_time_s: time(keys.gyro_gauss_markov.is_some(), keys.gyro_correlation_time),
        accel_correlation_time_s: time(
            keys.accel_gauss_markov.is_some(),
            keys.accel_correlation_time,
        ),
        gyro_rate_random_walk: keys.gyro_rate_random_walk,
        temperature: (!is_off).then_some(temperature),
        angles: keys.gimbal_angles.as_ref().map(angles),
        rest: None,
    }
}

/// Gimbal angles as measurements.
fn angles(keys: &GimbalAnglesKeys) -> core::AngleMeasurements {
    let groups = [&keys.mounting, &keys.non_orthogonality, &keys.eccentricity];
    core::AngleMeasurements {
        sigma_rad: keys.sigma,
        curve_sigma_rad: keys.curve,
        groups: groups.map(|found| found.as_ref().map(AngleUse::treatment).unwrap_or_default()),
    }
}

/// Draws of the errors beside the parameters, group by group; `None`: not drawn.
pub(super) fn drawn(keys: &ScenarioKeys) -> Result<[Option<ParameterDistribution>; 15], Problem> {
    if let (Some(imu), None) = (&keys.imu.extensions.drawn, &keys.imu.extensions.temperature) {
        let constant = "found with a temperature that is constant, expected [imu.extensions.temperature] with a ramp and a plateau";
        let scales = [&imu.gyro_scale_temperature, &imu.accel_scale_temperature];
        if imu.gyro_bias_temperature.is_some() {
            return Err(imu.gyro_bias_temperature.problem(constant));
        }
        if imu.accel_bias_temperature.is_some() {
            return Err(imu.accel_bias_temperature.problem(constant));
        }
        if let Some(scale) = scales.into_iter().find(|scale| scale.is_some()) {
            return Err(scale.problem(constant));
        }
    }
    Ok(drawn_groups(keys))
}

/// Gauss-Markov biases are processes, which the plant draws.
fn drawn_groups(keys: &ScenarioKeys) -> [Option<ParameterDistribution>; 15] {
    let (imu, site) = (keys.imu.extensions.drawn.as_ref(), keys.site.drawn.as_ref());
    let table = keys.turntable.drawn.as_ref();
    FurtherGroup::ALL.map(|group| match group {
        FurtherGroup::AccelLever => imu?.lever_arm.as_ref().map(DrawnLengths::distribution),
        FurtherGroup::GyroAsymmetry => imu?.gyro_asymmetry.as_ref().map(DrawnRatios::distribution),
        FurtherGroup::AccelAsymmetry => {
            imu?.accel_asymmetry.as_ref().map(DrawnRatios::distribution)
        }
        FurtherGroup::AccelQuadratic => {
            imu?.accel_quadratic.as_ref().map(DrawnQuadratics::distribution)
        }
        FurtherGroup::GyroGaussMarkov | FurtherGroup::AccelGaussMarkov => None,
        FurtherGroup::GyroBiasTemperature => {
            imu?.gyro_bias_temperature.as_ref().map(DrawnGyrosPerKelvin::distribution)
        }
        FurtherGroup::GyroScaleTemperature => {
            imu?.gyro_scale_temperature.as_ref().map(DrawnScalesPerKelvin::distribution)
        }
        FurtherGroup::AccelBiasTemperature => {
            imu?.accel_bias_temperature.as_ref().map(DrawnAccelsPerKelvin::distribution)
        }
        FurtherGroup::AccelScaleTemperature => {
            imu?.accel_scale_temperature.as_ref().map(DrawnScalesPerKelvin::distribution)
        }
        FurtherGroup::Deflection => site?.deflection.as_ref().map(DrawnAngles::distribution),
        FurtherGroup::GravityAnomaly => {
            site?.gravity_anomaly.as_ref().map(DrawnAccelerations::distribution)
        }
        FurtherGroup::GimbalMounting => table?.mounting.as_ref().map(DrawnAngles::distribution),
        FurtherGroup::GimbalNonOrthogonality => {
            table?.non_orthogonality.as_ref().map(DrawnAngles::distribution)
        }
        FurtherGroup::EncoderEccentricity => {
            table?.eccentricity.as_ref().map(DrawnAngles::distribution)
        }
    })
}

/// Refuses a reference of the temperature that isn't the one at which a simulated instrument has its true parameters.
pub(super) fn check_reference(
    keys: &At<Option<CalibrationKeys>>,
    scenario: &Scenario,
) -> Result<(), Problem> {
    let Some(keys) = &**keys else { return Ok(()) };
    let found = keys.further.as_ref().and_then(|further| further.temperature_reference_c);
    match found {
        Some(found) if scenario.source.has_plant() && found != plant::START_TEMPERATURE_C => {
            Err(keys.further.problem(format!(
                "found temperature_reference_c = {found} with a simulated instrument, expected {}, its temperature at the \
                 start, for which its parameters are given",
                plant::START_TEMPERATURE_C
            )))
        }
        _ => Ok(()),
    }
}

/// Refuses further states for a core that isn't called directly.
pub(super) fn check_endpoint(uri: &At<String>, scenario: &Scenario) -> Result<(), Problem> {
    let has_states = |method| scenario.has_further_states(method);
    if scenario.endpoint.is_in_process()
        || !(has_states(Method::Primary) || has_states(Method::Baseline))
    {
        return Ok(());
    }
    Err(uri.problem(format!(
        "found {:?} with procedure.calibration.further or aiding.rest, expected \"in-process\": neither a wire nor an FMU \
         has a place for these states",
        uri.text
    )))
}

/// Refuses limits of standard deviations for a core that isn't called directly.
pub(super) fn check_limits(uri: &At<String>, scenario: &Scenario) -> Result<(), Problem> {
    let has_limits = |calibration: &Option<CalibrationSpec>| {
        let estimator = calibration.as_ref().map(|calibration| &calibration.estimator);
        matches!(estimator, Some(core::Estimator::Kalman(of)) if of.sigma_limits != core::SigmaLimits::default())
    };
    if scenario.endpoint.is_in_process()
        || !(has_limits(&scenario.calibration) || has_limits(&scenario.baseline))
    {
        return Ok(());
    }
    Err(uri.problem(format!(
        "found {:?} with procedure.calibration.refuse_above_sigma, expected \"in-process\": neither a wire nor an FMU has \
         a place for these limits, and its core has those of the instrument's grade",
        uri.text
    )))
}
