//! Error of an input's clock against what was published of its increments.

use octant_account::{Account, OutsideClock};
use octant_base::number::plain;
use octant_score::summary::CalibrationScore;

/// Accelerometer bias of a clock that is off by 1 ppm, at rest, ug: a millionth of gravity.
const BIAS_UG_PER_PPM: f64 = 1.0;
/// Gyro bias of such a clock, deg/h: a millionth of the Earth's rotation.
const BIAS_DPH_PER_PPM: f64 = 15.041e-6;
/// Share of a parameter's standard deviation that an error of the clock may move it by.
const SHARE: f64 = 0.3;

/// Says that the error of a clock moves a published bias; `None` where it doesn't, where it can't be told from zero, or
/// where no clock outside shows it.
pub(super) fn clock_doubt(input: &Account, calibration: &CalibrationScore) -> Option<String> {
    let clock = input.clocked().filter(|clock| clock.increments)?;
    let OutsideClock { name, fast_ppm, sigma_ppm } = clock.outside.as_ref()?;
    if fast_ppm.abs() <= 2.0 * sigma_ppm.unwrap_or(0.0) {
        return None;
    }
    let smallest = |group: &str| {
        let named = calibration.parameters.iter().filter(|(key, _)| key.starts_with(group));
        named.filter_map(|(_, score)| score.sigma).min_by(f64::total_cmp)
    };
    let moved = [("accel_bias", BIAS_UG_PER_PPM, "ug"), ("gyro_bias", BIAS_DPH_PER_PPM, "deg/h")];
    moved.into_iter().find_map(|(group, per_ppm, unit)| {
        let (bias, sigma) = (fast_ppm.abs() * per_ppm, smallest(group)?);
        (bias > SHARE * sigma).then(|| {
            format!(
                "{}: its clock is {} ppm {} against {name}: that is up to {} {unit} of {group}, published with a standard \
                 deviation of {} {unit}",
                input.name(),
                plain(fast_ppm.abs(), 4),
                if *fast_ppm > 0.0 { "fast" } else { "slow" },
                plain(bias, 3),
                plain(sigma, 3)
            )
        })
    })
}
