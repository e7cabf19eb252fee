//! Conversion of readings to samples.

use crate::timeline::{Ahead, Misplaced, Placed, Timeline};
use crate::{Axes, Reading, ReadingKind};
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};

/// Settings of a unit beside its protocol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplerSettings {
    /// Mounting of the unit.
    pub axes: Axes,
    /// Configured rate of the samples, Hz.
    pub rate_hz: f64,
}

/// Reason why a reading makes no sample.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// The reading has no rotation.
    #[error("the reading has no rotation: configure the unit to send it")]
    NoRotation,
    /// The reading has no specific force.
    #[error("the reading has no velocity or specific force: configure the unit to send it")]
    NoVelocity,
    /// The reading is repeated or too late.
    #[error("the reading isn't later than the one before it")]
    Behind,
    /// The unit was restarted, or its clock was set back: its readings go on from there.
    #[error(
        "the unit was restarted, or its clock set: readings go on at {to_s:.3} s after {from_s:.3} s, expected one clock and one \
         counter without a restart"
    )]
    Restarted {
        /// Stamp, or counted time, before, s.
        from_s: f64,
        /// Stamp, or counted time, of the reading, s.
        to_s: f64,
    },
    /// The clock jumps ahead by more than a day.
    #[error(
        "the unit's clock jumps ahead by more than a day, from {from_s:.3} s to {to_s:.3} s: it was set"
    )]
    Jumped {
        /// Stamp before, s.
        from_s: f64,
        /// Stamp of the reading, s.
        to_s: f64,
    },
    /// The rate is another one than before, or than configured.
    #[error("readings come at {found_hz} Hz by their stamps, expected {expected_hz} Hz{changed}")]
    Rate {
        /// Rate by the stamps, Hz.
        found_hz: f64,
        /// Expected rate, Hz.
        expected_hz: f64,
        /// Words that say since when.
        changed: &'static str,
    },
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
    /// Samples with a status by which the core doesn't believe them: invalid, or an axis out of range.
    pub flagged: u64,
    /// Flagged samples whose stamps are off the fitted time.
    pub flagged_shifted: u64,
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
    timeline: Timeline,
    /// Time of the first reading, ns.
    first_ns: Option<u64>,
    /// True once a reading was an increment, and once one had a counter.
    increments: bool,
    counted: bool,
    /// Readings behind the last sample, one after the other, of a clock that goes on.
    behind: Option<Behind>,
    counters: SamplerCounters,
}

/// Readings that come behind the last sample.
#[derive(Clone, Copy, Debug)]
struct Behind {
    place: u64,
    count: u32,
}

/// Status by which the core doesn't believe a sample.
const DISBELIEVED: Status =
    Status::INERTIAL_INVALID.union(Status::GYRO_SATURATED).union(Status::ACCELEROMETER_SATURATED);

/// Number of readings behind the last sample that make a restart: single ones come late.
const RESTART: u32 = 3;

impl Sampler {
    /// Makes a sampler without readings.
    #[must_use]
    pub fn new(settings: SamplerSettings) -> Self {
        Self {
            settings,
            rotation: Default::default(),
            velocity: Default::default(),
            timeline: Timeline::new(settings.rate_hz),
            first_ns: None,
            increments: false,
            counted: false,
            behind: None,
            counters: SamplerCounters::default(),
        }
    }

    /// Timeline of the readings.
    #[must_use]
    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// Configured rate, Hz.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.settings.rate_hz
    }

    /// Returns whether readings were increments: an error of the unit's clock is one of their rates.
    #[must_use]
    pub fn has_increments(&self) -> bool {
        self.increments
    }

    /// Returns whether readings had counters.
    #[must_use]
    pub fn has_counters(&self) -> bool {
        self.counted
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
        let stamp_ns = reading.stamp.map(|stamp| stamp.ns);
        let shifted_before = self.timeline.tally().shifted;
        let placed = match self.timeline.place(stamp_ns, reading.sequence, || Ahead::NONE) {
            Ok(placed) => placed,
            Err(misplaced) => return Err(self.misplaced(misplaced, reading.sequence.or(stamp_ns))),
        };
        self.behind = None;
        let Placed { number, missing, time_ns, interval_ns } = placed;
        let sequence = number.saturating_add(1);
        let period_s = 1.0 / self.settings.rate_hz;
        let interval_s = reading.interval_s.unwrap_or(interval_ns as f64 * 1e-9);
        if !((interval_s - period_s).abs() <= 0.05 * period_s) {
            self.counters.irregular += 1;
        }
        self.increments |= rotation.kind == ReadingKind::Increment;
        self.counted |= reading.sequence.is_some();
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
        self.counters.missing += missing;
        self.counters.samples += 1;
        if status.intersects(DISBELIEVED) {
            self.counters.flagged += 1;
            self.counters.flagged_shifted += self.timeline.tally().shifted - shifted_before;
        }
        // Time begins with the interval of the first reading.
        let first_ns = *self.first_ns.get_or_insert(time_ns.wrapping_sub(interval_ns));
        let ns = time_ns.wrapping_sub(first_ns);
        Ok(Sample {
            sequence,
            device_time: DeviceTime { ns },
            delta_theta,
            delta_velocity,
            gimbal: gimbal.unwrap_or_default(),
            status,
        })
    }

    /// Counts a reading that has no place in the timeline. `place` is its counter, else its stamp.
    #[cold]
    fn misplaced(&mut self, misplaced: Misplaced, place: Option<u64>) -> Unusable {
        match misplaced {
            Misplaced::Repeated => {
                self.counters.behind += 1;
                Unusable::Behind
            }
            Misplaced::Back { from_s, to_s } => {
                self.counters.behind += 1;
                let place = place.unwrap_or_default();
                let goes_on = self.behind.filter(|behind| place > behind.place);
                let count = goes_on.map_or(1, |behind| behind.count + 1);
                self.behind = Some(Behind { place, count });
                if count < RESTART {
                    Unusable::Behind
                } else {
                    Unusable::Restarted { from_s, to_s }
                }
            }
            Misplaced::Ahead { from_s, to_s } => Unusable::Jumped { from_s, to_s },
            Misplaced::Rate { found_hz, expected_hz, changed } => Unusable::Rate {
                found_hz,
                expected_hz,
                changed: if changed { ", as before" } else { "" },
            },
        }
    }
}
