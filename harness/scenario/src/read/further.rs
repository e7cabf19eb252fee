//! The errors that a filter takes into account beside the thirty parameters.

use crate::error::Problem;
use crate::keys::{At, CalibrationKeys, EstimatorName, FurtherKeys};
use crate::model::Scenario;
use octant_calibration::config as core;
use octant_calibration::further::FurtherGroup;

/// Reads the further states of a calibration.
pub(super) fn further(keys: &CalibrationKeys) -> Result<core::Further, Problem> {
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
    Ok(further)
}

fn of(keys: &FurtherKeys) -> core::Further {
    let off = core::FurtherUse::Off;
    let groups = FurtherGroup::ALL.map(|group| match group {
        FurtherGroup::AccelLever => keys.accel_lever.as_ref().map_or(off, |of| of.treatment()),
        FurtherGroup::GyroAsymmetry => {
            keys.gyro_asymmetry.as_ref().map_or(off, |of| of.treatment())
        }
        FurtherGroup::AccelAsymmetry => {
            keys.accel_asymmetry.as_ref().map_or(off, |of| of.treatment())
        }
        FurtherGroup::AccelQuadratic => {
            keys.accel_quadratic.as_ref().map_or(off, |of| of.treatment())
        }
        FurtherGroup::GyroGaussMarkov => {
            keys.gyro_gauss_markov.as_ref().map_or(off, |of| of.treatment())
        }
        FurtherGroup::AccelGaussMarkov => {
            keys.accel_gauss_markov.as_ref().map_or(off, |of| of.treatment())
        }
        FurtherGroup::Deflection => keys.deflection.as_ref().map_or(off, |of| of.treatment()),
        FurtherGroup::GravityAnomaly => {
            keys.gravity_anomaly.as_ref().map_or(off, |of| of.treatment())
        }
    });
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
    }
}

/// Refuses further states for a core that isn't called directly.
pub(super) fn check_endpoint(uri: &At<String>, scenario: &Scenario) -> Result<(), Problem> {
    if scenario.endpoint.is_in_process() || !scenario.has_further_states() {
        return Ok(());
    }
    Err(uri.problem(format!(
        "found {:?} with procedure.calibration.further, expected \"in-process\": neither a wire nor an FMU has a \
         place for these states",
        uri.text
    )))
}
