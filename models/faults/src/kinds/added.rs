//! A constant that is added to channels, in counts with the remainder carried.

use crate::catalogue::Dimension;
use crate::setup::{BuildError, Setup};
use crate::values::{Channels, Values};
use octant_sample::Sample;
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::imu::Status;

/// Adds real numbers of counts to integer channels: a fault that changes a value carries its
/// remainder too.
#[derive(Clone, Debug, Default)]
pub(crate) struct Adder {
    accumulators: [Accumulator; 6],
}

impl Adder {
    /// Forgets the remainders.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds to a channel (0 to 2 gyros, counts of rad; 3 to 5 accelerometers, counts of m/s).
    /// Saturates at the format's range and sets the flag that says so.
    pub(crate) fn add(&mut self, sample: &mut Sample, channel: usize, counts: f64) {
        let whole = self.accumulators[channel].count(counts);
        let (value, flag) = if channel < 3 {
            (&mut sample.delta_theta[channel], Status::GYRO_SATURATED)
        } else {
            (&mut sample.delta_velocity[channel - 3], Status::ACCELEROMETER_SATURATED)
        };
        let sum = i64::from(*value) + i64::from(whole.value);
        *value = sum.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
        if whole.saturated || i64::from(*value) != sum {
            sample.status |= flag;
        }
    }
}

/// Counts per SI unit of the integral on a channel.
pub(crate) fn counts_per_si(channel: usize) -> f64 {
    if channel < 3 { 1.0 / DELTA_THETA_LSB_RAD } else { 1.0 / DELTA_VELOCITY_LSB_MPS }
}

/// A constant rate or acceleration on channels.
#[derive(Clone, Debug)]
pub(crate) struct Added {
    channels: Channels,
    /// Counts per sample.
    counts: [f64; 6],
    adder: Adder,
}

impl Added {
    /// From a parameter of channels and one of a rate or an acceleration, which have to fit.
    pub(crate) fn of(
        values: &Values,
        channels: &'static str,
        amplitude: &'static str,
        setup: &Setup,
    ) -> Result<Self, BuildError> {
        let channels = values.channels(channels)?;
        let value = fitting(values, channels, amplitude)?;
        let mut counts = [0.0; 6];
        for channel in channels.iter() {
            counts[channel] = value * setup.dt_s() * counts_per_si(channel);
        }
        Ok(Self { channels, counts, adder: Adder::default() })
    }

    /// Forgets the remainders.
    pub(crate) fn clear(&mut self) {
        self.adder.clear();
    }

    /// Adds one sample's worth, times a factor.
    pub(crate) fn add(&mut self, sample: &mut Sample, factor: f64) {
        for channel in self.channels.iter() {
            self.adder.add(sample, channel, self.counts[channel] * factor);
        }
    }
}

/// A quantity whose dimension fits the channels: that of gyros or of accelerometers, not of both.
pub(crate) fn fitting(
    values: &Values,
    channels: Channels,
    name: &'static str,
) -> Result<f64, BuildError> {
    use Dimension::*;
    let (value, dimension) = values.quantity_and_dimension(name)?;
    let gyro = matches!(
        dimension,
        GyroBias | AngularRate | AngleRandomWalk | RateRandomWalk | Angle | SmallAngle
    );
    if gyro && !channels.gyros_only() {
        return Err(BuildError::value(
            name,
            "a value for gyros, and accelerometers are among the channels",
        ));
    }
    if !gyro && !channels.accelerometers_only() {
        return Err(BuildError::value(
            name,
            "a value for accelerometers, and gyros are among the channels",
        ));
    }
    Ok(value)
}
