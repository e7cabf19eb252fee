//! Truth of the errors that a filter can take into account beside the thirty parameters.

use crate::config::{Extensions, GravityDisturbance, TurntableConfig};
use octant_sample::further::{FURTHER_COUNT, FurtherGroup};

/// True values, SI, in the order of [`octant_sample::further::FURTHER_NAMES`]; `None` for a process that changes over
/// time, and for the eccentricity of encoders whose drawn curve has a part in it.
///
/// The zero error of the azimuth encoder can't be told from a mounting about z: it counts there.
#[must_use]
pub fn truth(
    extensions: &Extensions,
    gravity: &GravityDisturbance,
    turntable: &TurntableConfig,
) -> [Option<f64>; FURTHER_COUNT] {
    let mut all = [Some(0.0); FURTHER_COUNT];
    let mut put = |group: FurtherGroup, values: &[f64]| {
        for (to, value) in all[group.range()].iter_mut().zip(values) {
            *to = Some(*value);
        }
    };
    put(FurtherGroup::AccelLever, extensions.lever_arm_m.as_flattened());
    put(FurtherGroup::GyroAsymmetry, &extensions.gyro_asymmetry);
    put(FurtherGroup::AccelAsymmetry, &extensions.accel_asymmetry);
    put(FurtherGroup::AccelQuadratic, &extensions.accel_quadratic);
    if let Some(temperature) = &extensions.temperature {
        put(FurtherGroup::GyroBiasTemperature, &temperature.gyro_bias_per_k);
        put(FurtherGroup::GyroScaleTemperature, &temperature.gyro_scale_per_k);
        put(FurtherGroup::AccelBiasTemperature, &temperature.accel_bias_per_k);
        put(FurtherGroup::AccelScaleTemperature, &temperature.accel_scale_per_k);
    }
    let deflection = [gravity.deflection_north_rad, gravity.deflection_east_rad];
    put(FurtherGroup::Deflection, &deflection);
    put(FurtherGroup::GravityAnomaly, &[gravity.anomaly_mps2]);
    let gimbals = &turntable.errors;
    let [x, y, z] = gimbals.mounting_rad;
    put(FurtherGroup::GimbalMounting, &[x, y, z - gimbals.encoder_zero_rad[0]]);
    put(FurtherGroup::GimbalNonOrthogonality, &[turntable.non_orthogonality_rad]);
    put(FurtherGroup::EncoderEccentricity, gimbals.eccentricity_rad.as_flattened());
    if turntable.encoder_sigma_rad > 0.0 {
        all[FurtherGroup::EncoderEccentricity.range()].fill(None);
    }
    for (group, is_there) in [
        (FurtherGroup::GyroGaussMarkov, extensions.gyro_gauss_markov.is_some()),
        (FurtherGroup::AccelGaussMarkov, extensions.accel_gauss_markov.is_some()),
    ] {
        if is_there {
            all[group.range()].fill(None);
        }
    }
    all
}

/// Adds errors, in the order of [`octant_sample::further::FURTHER_NAMES`], to those that an instrument, its
/// site and its turntable have.
/// Gauss-Markov biases are processes, to which no constant is added; coefficients of a temperature are added where there
/// is one.
pub fn add(
    errors: &[f64; FURTHER_COUNT],
    extensions: &mut Extensions,
    gravity: &mut GravityDisturbance,
    turntable: &mut TurntableConfig,
) {
    let to = |group: FurtherGroup, values: &mut [f64]| {
        for (value, error) in values.iter_mut().zip(&errors[group.range()]) {
            *value += error;
        }
    };
    to(FurtherGroup::AccelLever, extensions.lever_arm_m.as_flattened_mut());
    to(FurtherGroup::GyroAsymmetry, &mut extensions.gyro_asymmetry);
    to(FurtherGroup::AccelAsymmetry, &mut extensions.accel_asymmetry);
    to(FurtherGroup::AccelQuadratic, &mut extensions.accel_quadratic);
    if let Some(temperature) = &mut extensions.temperature {
        to(FurtherGroup::GyroBiasTemperature, &mut temperature.gyro_bias_per_k);
        to(FurtherGroup::GyroScaleTemperature, &mut temperature.gyro_scale_per_k);
        to(FurtherGroup::AccelBiasTemperature, &mut temperature.accel_bias_per_k);
        to(FurtherGroup::AccelScaleTemperature, &mut temperature.accel_scale_per_k);
    }
    let mut deflection = [gravity.deflection_north_rad, gravity.deflection_east_rad];
    to(FurtherGroup::Deflection, &mut deflection);
    [gravity.deflection_north_rad, gravity.deflection_east_rad] = deflection;
    to(FurtherGroup::GravityAnomaly, core::slice::from_mut(&mut gravity.anomaly_mps2));
    to(FurtherGroup::GimbalMounting, &mut turntable.errors.mounting_rad);
    let leant = &mut turntable.non_orthogonality_rad;
    to(FurtherGroup::GimbalNonOrthogonality, core::slice::from_mut(leant));
    let eccentricity = turntable.errors.eccentricity_rad.as_flattened_mut();
    to(FurtherGroup::EncoderEccentricity, eccentricity);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is added is the truth afterwards, group by group; processes stay what they are.
    #[test]
    fn the_truth_is_what_was_added() {
        let temperature = crate::config::Temperature {
            ramp_kps: 0.001,
            plateau_k: 5.0,
            gyro_bias_per_k: [0.0; 3],
            accel_bias_per_k: [0.0; 3],
            gyro_scale_per_k: [0.0; 3],
            accel_scale_per_k: [0.0; 3],
        };
        let mut extensions = Extensions { temperature: Some(temperature), ..Extensions::default() };
        let mut gravity = Default::default();
        let mut turntable = TurntableConfig {
            rate_radps: 0.1,
            acceleration_radps2: 0.1,
            encoder_sigma_rad: 0.0,
            non_orthogonality_rad: 0.0,
            backlash_rad: 0.0,
            errors: Default::default(),
        };
        let errors: [f64; FURTHER_COUNT] = core::array::from_fn(|k| k as f64 + 1.0);
        add(&errors, &mut extensions, &mut gravity, &mut turntable);
        add(&errors, &mut extensions, &mut gravity, &mut turntable);
        let found = truth(&extensions, &gravity, &turntable);
        for (index, truth) in found.into_iter().enumerate() {
            let is_process = FurtherGroup::of(index).is_some_and(|group| {
                matches!(group, FurtherGroup::GyroGaussMarkov | FurtherGroup::AccelGaussMarkov)
            });
            assert_eq!(truth, Some(if is_process { 0.0 } else { 2.0 * errors[index] }), "{index}");
        }
        // A zero of the azimuth encoder is a mounting, and a drawn curve has an eccentricity of its own.
        turntable.errors.encoder_zero_rad = [1.0, 2.0];
        turntable.encoder_sigma_rad = 1e-5;
        let other = truth(&extensions, &gravity, &turntable);
        for index in 0..FURTHER_COUNT {
            let expected = match index {
                41 => found[index].map(|z| z - 1.0),
                43.. => None,
                _ => found[index],
            };
            assert_eq!(other[index], expected, "{index}");
        }
    }
}
