//! Truth of the errors that a filter can take into account beside the thirty parameters.

use crate::config::{Extensions, GravityDisturbance};
use octant_sample::further::{FURTHER_COUNT, FurtherGroup};

/// True values, SI, in the order of [`octant_sample::further::FURTHER_NAMES`]; `None` for a process that changes over
/// time.
#[must_use]
pub fn truth(
    extensions: &Extensions,
    gravity: &GravityDisturbance,
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
    let deflection = [gravity.deflection_north_rad, gravity.deflection_east_rad];
    put(FurtherGroup::Deflection, &deflection);
    put(FurtherGroup::GravityAnomaly, &[gravity.anomaly_mps2]);
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

/// Adds errors, in the order of [`octant_sample::further::FURTHER_NAMES`], to those that an instrument and its site have.
/// Gauss-Markov biases are processes, to which no constant is added.
pub fn add(
    errors: &[f64; FURTHER_COUNT],
    extensions: &mut Extensions,
    gravity: &mut GravityDisturbance,
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
    let mut deflection = [gravity.deflection_north_rad, gravity.deflection_east_rad];
    to(FurtherGroup::Deflection, &mut deflection);
    [gravity.deflection_north_rad, gravity.deflection_east_rad] = deflection;
    to(FurtherGroup::GravityAnomaly, core::slice::from_mut(&mut gravity.anomaly_mps2));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is added is the truth afterwards, group by group; processes stay what they are.
    #[test]
    fn the_truth_is_what_was_added() {
        let (mut extensions, mut gravity) = (Extensions::default(), Default::default());
        let errors: [f64; FURTHER_COUNT] = core::array::from_fn(|k| k as f64 + 1.0);
        add(&errors, &mut extensions, &mut gravity);
        add(&errors, &mut extensions, &mut gravity);
        for (index, truth) in truth(&extensions, &gravity).into_iter().enumerate() {
            let is_process = FurtherGroup::of(index).is_some_and(|group| {
                matches!(group, FurtherGroup::GyroGaussMarkov | FurtherGroup::AccelGaussMarkov)
            });
            assert_eq!(truth, Some(if is_process { 0.0 } else { 2.0 * errors[index] }), "{index}");
        }
    }
}
