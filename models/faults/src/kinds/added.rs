//! A constant added to channels, in counts with the remainder carried.

use crate::catalogue::Dimension;
use crate::kinds::channel::{read, saturated, write_saturating};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use octant_sample::Sample;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};

/// Adds real numbers of counts to integer channels and carries the remainder.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Adder {
    /// Remainders not added yet, counts.
    remainders: [f64; 6],
}

impl Adder {
    /// Forgets the remainders.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds to a channel (0 to 2 gyros, counts of rad; 3 to 5 accelerometers, counts of m/s). A sum
    /// outside the format's range saturates, loses the excess and sets the saturation flag. NaN
    /// adds nothing and is flagged too.
    pub(crate) fn add(&mut self, sample: &mut Sample, channel: usize, counts: f64) {
        let total = self.remainders[channel] + counts;
        let whole = libm::rint(total);
        let remainder = total - whole;
        // Infinite or NaN: there is no remainder.
        if remainder.is_finite() {
            self.remainders[channel] = remainder;
        }
        // The cast saturates, so that the sum stays outside of the format.
        let sum = i64::from(read(sample, channel)).saturating_add(whole as i64);
        write_saturating(sample, channel, sum);
        if total.is_nan() {
            sample.status |= saturated(channel);
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

octant_state::state! { Added { values: adder; parts: ; kept: channels, counts } }

impl Added {
    /// Makes it from a parameter of channels and one of a rate or an acceleration, which have to
    /// fit.
    pub(crate) fn of(
        values: &Values,
        channels: &'static str,
        amplitude: &'static str,
        setup: &Setup,
    ) -> Result<Self, FaultBuildError> {
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

    /// Adds the counts of one sample, times a factor.
    pub(crate) fn add(&mut self, sample: &mut Sample, factor: f64) {
        for channel in self.channels.iter() {
            self.adder.add(sample, channel, self.counts[channel] * factor);
        }
    }
}

/// Returns a quantity whose dimension fits the channels: that of gyros or of accelerometers, not of
/// both.
pub(crate) fn fitting(
    values: &Values,
    channels: Channels,
    name: &'static str,
) -> Result<f64, FaultBuildError> {
    use Dimension::*;
    let (value, dimension) = values.quantity_and_dimension(name)?;
    let gyro = matches!(
        dimension,
        GyroBias | AngularRate | AngleRandomWalk | RateRandomWalk | Angle | SmallAngle
    );
    if gyro && !channels.gyros_only() {
        return Err(FaultBuildError::value(
            name,
            "a value for gyros, and accelerometers are among the channels",
        ));
    }
    if !gyro && !channels.accelerometers_only() {
        return Err(FaultBuildError::value(
            name,
            "a value for accelerometers, and gyros are among the channels",
        ));
    }
    Ok(value)
}
