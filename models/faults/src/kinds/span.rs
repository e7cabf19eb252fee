//! Conversion of a time to a number of samples.

use crate::catalogue::Dimension;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use core::ops::RangeInclusive;

/// Reads a parameter that is a time or a number of samples, to the nearest whole sample.
pub(crate) fn samples(
    values: &Values,
    name: &'static str,
    within: RangeInclusive<u64>,
    setup: &Setup,
) -> Result<u64, FaultBuildError> {
    let (value, dimension) = values.quantity_and_dimension(name)?;
    let samples = match dimension {
        Dimension::Samples => value,
        _ => value / setup.dt_s(),
    };
    // The cast saturates, and takes NaN to zero.
    let whole = libm::round(samples) as u64;
    if within.contains(&whole) {
        return Ok(whole);
    }
    let problem = alloc::format!(
        "{whole} samples of {} s, {} to {} are expected",
        setup.dt_s(),
        within.start(),
        within.end()
    );
    Err(FaultBuildError::value(name, problem))
}
