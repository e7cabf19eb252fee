//! The plant's configuration from the values of the parameters, and back: bit for bit.

use super::error::PlantValueError;
use super::table::{MODEL, SINUSOIDS_MAX, slot};
use crate::values::CellValues;
use octant_plant::config::*;
use octant_sample::Parameters;
use octant_sample::parameters::PARAMETER_COUNT;

/// Limit from which seeds don't fit a Real: the rest goes into the upper half.
const SEED_EXACT: u64 = 1 << 53;

/// Sets the parameters to a configuration. Parameters that it doesn't use keep their values.
///
/// # Errors
/// If a motion of the ship has more sinusoids than there is room for, or there is no parameter for something.
pub(super) fn put(config: &PlantConfig, values: &mut CellValues) -> Result<(), PlantValueError> {
    let PlantConfig {
        sample_period_ns,
        seed,
        calibration_samples,
        site: PlantSite { latitude_rad, longitude_rad, height_m, gravity },
        motion,
        turntable,
        imu,
        aiding,
    } = config;
    let extensions = &imu.extensions;
    for (name, has_value) in [
        ("the gravity disturbance of the site", *gravity != GravityDisturbance::default()),
        (
            "the mounting on the gimbals and the given errors of the encoders",
            turntable.errors != GimbalErrors::default(),
        ),
        ("the asymmetry of the gyros", extensions.gyro_asymmetry != [0.0; 3]),
        ("the asymmetry of the accelerometers", extensions.accel_asymmetry != [0.0; 3]),
        ("the second order of the accelerometers", extensions.accel_quadratic != [0.0; 3]),
    ] {
        if has_value {
            return Err(PlantValueError::NoParameter(name));
        }
    }
    values.set_count(slot::PERIOD, *sample_period_ns);
    let (seed, high) =
        if *seed < SEED_EXACT { (*seed, 0) } else { (*seed & 0xFFFF_FFFF, *seed >> 32) };
    values.set_count(slot::SEED, seed);
    values.set_count(slot::SEED_HIGH, high);
    let endless = *calibration_samples == u64::MAX;
    values.set_boolean(slot::CALIBRATION_ENDLESS, endless);
    if !endless {
        values.set_count(slot::CALIBRATION_SAMPLES, *calibration_samples);
    }
    values.set_real(slot::SITE_LATITUDE, *latitude_rad);
    values.set_real(slot::SITE_LONGITUDE, *longitude_rad);
    values.set_real(slot::SITE_HEIGHT, *height_m);
    match motion {
        Motion::Static(attitude) => {
            values.set_integer(slot::MOTION, 0);
            put_attitude(attitude, values);
        }
        Motion::Dockside(ship) => {
            values.set_integer(slot::MOTION, 1);
            put_ship(ship, values)?;
        }
    }
    let TurntableConfig {
        rate_radps,
        acceleration_radps2,
        encoder_sigma_rad,
        non_orthogonality_rad,
        backlash_rad,
        errors: _,
    } = turntable;
    values.set_real(slot::TURNTABLE_RATE, *rate_radps);
    values.set_real(slot::TURNTABLE_ACCELERATION, *acceleration_radps2);
    values.set_real(slot::ENCODER_SIGMA, *encoder_sigma_rad);
    values.set_real(slot::NON_ORTHOGONALITY, *non_orthogonality_rad);
    values.set_real(slot::BACKLASH, *backlash_rad);
    let Imu { parameters, angle_random_walk, velocity_random_walk, extensions } = imu;
    values.set_reals(slot::PARAMETERS, &parameters.to_array());
    values.set_real(slot::ANGLE_RANDOM_WALK, *angle_random_walk);
    values.set_real(slot::VELOCITY_RANDOM_WALK, *velocity_random_walk);
    put_extensions(extensions, values);
    let AidingSource { kind, period_ns } = aiding;
    let choice = match *kind {
        AidingKind::ZeroVelocity { sigma_mps } => {
            values.set_real(slot::AIDING_VELOCITY_SIGMA, sigma_mps);
            0
        }
        AidingKind::Velocity { sigma_mps } => {
            values.set_real(slot::AIDING_VELOCITY_SIGMA, sigma_mps);
            1
        }
        AidingKind::DockPosition { sigma_m } => {
            values.set_real(slot::AIDING_POSITION_SIGMA, sigma_m);
            2
        }
    };
    values.set_integer(slot::AIDING_REFERENCE, choice);
    values.set_count(slot::AIDING_PERIOD, *period_ns);
    Ok(())
}

/// Makes the configuration from the parameters.
///
/// # Errors
/// If a number or an item is invalid: the variable, the value found and the values expected. The
/// plant reports other contradictions.
pub fn config(values: &CellValues) -> Result<PlantConfig, PlantValueError> {
    let endless = values.boolean(slot::CALIBRATION_ENDLESS);
    let high = values.count(slot::SEED_HIGH);
    Ok(PlantConfig {
        sample_period_ns: values.count(slot::PERIOD),
        seed: values.count(slot::SEED).wrapping_add(high.wrapping_shl(32)),
        calibration_samples: if endless {
            u64::MAX
        } else {
            values.count(slot::CALIBRATION_SAMPLES)
        },
        site: PlantSite {
            latitude_rad: values.real(slot::SITE_LATITUDE),
            longitude_rad: values.real(slot::SITE_LONGITUDE),
            height_m: values.real(slot::SITE_HEIGHT),
            gravity: Default::default(),
        },
        motion: match values.integer(slot::MOTION) {
            0 => Motion::Static(attitude(values)),
            1 => Motion::Dockside(ship(values)?),
            _ => return Err(no_item(slot::MOTION, values)),
        },
        turntable: TurntableConfig {
            rate_radps: values.real(slot::TURNTABLE_RATE),
            acceleration_radps2: values.real(slot::TURNTABLE_ACCELERATION),
            encoder_sigma_rad: values.real(slot::ENCODER_SIGMA),
            non_orthogonality_rad: values.real(slot::NON_ORTHOGONALITY),
            backlash_rad: values.real(slot::BACKLASH),
            errors: GimbalErrors::default(),
        },
        imu: Imu {
            parameters: Parameters::from_array(&values.reals::<PARAMETER_COUNT>(slot::PARAMETERS)),
            angle_random_walk: values.real(slot::ANGLE_RANDOM_WALK),
            velocity_random_walk: values.real(slot::VELOCITY_RANDOM_WALK),
            extensions: extensions(values),
        },
        aiding: AidingSource {
            kind: match values.integer(slot::AIDING_REFERENCE) {
                0 => {
                    AidingKind::ZeroVelocity { sigma_mps: values.real(slot::AIDING_VELOCITY_SIGMA) }
                }
                1 => AidingKind::Velocity { sigma_mps: values.real(slot::AIDING_VELOCITY_SIGMA) },
                2 => AidingKind::DockPosition { sigma_m: values.real(slot::AIDING_POSITION_SIGMA) },
                _ => return Err(no_item(slot::AIDING_REFERENCE, values)),
            },
            period_ns: values.count(slot::AIDING_PERIOD),
        },
    })
}

fn put_attitude(attitude: &CaseAttitude, values: &mut CellValues) {
    let CaseAttitude { heading_rad, pitch_rad, roll_rad } = attitude;
    values.set_real(slot::MEAN_HEADING, *heading_rad);
    values.set_real(slot::MEAN_PITCH, *pitch_rad);
    values.set_real(slot::MEAN_ROLL, *roll_rad);
}

fn attitude(values: &CellValues) -> CaseAttitude {
    CaseAttitude {
        heading_rad: values.real(slot::MEAN_HEADING),
        pitch_rad: values.real(slot::MEAN_PITCH),
        roll_rad: values.real(slot::MEAN_ROLL),
    }
}

/// Slots of number, amplitudes, periods and phases of a motion of the ship, by its index among the
/// six.
fn motion_slots(motion: usize) -> [usize; 4] {
    let count = slot::ROLL_COUNT + motion * slot::MOTION_STRIDE;
    [count, count + 1, count + 1 + SINUSOIDS_MAX, count + 1 + 2 * SINUSOIDS_MAX]
}

fn put_ship(ship: &Dockside, values: &mut CellValues) -> Result<(), PlantValueError> {
    let Dockside { mean, roll, pitch, yaw, surge, sway, heave, mooring_offset_m, times } = ship;
    if !times.is_always() {
        return Err(PlantValueError::NoParameter("the beginning of the ship's motion"));
    }
    put_attitude(mean, values);
    values.set_reals(slot::MOORING_OFFSET, mooring_offset_m);
    for (index, sinusoids) in [roll, pitch, yaw, surge, sway, heave].into_iter().enumerate() {
        let [count, amplitude, period, phase] = motion_slots(index);
        let found = sinusoids.len();
        if found > SINUSOIDS_MAX {
            return Err(PlantValueError::TooManySinusoids { label: MODEL.label(count), found });
        }
        values.set_integer(count, found as i32);
        for (i, sinusoid) in sinusoids.iter().enumerate() {
            let Sinusoid { amplitude: size, period_s, phase_rad } = sinusoid;
            values.set_real(amplitude + i, *size);
            values.set_real(period + i, *period_s);
            values.set_real(phase + i, *phase_rad);
        }
    }
    Ok(())
}

fn ship(values: &CellValues) -> Result<Dockside, PlantValueError> {
    let motion = |index| sinusoids(index, values);
    Ok(Dockside {
        mean: attitude(values),
        roll: motion(0)?,
        pitch: motion(1)?,
        yaw: motion(2)?,
        surge: motion(3)?,
        sway: motion(4)?,
        heave: motion(5)?,
        mooring_offset_m: values.reals(slot::MOORING_OFFSET),
        times: MotionTimes::default(),
    })
}

fn sinusoids(motion: usize, values: &CellValues) -> Result<Vec<Sinusoid>, PlantValueError> {
    let [count, amplitude, period, phase] = motion_slots(motion);
    let found = values.integer(count);
    let Some(number) = usize::try_from(found).ok().filter(|number| *number <= SINUSOIDS_MAX) else {
        return Err(PlantValueError::Sinusoids { label: MODEL.label(count), found });
    };
    let one = |i| Sinusoid {
        amplitude: values.real(amplitude + i),
        period_s: values.real(period + i),
        phase_rad: values.real(phase + i),
    };
    Ok((0..number).map(one).collect())
}

fn put_extensions(extensions: &Extensions, values: &mut CellValues) {
    let Extensions {
        gyro_gauss_markov,
        accel_gauss_markov,
        gyro_rate_random_walk,
        gyro_bias_instability,
        accel_bias_instability,
        gyro_quantization_rad,
        accel_quantization_mps,
        gyro_range_radps,
        accel_range_mps2,
        temperature,
        vibration,
        lever_arm_m,
        // Zero: there are no parameters for them.
        gyro_asymmetry: _,
        accel_asymmetry: _,
        accel_quadratic: _,
        time_skew_s,
    } = extensions;
    for (process, slot) in [
        (gyro_gauss_markov, slot::GYRO_GAUSS_MARKOV),
        (accel_gauss_markov, slot::ACCEL_GAUSS_MARKOV),
    ] {
        values.set_boolean(slot, process.is_some());
        if let Some(GaussMarkov { sigma, correlation_time_s }) = process {
            values.set_reals(slot + 1, &[*sigma, *correlation_time_s]);
        }
    }
    values.set_real(slot::RATE_RANDOM_WALK, *gyro_rate_random_walk);
    values.set_real(slot::GYRO_BIAS_INSTABILITY, *gyro_bias_instability);
    values.set_real(slot::ACCEL_BIAS_INSTABILITY, *accel_bias_instability);
    values.set_real(slot::GYRO_QUANTIZATION, *gyro_quantization_rad);
    values.set_real(slot::ACCEL_QUANTIZATION, *accel_quantization_mps);
    values.set_real(slot::GYRO_RANGE, *gyro_range_radps);
    values.set_real(slot::ACCEL_RANGE, *accel_range_mps2);
    values.set_boolean(slot::TEMPERATURE, temperature.is_some());
    if let Some(temperature) = temperature {
        let Temperature {
            ramp_kps,
            plateau_k,
            gyro_bias_per_k,
            accel_bias_per_k,
            gyro_scale_per_k,
            accel_scale_per_k,
        } = temperature;
        values.set_real(slot::TEMPERATURE_RAMP, *ramp_kps);
        values.set_real(slot::TEMPERATURE_PLATEAU, *plateau_k);
        values.set_reals(slot::TEMPERATURE_GYRO_BIAS, gyro_bias_per_k);
        values.set_reals(slot::TEMPERATURE_ACCEL_BIAS, accel_bias_per_k);
        values.set_reals(slot::TEMPERATURE_GYRO_SCALE, gyro_scale_per_k);
        values.set_reals(slot::TEMPERATURE_ACCEL_SCALE, accel_scale_per_k);
    }
    values.set_boolean(slot::VIBRATION, vibration.is_some());
    if let Some(Vibration { frequency_hz, displacement_m, angle_rad, phase_rad }) = vibration {
        values.set_real(slot::VIBRATION_FREQUENCY, *frequency_hz);
        values.set_reals(slot::VIBRATION_DISPLACEMENT, displacement_m);
        values.set_reals(slot::VIBRATION_ANGLE, angle_rad);
        values.set_real(slot::VIBRATION_PHASE, *phase_rad);
    }
    for (row, arm) in lever_arm_m.iter().enumerate() {
        values.set_reals(slot::LEVER_ARM + 3 * row, arm);
    }
    values.set_real(slot::TIME_SKEW, *time_skew_s);
}

fn extensions(values: &CellValues) -> Extensions {
    let process = |slot| {
        let [sigma, correlation_time_s] = values.reals(slot + 1);
        values.boolean(slot).then_some(GaussMarkov { sigma, correlation_time_s })
    };
    Extensions {
        gyro_gauss_markov: process(slot::GYRO_GAUSS_MARKOV),
        accel_gauss_markov: process(slot::ACCEL_GAUSS_MARKOV),
        gyro_rate_random_walk: values.real(slot::RATE_RANDOM_WALK),
        gyro_bias_instability: values.real(slot::GYRO_BIAS_INSTABILITY),
        accel_bias_instability: values.real(slot::ACCEL_BIAS_INSTABILITY),
        gyro_quantization_rad: values.real(slot::GYRO_QUANTIZATION),
        accel_quantization_mps: values.real(slot::ACCEL_QUANTIZATION),
        gyro_range_radps: values.real(slot::GYRO_RANGE),
        accel_range_mps2: values.real(slot::ACCEL_RANGE),
        temperature: values.boolean(slot::TEMPERATURE).then(|| Temperature {
            ramp_kps: values.real(slot::TEMPERATURE_RAMP),
            plateau_k: values.real(slot::TEMPERATURE_PLATEAU),
            gyro_bias_per_k: values.reals(slot::TEMPERATURE_GYRO_BIAS),
            accel_bias_per_k: values.reals(slot::TEMPERATURE_ACCEL_BIAS),
            gyro_scale_per_k: values.reals(slot::TEMPERATURE_GYRO_SCALE),
            accel_scale_per_k: values.reals(slot::TEMPERATURE_ACCEL_SCALE),
        }),
        vibration: values.boolean(slot::VIBRATION).then(|| Vibration {
            frequency_hz: values.real(slot::VIBRATION_FREQUENCY),
            displacement_m: values.reals(slot::VIBRATION_DISPLACEMENT),
            angle_rad: values.reals(slot::VIBRATION_ANGLE),
            phase_rad: values.real(slot::VIBRATION_PHASE),
        }),
        lever_arm_m: core::array::from_fn(|row| values.reals(slot::LEVER_ARM + 3 * row)),
        time_skew_s: values.real(slot::TIME_SKEW),
        ..Extensions::default()
    }
}

fn no_item(slot: usize, values: &CellValues) -> PlantValueError {
    PlantValueError::NoItem { label: MODEL.label(slot), found: values.integer(slot) }
}
