//! Conversion of readings to samples.

use crate::{Axes, Reading};
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};

/// Settings of a unit beside its protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplerSettings {
    /// Mounting of the unit.
    pub axes: Axes,
    /// Configured sample period, ns.
    pub period_ns: u64,
}

/// Reason why a reading makes no sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unusable {
    /// The reading has no rotation.
    #[error("the reading has no rotation: configure the unit to send it")]
    NoRotation,
    /// The reading has no specific force.
    #[error("the reading has no velocity or specific force: configure the unit to send it")]
    NoVelocity,
    /// The reading is repeated or too late, or the unit was restarted.
    #[error("the reading isn't later than the one before it")]
    Behind,
}

/// Counts of the readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SamplerCounters {
    /// Samples made.
    pub samples: u64,
    /// Missing samples, from gaps in sequence or stamps.
    pub missing: u64,
    /// Readings repeated or too late.
    pub behind: u64,
    /// Readings without rotation or velocity.
    pub incomplete: u64,
    /// Readings whose interval differs from the period by more than a twentieth.
    pub irregular: u64,
}

/// Converts readings to samples.
///
/// Increments become counts whose remainders are carried: the sum of the counts follows the sum of the
/// increments within half a count. A missing reading's increments are lost: they are not interpolated,
/// and the sequence number shows the gap.
#[derive(Clone, Debug)]
pub struct Sampler {
    settings: SamplerSettings,
    rotation: [Accumulator; 3],
    velocity: [Accumulator; 3],
    /// Last reading, and the sequence number of its sample.
    last: Option<Last>,
    /// Stamp of the first reading.
    first_stamp_ns: Option<u64>,
    counters: SamplerCounters,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    number: u64,
    sequence: Option<u64>,
    stamp_ns: Option<u64>,
}

impl Sampler {
    /// Makes a sampler without readings.
    #[must_use]
    pub fn new(settings: SamplerSettings) -> Self {
        Self {
            settings,
            rotation: Default::default(),
            velocity: Default::default(),
            last: None,
            first_stamp_ns: None,
            counters: SamplerCounters::default(),
        }
    }

    /// Counts of the readings.
    #[must_use]
    pub fn counters(&self) -> &SamplerCounters {
        &self.counters
    }

    /// Makes the sample of a reading. The angles of the gimbals at the end of the interval are those of
    /// the unit, else the given ones; without either, the sample's status marks them invalid.
    ///
    /// Sequence number and time begin with the first reading: sample 1, which ends one period after the
    /// start.
    ///
    /// # Errors
    /// If the reading can't be used.
    #[inline]
    pub fn sample(
        &mut self,
        reading: &Reading,
        gimbal: Option<GimbalAngles>,
    ) -> Result<Sample, Unusable> {
        let (Some(rotation), Some(velocity)) = (reading.rotation, reading.velocity) else {
            self.counters.incomplete += 1;
            let no_rotation = reading.rotation.is_none();
            return Err(if no_rotation { Unusable::NoRotation } else { Unusable::NoVelocity });
        };
        let period_ns = self.settings.period_ns.max(1);
        let stamp_ns = reading.stamp.map(|stamp| stamp.ns);
        let Some(sequence) = self.number(reading.sequence, stamp_ns, period_ns) else {
            self.counters.behind += 1;
            return Err(Unusable::Behind);
        };
        let period_s = period_ns as f64 * 1e-9;
        let interval_s = reading.interval_s.unwrap_or(period_s);
        if !((interval_s - period_s).abs() <= 0.05 * period_s) {
            self.counters.irregular += 1;
        }
        let mut status = reading.status;
        let rotation = self.settings.axes.to_body(rotation.over(interval_s));
        let velocity = self.settings.axes.to_body(velocity.over(interval_s));
        if rotation.iter().chain(&velocity).any(|value| !value.is_finite()) {
            status |= Status::INERTIAL_INVALID;
        }
        let mut counts =
            |accumulators: &mut [Accumulator; 3], increments: [f64; 3], lsb: f64, flag| {
                core::array::from_fn(|axis| {
                    let count = accumulators[axis].count(increments[axis] / lsb);
                    if count.saturated {
                        status |= flag;
                    }
                    count.value
                })
            };
        let flag = Status::GYRO_SATURATED;
        let delta_theta = counts(&mut self.rotation, rotation, DELTA_THETA_LSB_RAD, flag);
        let flag = Status::ACCELEROMETER_SATURATED;
        let delta_velocity = counts(&mut self.velocity, velocity, DELTA_VELOCITY_LSB_MPS, flag);
        let gimbal = reading.gimbal.or(gimbal);
        if gimbal.is_none() {
            status |= Status::GIMBAL_INVALID;
        }
        if let Some(last) = self.last {
            self.counters.missing += sequence - last.number - 1;
        }
        self.last = Some(Last { number: sequence, sequence: reading.sequence, stamp_ns });
        self.counters.samples += 1;
        let ns = match (stamp_ns, self.first_stamp_ns) {
            (Some(stamp), Some(first)) => stamp.saturating_sub(first).saturating_add(period_ns),
            (Some(stamp), None) if sequence == 1 => {
                self.first_stamp_ns = Some(stamp);
                period_ns
            }
            _ => sequence.saturating_mul(period_ns),
        };
        Ok(Sample {
            sequence,
            device_time: DeviceTime { ns },
            delta_theta,
            delta_velocity,
            gimbal: gimbal.unwrap_or_default(),
            status,
        })
    }

    /// Number of the sample of a reading; `None` if it isn't after the last one.
    fn number(&self, sequence: Option<u64>, stamp_ns: Option<u64>, period_ns: u64) -> Option<u64> {
        let Some(last) = self.last else { return Some(1) };
        let steps = match (sequence, last.sequence, stamp_ns, last.stamp_ns) {
            (Some(now), Some(before), ..) => now.checked_sub(before)?,
            (.., Some(now), Some(before)) => {
                let passed = now.checked_sub(before)?;
                if passed == 0 {
                    return None;
                }
                // Rounds to the nearest number of periods; a reading that came early still counts as
                // one step.
                ((passed + period_ns / 2) / period_ns).max(1)
            }
            _ => 1,
        };
        (steps > 0).then(|| last.number.saturating_add(steps))
    }
}
