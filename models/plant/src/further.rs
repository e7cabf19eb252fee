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
