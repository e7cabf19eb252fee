//! The sensors, the gimbals and the motion of the case.

use crate::error::Problem;
use crate::keys::{ExtensionsKeys, ImuKeys, MotionKeys, MotionKind, TurntableKeys};
use crate::model::{
    DocksideSpec, MotionComponent, MotionSpan, MotionSpec, ParameterDistribution, ShipSpectrum,
};
use octant_earth::units::DEG;
use octant_plant::config as plant;

/// Sample period of a rate, to the nanosecond: of 60 Hz, 0.02 ppm from it.
pub(super) fn sample_period_ns(rate_hz: f64) -> u64 {
    (1e9 / rate_hz).round() as u64
}

pub(super) fn parameters(imu: &ImuKeys) -> [ParameterDistribution; 7] {
    [
        imu.gyro_bias.distribution(),
        imu.gyro_scale.distribution(),
        imu.gyro_misalignment.distribution(),
        imu.g_dependent.distribution(),
        imu.accel_bias.distribution(),
        imu.accel_scale.distribution(),
        imu.accel_misalignment.distribution(),
    ]
}

pub(super) fn imu(imu: &ImuKeys) -> Result<plant::Imu, Problem> {
    let more = &imu.extensions;
    let gauss_markov = |sigma, correlation_time_s| plant::GaussMarkov { sigma, correlation_time_s };
    let gyro = more.gyro_gauss_markov.as_ref();
    let accel = more.accel_gauss_markov.as_ref();
    Ok(plant::Imu {
        parameters: octant_sample::Parameters::default(),
        angle_random_walk: imu.angle_random_walk,
        velocity_random_walk: imu.velocity_random_walk,
        extensions: plant::Extensions {
            gyro_gauss_markov: gyro.map(|keys| gauss_markov(keys.sigma, keys.correlation_time)),
            accel_gauss_markov: accel.map(|keys| gauss_markov(keys.sigma, keys.correlation_time)),
            gyro_rate_random_walk: more.gyro_rate_random_walk,
            gyro_bias_instability: more.gyro_bias_instability,
            accel_bias_instability: more.accel_bias_instability,
            gyro_quantization_rad: more.gyro_quantization,
            accel_quantization_mps: more.accel_quantization,
            gyro_range_radps: more.gyro_range,
            accel_range_mps2: more.accel_range,
            temperature: temperature(more)?,
            vibration: more.vibration.as_ref().map(|keys| plant::Vibration {
                frequency_hz: keys.frequency,
                displacement_m: keys.displacement,
                angle_rad: keys.angle,
                phase_rad: keys.phase,
            }),
            lever_arm_m: [more.lever_arm.x, more.lever_arm.y, more.lever_arm.z],
            time_skew_s: more.time_skew,
            gyro_asymmetry: more.gyro_asymmetry,
            accel_asymmetry: more.accel_asymmetry,
            accel_quadratic: more.accel_quadratic,
        },
    })
}

fn temperature(more: &ExtensionsKeys) -> Result<Option<plant::Temperature>, Problem> {
    let Some(keys) = &more.temperature else { return Ok(None) };
    let (ramp_kps, plateau_k) = (*keys.ramp, *keys.plateau);
    if ramp_kps * plateau_k < 0.0 || (ramp_kps == 0.0) != (plateau_k == 0.0) {
        return Err(keys.plateau.problem(format!(
            "found {:?} with a ramp of {:?}, which never gets there",
            keys.plateau.text, keys.ramp.text
        )));
    }
    Ok(Some(plant::Temperature {
        ramp_kps,
        plateau_k,
        gyro_bias_per_k: keys.gyro_bias,
        accel_bias_per_k: keys.accel_bias,
        gyro_scale_per_k: keys.gyro_scale,
        accel_scale_per_k: keys.accel_scale,
    }))
}

pub(super) fn turntable(keys: &TurntableKeys) -> plant::TurntableConfig {
    plant::TurntableConfig {
        rate_radps: keys.rate,
        acceleration_radps2: keys.acceleration,
        encoder_sigma_rad: keys.encoder_error,
        non_orthogonality_rad: keys.non_orthogonality,
        backlash_rad: keys.backlash,
        errors: plant::GimbalErrors {
            mounting_rad: keys.mounting,
            encoder_zero_rad: keys.encoder_zero,
            eccentricity_rad: [keys.eccentricity_azimuth, keys.eccentricity_roll],
            encoder_noise_rad: keys.encoder_noise,
        },
    }
}

pub(super) fn motion(keys: &MotionKeys) -> MotionSpec {
    let mean = plant::CaseAttitude {
        heading_rad: keys.heading,
        pitch_rad: keys.pitch,
        roll_rad: keys.roll,
    };
    let ship = match (keys.kind, &keys.ship) {
        (MotionKind::Dockside, Some(ship)) => ship,
        (MotionKind::Static, _) | (MotionKind::Dockside, None) => return MotionSpec::Static(mean),
    };
    let mut components = [
        given(&ship.roll),
        given(&ship.pitch),
        given(&ship.yaw),
        given(&ship.surge),
        given(&ship.sway),
        given(&ship.heave),
    ];
    if let Some(preset) = ship.preset {
        let moves = preset.into_iter().enumerate().filter(|(_, (amplitude, _))| *amplitude > 0.0);
        for (index, (amplitude, period_s)) in moves {
            let amplitude = amplitude * if index < 3 { DEG } else { 1.0 };
            components[index].get_or_insert_with(|| {
                vec![MotionComponent { amplitude, period_s, phase_rad: None }]
            });
        }
    }
    let spectrum = ship.spectrum.as_ref().map(|keys| ShipSpectrum {
        peak_period_s: keys.peak_period,
        sigma: [keys.roll, keys.pitch, keys.yaw, keys.surge, keys.sway, keys.heave],
        components: keys.components as usize,
    });
    MotionSpec::Dockside(DocksideSpec {
        mean,
        components: components.map(Option::unwrap_or_default),
        spectrum,
        mooring_offset_m: ship.mooring_offset,
        span: (ship.from.is_some() || ship.duration.is_some()).then(|| MotionSpan {
            from_s: ship.from.unwrap_or_default(),
            duration_s: ship.duration,
            ramp_s: ship.ramp,
        }),
    })
}

fn given<'a, K>(components: &'a Option<Vec<K>>) -> Option<Vec<MotionComponent>>
where
    MotionComponent: From<&'a K>,
{
    components.as_ref().map(|all| all.iter().map(MotionComponent::from).collect())
}
