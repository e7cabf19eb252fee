//! The core's configuration from the values of the parameters, and back: bit for bit.

mod field;
mod screening;
mod sequence;

use super::error::CalibratorValueError;
use super::table::{MODEL, slot};
use crate::values::CellValues;
use field::{label, no_item, optional, put_optional};
use nalgebra::{Quaternion, Unit};
use octant_calibration::CoreConfig;
use octant_calibration::config::*;
use octant_earth::{UnitQuaternion, Vector3};
use octant_sample::Parameters;
use octant_sample::parameters::PARAMETER_COUNT;

/// Largest distance of the norm of a quaternion from one; beyond it the value isn't meant as a
/// quaternion.
const NORM_TOLERANCE: f64 = 1e-6;

/// Start values of all parameters that make a core with this configuration: name, and a value for
/// each element. Numbers unchanged, counts as whole numbers (exact up to 2⁵³), enumerations by
/// their values, Booleans as 0 and 1.
#[must_use]
pub fn start_values(config: &CoreConfig) -> Vec<(&'static str, Vec<f64>)> {
    let mut values = CellValues::new(&MODEL);
    put(config, &mut values);
    values.parameters(&MODEL)
}

/// Sets the parameters to a configuration. Parameters that it doesn't use keep their values.
pub fn put(config: &CoreConfig, values: &mut CellValues) {
    let CoreConfig {
        sample_period_ns,
        site,
        alignment,
        calibration,
        navigation,
        turntable,
        noise,
        initial_parameters,
        screening,
    } = config;
    values.set_count(slot::PERIOD, *sample_period_ns);
    values.set_real(slot::SITE_LATITUDE, site.latitude_rad);
    values.set_real(slot::SITE_LONGITUDE, site.longitude_rad);
    values.set_real(slot::SITE_HEIGHT, site.height_m);
    let choice = match alignment {
        Alignment::Given { q_nb, velocity_mps } => {
            put_quaternion(q_nb, slot::ALIGNMENT_ATTITUDE, values);
            values.set_reals(slot::ALIGNMENT_VELOCITY, &(*velocity_mps).into());
            0
        }
        Alignment::Coarse { duration_s } => {
            values.set_real(slot::ALIGNMENT_DURATION, *duration_s);
            1
        }
        Alignment::Inertial { duration_s } => {
            values.set_real(slot::ALIGNMENT_DURATION, *duration_s);
            2
        }
    };
    values.set_integer(slot::ALIGNMENT_METHOD, choice);
    values.set_boolean(slot::CALIBRATION, calibration.is_some());
    if let Some(calibration) = calibration {
        put_calibration(calibration, values);
    }
    values.set_boolean(slot::NAVIGATION, navigation.is_some());
    if let Some(navigation) = navigation {
        put_navigation(navigation, values);
    }
    values.set_real(slot::TURNTABLE_RATE, turntable.rate_radps);
    values.set_real(slot::TURNTABLE_ACCELERATION, turntable.acceleration_radps2);
    values.set_real(slot::ANGLE_RANDOM_WALK, noise.angle_random_walk);
    values.set_real(slot::VELOCITY_RANDOM_WALK, noise.velocity_random_walk);
    values.set_reals(slot::INITIAL_PARAMETERS, &initial_parameters.to_array());
    screening::put(screening, values);
}

/// Makes the configuration from the parameters.
///
/// # Errors
/// If a sequence or a quaternion is invalid: the variable, the value found and the values expected.
/// The core reports other contradictions.
pub fn config(values: &CellValues) -> Result<CoreConfig, CalibratorValueError> {
    Ok(CoreConfig {
        sample_period_ns: values.count(slot::PERIOD),
        site: Site {
            latitude_rad: values.real(slot::SITE_LATITUDE),
            longitude_rad: values.real(slot::SITE_LONGITUDE),
            height_m: values.real(slot::SITE_HEIGHT),
        },
        alignment: match values.integer(slot::ALIGNMENT_METHOD) {
            0 => Alignment::Given {
                q_nb: quaternion(slot::ALIGNMENT_ATTITUDE, values)?,
                velocity_mps: Vector3::from(values.reals(slot::ALIGNMENT_VELOCITY)),
            },
            1 => Alignment::Coarse { duration_s: values.real(slot::ALIGNMENT_DURATION) },
            2 => Alignment::Inertial { duration_s: values.real(slot::ALIGNMENT_DURATION) },
            _ => return Err(no_item(slot::ALIGNMENT_METHOD, values)),
        },
        calibration: values.boolean(slot::CALIBRATION).then(|| calibration(values)).transpose()?,
        navigation: values.boolean(slot::NAVIGATION).then(|| navigation(values)).transpose()?,
        turntable: TurntableRates {
            rate_radps: values.real(slot::TURNTABLE_RATE),
            acceleration_radps2: values.real(slot::TURNTABLE_ACCELERATION),
        },
        noise: Noise {
            angle_random_walk: values.real(slot::ANGLE_RANDOM_WALK),
            velocity_random_walk: values.real(slot::VELOCITY_RANDOM_WALK),
        },
        initial_parameters: Parameters::from_array(
            &values.reals::<PARAMETER_COUNT>(slot::INITIAL_PARAMETERS),
        ),
        screening: screening::get(values)?,
    })
}

fn put_calibration(calibration: &Calibration, values: &mut CellValues) {
    let Calibration { sequence, duration_s, estimator } = calibration;
    sequence::CALIBRATION.put(sequence, values);
    values.set_real(slot::CALIBRATION_DURATION, *duration_s);
    let choice = match estimator {
        Estimator::Kalman(kalman) => {
            put_kalman(kalman, values);
            0
        }
        Estimator::LeastSquares(least_squares) => {
            put_least_squares(least_squares, values);
            1
        }
        Estimator::ExternalTurntable(ExternalTurntable { q_nc, encoder_sigma_rad }) => {
            put_quaternion(q_nc, slot::EXTERNAL_ATTITUDE, values);
            values.set_real(slot::EXTERNAL_SIGMA, *encoder_sigma_rad);
            2
        }
    };
    values.set_integer(slot::ESTIMATOR, choice);
}

fn calibration(values: &CellValues) -> Result<Calibration, CalibratorValueError> {
    Ok(Calibration {
        sequence: sequence::CALIBRATION.get(values)?,
        duration_s: values.real(slot::CALIBRATION_DURATION),
        estimator: match values.integer(slot::ESTIMATOR) {
            0 => Estimator::Kalman(kalman(values)?),
            1 => Estimator::LeastSquares(least_squares(values)?),
            2 => Estimator::ExternalTurntable(ExternalTurntable {
                q_nc: quaternion(slot::EXTERNAL_ATTITUDE, values)?,
                encoder_sigma_rad: values.real(slot::EXTERNAL_SIGMA),
            }),
            _ => return Err(no_item(slot::ESTIMATOR, values)),
        },
    })
}

fn put_kalman(kalman: &Kalman, values: &mut CellValues) {
    let Kalman {
        error_model,
        estimated,
        prior: Prior { attitude_rad, velocity_mps, position_m, parameters },
        aiding,
        aiding_period_ns,
        sway,
        refuse_above_mean_nis,
        further: _,
        sigma_limits: _,
    } = kalman;
    let choice = match error_model {
        ErrorModel::Phi => 0,
        ErrorModel::Psi => 1,
    };
    values.set_integer(slot::ERROR_MODEL, choice);
    for (group, estimated) in estimated.iter().enumerate() {
        values.set_boolean(slot::ESTIMATED + group, *estimated);
    }
    values.set_reals(slot::PRIOR_ATTITUDE, attitude_rad);
    values.set_real(slot::PRIOR_VELOCITY, *velocity_mps);
    values.set_real(slot::PRIOR_POSITION, *position_m);
    values.set_reals(slot::PRIOR_PARAMETERS, parameters);
    let choice = match aiding {
        AidingMode::Velocity { sigma_mps } => {
            values.set_real(slot::AIDING_VELOCITY_SIGMA, *sigma_mps);
            0
        }
        AidingMode::Position { sigma_m } => {
            values.set_real(slot::AIDING_POSITION_SIGMA, *sigma_m);
            1
        }
    };
    values.set_integer(slot::AIDING_REFERENCE, choice);
    values.set_count(slot::AIDING_PERIOD, *aiding_period_ns);
    let choice = match sway {
        SwayNoise::White => 0,
        SwayNoise::Coloured => 1,
    };
    values.set_integer(slot::AIDING_SWAY, choice);
    values.set_real(slot::REFUSE_ABOVE, *refuse_above_mean_nis);
}

fn kalman(values: &CellValues) -> Result<Kalman, CalibratorValueError> {
    Ok(Kalman {
        error_model: match values.integer(slot::ERROR_MODEL) {
            0 => ErrorModel::Phi,
            1 => ErrorModel::Psi,
            _ => return Err(no_item(slot::ERROR_MODEL, values)),
        },
        estimated: core::array::from_fn(|group| values.boolean(slot::ESTIMATED + group)),
        prior: Prior {
            attitude_rad: values.reals(slot::PRIOR_ATTITUDE),
            velocity_mps: values.real(slot::PRIOR_VELOCITY),
            position_m: values.real(slot::PRIOR_POSITION),
            parameters: values.reals(slot::PRIOR_PARAMETERS),
        },
        aiding: match values.integer(slot::AIDING_REFERENCE) {
            0 => AidingMode::Velocity { sigma_mps: values.real(slot::AIDING_VELOCITY_SIGMA) },
            1 => AidingMode::Position { sigma_m: values.real(slot::AIDING_POSITION_SIGMA) },
            _ => return Err(no_item(slot::AIDING_REFERENCE, values)),
        },
        aiding_period_ns: values.count(slot::AIDING_PERIOD),
        sway: match values.integer(slot::AIDING_SWAY) {
            0 => SwayNoise::White,
            1 => SwayNoise::Coloured,
            _ => return Err(no_item(slot::AIDING_SWAY, values)),
        },
        refuse_above_mean_nis: values.real(slot::REFUSE_ABOVE),
        further: Default::default(),
        sigma_limits: Default::default(),
    })
}

fn put_least_squares(settings: &LeastSquares, values: &mut CellValues) {
    let LeastSquares { gravity_mps2, gyro, intervals } = settings;
    put_optional(*gravity_mps2, slot::GRAVITY_GIVEN, slot::GRAVITY, values);
    let choice = match gyro {
        GyroReference::EarthRate => 0,
        GyroReference::RotatedGravity => 1,
    };
    values.set_integer(slot::GYRO_REFERENCE, choice);
    let choice = match *intervals {
        StaticIntervals::Commanded => 0,
        StaticIntervals::Detected { initial_s, window_s, threshold, shortest_s } => {
            values.set_real(slot::INTERVALS_INITIAL, initial_s);
            values.set_real(slot::INTERVALS_WINDOW, window_s);
            values.set_real(slot::INTERVALS_THRESHOLD, threshold);
            values.set_real(slot::INTERVALS_SHORTEST, shortest_s);
            1
        }
    };
    values.set_integer(slot::INTERVALS, choice);
}

fn least_squares(values: &CellValues) -> Result<LeastSquares, CalibratorValueError> {
    Ok(LeastSquares {
        gravity_mps2: optional(slot::GRAVITY_GIVEN, slot::GRAVITY, values),
        gyro: match values.integer(slot::GYRO_REFERENCE) {
            0 => GyroReference::EarthRate,
            1 => GyroReference::RotatedGravity,
            _ => return Err(no_item(slot::GYRO_REFERENCE, values)),
        },
        intervals: match values.integer(slot::INTERVALS) {
            0 => StaticIntervals::Commanded,
            1 => StaticIntervals::Detected {
                initial_s: values.real(slot::INTERVALS_INITIAL),
                window_s: values.real(slot::INTERVALS_WINDOW),
                threshold: values.real(slot::INTERVALS_THRESHOLD),
                shortest_s: values.real(slot::INTERVALS_SHORTEST),
            },
            _ => return Err(no_item(slot::INTERVALS, values)),
        },
    })
}

fn put_navigation(plan: &NavigationPlan, values: &mut CellValues) {
    let NavigationPlan { duration_s, rotation, dwell_s } = plan;
    values.set_boolean(slot::NAVIGATION_ENDLESS, duration_s.is_none());
    if let Some(duration_s) = duration_s {
        values.set_real(slot::NAVIGATION_DURATION, *duration_s);
    }
    sequence::ROTATION.put(rotation, values);
    values.set_real(slot::NAVIGATION_DWELL, *dwell_s);
}

fn navigation(values: &CellValues) -> Result<NavigationPlan, CalibratorValueError> {
    Ok(NavigationPlan {
        duration_s: (!values.boolean(slot::NAVIGATION_ENDLESS))
            .then(|| values.real(slot::NAVIGATION_DURATION)),
        rotation: sequence::ROTATION.get(values)?,
        dwell_s: values.real(slot::NAVIGATION_DWELL),
    })
}

fn put_quaternion(q: &UnitQuaternion<f64>, slot: usize, values: &mut CellValues) {
    values.set_reals(slot, &[q.w, q.i, q.j, q.k]);
}

/// Without normalization, which would change its last bits.
fn quaternion(
    slot: usize,
    values: &CellValues,
) -> Result<UnitQuaternion<f64>, CalibratorValueError> {
    let [w, i, j, k] = values.reals(slot);
    let q = Quaternion::new(w, i, j, k);
    let norm = q.norm();
    if (norm - 1.0).abs() <= NORM_TOLERANCE {
        Ok(Unit::new_unchecked(q))
    } else {
        Err(CalibratorValueError::Norm { label: label(slot), norm })
    }
}
