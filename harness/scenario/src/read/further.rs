//! The errors that a filter takes into account beside the thirty parameters.

use crate::error::Problem;
use crate::keys::{
    AccelUse, AngleUse, At, CalibrationKeys, DrawnAccelerations, DrawnAngles, DrawnLengths,
    DrawnQuadratics, DrawnRatios, EstimatorName, FurtherKeys, GimbalAnglesKeys, GyroUse, LeverUse,
    QuadraticUse, RatioUse, ScenarioKeys,
};
use crate::model::{Method, MotionSpec, ParameterDistribution, Scenario};
use octant_calibration::config as core;
use octant_calibration::further::FurtherGroup;

/// Reads the further states of a calibration.
pub(super) fn further(
    keys: &CalibrationKeys,
    motion: &MotionSpec,
) -> Result<core::Further, Problem> {
    let Some(found) = &*keys.further else { return Ok(core::Further::default()) };
    let further = of(found);
    if further == core::Further::default() {
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
    if further.angles.is_some() && matches!(motion, MotionSpec::Dockside(_)) {
        return Err(keys.further.problem(
            "found gimbal_angles with motion.kind = \"dockside\", expected \"static\": the angles show the attitude of the \
             body in a case, which has to stand still",
        ));
    }
    Ok(further)
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
            FurtherGroup::GimbalMounting
            | FurtherGroup::GimbalNonOrthogonality
            | FurtherGroup::EncoderEccentricity => None,
        };
        found.unwrap_or_default()
    };
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
        angles: keys.gimbal_angles.as_ref().map(angles),
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

/// Draws of the errors beside the parameters, group by group; `None`: not drawn. Gauss-Markov biases are processes, which
/// the plant draws.
pub(super) fn drawn(keys: &ScenarioKeys) -> [Option<ParameterDistribution>; 11] {
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

/// Refuses further states for a core that isn't called directly.
pub(super) fn check_endpoint(uri: &At<String>, scenario: &Scenario) -> Result<(), Problem> {
    let has_states = |method| scenario.has_further_states(method);
    if scenario.endpoint.is_in_process()
        || !(has_states(Method::Primary) || has_states(Method::Baseline))
    {
        return Ok(());
    }
    Err(uri.problem(format!(
        "found {:?} with procedure.calibration.further, expected \"in-process\": neither a wire nor an FMU has a \
         place for these states",
        uri.text
    )))
}
