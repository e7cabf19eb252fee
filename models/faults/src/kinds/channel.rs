//! Single channels of a sample: 0 to 2 gyros, 3 to 5 accelerometers.

use crate::setup::FaultBuildError;
use crate::values::{Channels, Values};
use octant_sample::Sample;
use octant_sample::imu::Status;

/// Reads the count of a channel.
pub(crate) fn read(sample: &Sample, channel: usize) -> i32 {
    if channel < 3 { sample.delta_theta[channel] } else { sample.delta_velocity[channel - 3] }
}

/// Replaces the count of a channel.
pub(crate) fn write(sample: &mut Sample, channel: usize, count: i32) {
    if channel < 3 {
        sample.delta_theta[channel] = count;
    } else {
        sample.delta_velocity[channel - 3] = count;
    }
}

/// Replaces the count of a channel; a count beyond the format saturates and is flagged.
pub(crate) fn write_saturating(sample: &mut Sample, channel: usize, count: i64) {
    let clamped = count.clamp(i64::from(i32::MIN), i64::from(i32::MAX));
    write(sample, channel, clamped as i32);
    if clamped != count {
        sample.status |= saturated(channel);
    }
}

/// All six counts.
pub(crate) fn counts(sample: &Sample) -> [i32; 6] {
    core::array::from_fn(|channel| read(sample, channel))
}

/// Flag of saturation of a channel.
pub(crate) fn saturated(channel: usize) -> Status {
    if channel < 3 { Status::GYRO_SATURATED } else { Status::ACCELEROMETER_SATURATED }
}

/// Reads channels that have to be gyros.
pub(crate) fn gyros(values: &Values, name: &'static str) -> Result<Channels, FaultBuildError> {
    let channels = values.channels(name)?;
    if channels.gyros_only() {
        Ok(channels)
    } else {
        Err(FaultBuildError::value(
            name,
            "accelerometers are among the channels, gyros are expected",
        ))
    }
}

/// Reads a parameter that has to be one channel.
pub(crate) fn single(values: &Values, name: &'static str) -> Result<usize, FaultBuildError> {
    let channels = values.channels(name)?;
    let mut all = channels.iter();
    match (all.next(), all.next()) {
        (Some(channel), None) => Ok(channel),
        _ => Err(FaultBuildError::value(
            name,
            alloc::format!("{} channels were found, one is expected", channels.iter().count()),
        )),
    }
}

/// Reads two different channels of the same triad.
pub(crate) fn pair(
    values: &Values,
    first: &'static str,
    second: &'static str,
) -> Result<[usize; 2], FaultBuildError> {
    let pair = [single(values, first)?, single(values, second)?];
    let problem = if pair[0] == pair[1] {
        "the same channel was found twice, two different ones are expected"
    } else if pair[0] / 3 != pair[1] / 3 {
        "a gyro and an accelerometer were found, two channels of one triad are expected"
    } else {
        return Ok(pair);
    };
    Err(FaultBuildError::value(second, problem))
}
