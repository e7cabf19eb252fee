//! A core's configuration from its structure in C, and back.

use super::status;
use super::types::{CConfig, CStops};
use nalgebra::{Quaternion, Unit};
use octant_calibration::CoreConfig;
use octant_calibration::config::*;
use octant_calibration::sequence::{STOPS_MAX, Sequence, Stop};
use octant_earth::Vector3;
use octant_sample::Parameters;

/// Largest distance of the norm of a quaternion from one.
const NORM_TOLERANCE: f64 = 1e-6;

fn flag(value: i32) -> Result<bool, i32> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(status::NO_ITEM),
    }
}

fn sequence(stops: &CStops) -> Result<Sequence, i32> {
    let count = stops.count as usize;
    if count > STOPS_MAX {
        return Err(status::SEQUENCE);
    }
    let all: [Stop; STOPS_MAX] = core::array::from_fn(|i| Stop {
        azimuth_rad: stops.azimuth_rad[i],
        roll_rad: stops.roll_rad[i],
        weight: stops.weight[i],
    });
    Sequence::new(&all[..count], stops.passes).map_err(|_| status::SEQUENCE)
}

fn stops(sequence: &Sequence) -> CStops {
    let mut stops = CStops {
        azimuth_rad: [0.0; STOPS_MAX],
        roll_rad: [0.0; STOPS_MAX],
        weight: [1.0; STOPS_MAX],
        count: sequence.stops().len() as u32,
        passes: sequence.passes(),
    };
    for (i, stop) in sequence.stops().iter().enumerate() {
        stops.azimuth_rad[i] = stop.azimuth_rad;
        stops.roll_rad[i] = stop.roll_rad;
        stops.weight[i] = stop.weight;
    }
    stops
}

fn quaternion([w, i, j, k]: [f64; 4]) -> Result<octant_earth::UnitQuaternion<f64>, i32> {
    let q = Quaternion::new(w, i, j, k);
    if !((q.norm() - 1.0).abs() <= NORM_TOLERANCE) {
        return Err(status::CONFIG);
    }
    // Its bits stay as they are.
    Ok(Unit::new_unchecked(q))
}

/// Makes the configuration.
///
/// # Errors
/// A code of [`status`]. The core reports other contradictions.
pub fn config(c: &CConfig) -> Result<CoreConfig, i32> {
    let calibration = |c: &CConfig| {
        Ok::<_, i32>(Calibration {
            sequence: sequence(&c.calibration_stops)?,
            duration_s: c.calibration_duration_s,
            estimator: Estimator::Kalman(kalman(c)?),
        })
    };
    let navigation = |c: &CConfig| {
        Ok::<_, i32>(NavigationPlan {
            duration_s: (c.navigation_duration_s != 0.0).then_some(c.navigation_duration_s),
            rotation: sequence(&c.navigation_stops)?,
            dwell_s: c.navigation_dwell_s,
        })
    };
    let duration_s = c.alignment_duration_s;
    Ok(CoreConfig {
        sample_period_ns: c.sample_period_ns,
        site: Site {
            latitude_rad: c.latitude_rad,
            longitude_rad: c.longitude_rad,
            height_m: c.height_m,
        },
        alignment: match c.alignment {
            0 => Alignment::Given {
                q_nb: quaternion(c.alignment_q_nb)?,
                velocity_mps: Vector3::from(c.alignment_velocity_mps),
            },
            1 => Alignment::Coarse { duration_s },
            2 => Alignment::Inertial { duration_s },
            _ => return Err(status::NO_ITEM),
        },
        calibration: flag(c.calibrates)?.then(|| calibration(c)).transpose()?,
        navigation: flag(c.navigates)?.then(|| navigation(c)).transpose()?,
        turntable: TurntableRates {
            rate_radps: c.turntable_rate_radps,
            acceleration_radps2: c.turntable_acceleration_radps2,
        },
        noise: Noise {
            angle_random_walk: c.angle_random_walk,
            velocity_random_walk: c.velocity_random_walk,
        },
        initial_parameters: Parameters::from_array(&c.initial_parameters),
        screening: screening(c)?,
    })
}

fn kalman(c: &CConfig) -> Result<Kalman, i32> {
    let mut estimated = [false; 7];
    for (estimated, value) in estimated.iter_mut().zip(c.estimated) {
        *estimated = flag(value)?;
    }
    Ok(Kalman {
        error_model: match c.error_model {
            0 => ErrorModel::Phi,
            1 => ErrorModel::Psi,
            _ => return Err(status::NO_ITEM),
        },
        estimated,
        prior: Prior {
            attitude_rad: c.prior_attitude_rad,
            velocity_mps: c.prior_velocity_mps,
            position_m: c.prior_position_m,
            parameters: c.prior_parameters,
        },
        aiding: match c.aiding {
            0 => AidingMode::Velocity { sigma_mps: c.aiding_sigma },
            1 => AidingMode::Position { sigma_m: c.aiding_sigma },
            _ => return Err(status::NO_ITEM),
        },
        aiding_period_ns: c.aiding_period_ns,
        sway: match c.sway {
            0 => SwayNoise::White,
            1 => SwayNoise::Coloured,
            _ => return Err(status::NO_ITEM),
        },
        refuse_above_mean_nis: c.refuse_above_mean_nis,
        further: Further::default(),
        sigma_limits: Default::default(),
    })
}

fn screening(c: &CConfig) -> Result<Screening, i32> {
    let recovery = match c.gate_recovery {
        0 => Recovery::Widening,
        1 => Recovery::Reset {
            attitude_rad: c.reset_attitude_rad,
            velocity_mps: c.reset_velocity_mps,
            position_m: c.reset_position_m,
        },
        _ => return Err(status::NO_ITEM),
    };
    let gate = Gate { nis: c.gate_nis, rejections: c.gate_rejections, recovery };
    Ok(Screening {
        gate: (c.gate_nis != 0.0).then_some(gate),
        stuck_samples: (c.stuck_samples != 0).then_some(c.stuck_samples),
        jumps: flag(c.jumps)?,
        bridging: flag(c.bridging)?,
        gimbals: flag(c.gimbals)?,
        drift_sigmas: (c.drift_sigmas != 0.0).then_some(c.drift_sigmas),
        checkpoints: flag(c.checkpoints)?,
        aiding_stamps: flag(c.aiding_stamps)?,
        base: match c.base {
            0 => Base::Still,
            1 => Base::Moving(BaseMotion {
                angle_rad: c.base_angle_rad,
                rate_radps: c.base_rate_radps,
                acceleration_radps2: c.base_acceleration_radps2,
                force_mps2: c.base_force_mps2,
                jerk_mps3: c.base_jerk_mps3,
            }),
            _ => return Err(status::NO_ITEM),
        },
        encoder_sigma_rad: c.encoder_sigma_rad,
        resolution: (c.resolution_theta_rad, c.resolution_velocity_mps),
        vibration: (c.vibration_theta_rad, c.vibration_velocity_mps),
    })
}

/// The structure of a configuration; `None`: it has an estimator other than the Kalman filter, or further states, for
/// which the structure has no fields.
#[must_use]
pub fn in_c(config: &CoreConfig) -> Option<CConfig> {
    let CoreConfig {
        sample_period_ns,
        site: Site { latitude_rad, longitude_rad, height_m },
        alignment,
        calibration,
        navigation,
        turntable: TurntableRates { rate_radps, acceleration_radps2 },
        noise: Noise { angle_random_walk, velocity_random_walk },
        initial_parameters,
        screening,
    } = config;
    let home = [Stop { azimuth_rad: 0.0, roll_rad: 0.0, weight: 1.0 }];
    let nothing = stops(&Sequence::new(&home, 1).ok()?);
    let kalman = match calibration.as_ref().map(|calibration| &calibration.estimator) {
        None => Kalman {
            error_model: ErrorModel::Phi,
            estimated: [true; 7],
            prior: Prior {
                attitude_rad: [0.0; 3],
                velocity_mps: 0.0,
                position_m: 0.0,
                parameters: [0.0; 7],
            },
            aiding: AidingMode::Velocity { sigma_mps: 0.0 },
            aiding_period_ns: 0,
            sway: SwayNoise::White,
            refuse_above_mean_nis: 0.0,
            further: Further::default(),
            sigma_limits: Default::default(),
        },
        Some(Estimator::Kalman(kalman))
            if kalman.further == Further::default()
                && kalman.sigma_limits == Default::default() =>
        {
            *kalman
        }
        Some(_) => return None,
    };
    let (aiding, aiding_sigma) = match kalman.aiding {
        AidingMode::Velocity { sigma_mps } => (0, sigma_mps),
        AidingMode::Position { sigma_m } => (1, sigma_m),
    };
    let gate =
        screening.gate.unwrap_or(Gate { nis: 0.0, rejections: 0, recovery: Recovery::Widening });
    let (gate_recovery, [reset_attitude_rad, reset_velocity_mps, reset_position_m]) =
        match gate.recovery {
            Recovery::Widening => (0, [0.0; 3]),
            Recovery::Reset { attitude_rad, velocity_mps, position_m } => {
                (1, [attitude_rad, velocity_mps, position_m])
            }
        };
    let (base, motion) = match screening.base {
        Base::Still => (
            0,
            BaseMotion {
                angle_rad: 0.0,
                rate_radps: 0.0,
                acceleration_radps2: 0.0,
                force_mps2: 0.0,
                jerk_mps3: 0.0,
            },
        ),
        Base::Moving(motion) => (1, motion),
    };
    let (alignment, alignment_duration_s, alignment_q_nb, alignment_velocity_mps) = match alignment
    {
        Alignment::Given { q_nb, velocity_mps } => {
            let q = q_nb.into_inner();
            (0, 0.0, [q.w, q.i, q.j, q.k], (*velocity_mps).into())
        }
        Alignment::Coarse { duration_s } => (1, *duration_s, [1.0, 0.0, 0.0, 0.0], [0.0; 3]),
        Alignment::Inertial { duration_s } => (2, *duration_s, [1.0, 0.0, 0.0, 0.0], [0.0; 3]),
    };
    Some(CConfig {
        latitude_rad: *latitude_rad,
        longitude_rad: *longitude_rad,
        height_m: *height_m,
        alignment_duration_s,
        alignment_q_nb,
        alignment_velocity_mps,
        calibration_duration_s: calibration.as_ref().map_or(0.0, |c| c.duration_s),
        calibration_stops: calibration.as_ref().map_or(nothing, |c| stops(&c.sequence)),
        prior_attitude_rad: kalman.prior.attitude_rad,
        prior_velocity_mps: kalman.prior.velocity_mps,
        prior_position_m: kalman.prior.position_m,
        prior_parameters: kalman.prior.parameters,
        aiding_sigma,
        refuse_above_mean_nis: kalman.refuse_above_mean_nis,
        navigation_duration_s: navigation.as_ref().and_then(|n| n.duration_s).unwrap_or(0.0),
        navigation_dwell_s: navigation.as_ref().map_or(0.0, |n| n.dwell_s),
        navigation_stops: navigation.as_ref().map_or(nothing, |n| stops(&n.rotation)),
        turntable_rate_radps: *rate_radps,
        turntable_acceleration_radps2: *acceleration_radps2,
        angle_random_walk: *angle_random_walk,
        velocity_random_walk: *velocity_random_walk,
        initial_parameters: initial_parameters.to_array(),
        gate_nis: gate.nis,
        reset_attitude_rad,
        reset_velocity_mps,
        reset_position_m,
        drift_sigmas: screening.drift_sigmas.unwrap_or(0.0),
        base_angle_rad: motion.angle_rad,
        base_rate_radps: motion.rate_radps,
        base_acceleration_radps2: motion.acceleration_radps2,
        base_force_mps2: motion.force_mps2,
        base_jerk_mps3: motion.jerk_mps3,
        encoder_sigma_rad: screening.encoder_sigma_rad,
        resolution_theta_rad: screening.resolution.0,
        resolution_velocity_mps: screening.resolution.1,
        vibration_theta_rad: screening.vibration.0,
        vibration_velocity_mps: screening.vibration.1,
        sample_period_ns: *sample_period_ns,
        aiding_period_ns: kalman.aiding_period_ns,
        alignment,
        calibrates: calibration.is_some().into(),
        navigates: navigation.is_some().into(),
        error_model: kalman.error_model as i32,
        estimated: kalman.estimated.map(i32::from),
        aiding,
        sway: kalman.sway as i32,
        gate_recovery,
        base,
        jumps: screening.jumps.into(),
        bridging: screening.bridging.into(),
        gimbals: screening.gimbals.into(),
        checkpoints: screening.checkpoints.into(),
        aiding_stamps: screening.aiding_stamps.into(),
        gate_rejections: gate.rejections,
        stuck_samples: screening.stuck_samples.unwrap_or(0),
    })
}
