//! A reading of an inertial unit, in SI units.

use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{GimbalAngles, Sample, Status};

/// Kind of a measured value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadingKind {
    /// Integral over the interval of the reading: rad, m/s.
    Increment,
    /// Mean over the interval, or a value at its end: rad/s, m/s². Multiplied by the interval it is an
    /// increment, without the contributions of coning and sculling inside the interval.
    Mean,
}

/// Measured values of three axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredTriad {
    /// Increments or means.
    pub kind: ReadingKind,
    /// Values of x, y, z.
    pub value: [f64; 3],
    /// Size of one count, if the protocol sends integers: `value` is a count times this.
    pub lsb: Option<f64>,
}

impl MeasuredTriad {
    /// Increments sent as floating-point numbers.
    #[must_use]
    pub const fn increment(value: [f64; 3]) -> Self {
        Self { kind: ReadingKind::Increment, value, lsb: None }
    }

    /// Means sent as floating-point numbers.
    #[must_use]
    pub const fn mean(value: [f64; 3]) -> Self {
        Self { kind: ReadingKind::Mean, value, lsb: None }
    }

    /// Integers with counts of size `lsb`.
    #[must_use]
    pub fn counts(kind: ReadingKind, counts: [i32; 3], lsb: f64) -> Self {
        Self { kind, value: counts.map(|count| f64::from(count) * lsb), lsb: Some(lsb) }
    }

    /// Increments over an interval.
    #[must_use]
    #[inline]
    pub fn over(&self, interval_s: f64) -> [f64; 3] {
        match self.kind {
            ReadingKind::Increment => self.value,
            ReadingKind::Mean => self.value.map(|mean| mean * interval_s),
        }
    }
}

/// Clock of a stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StampClock {
    /// Clock of the unit, since it was switched on.
    Startup,
    /// GPS time since 6 January 1980.
    Gps,
}

/// End of a reading's interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Time of the clock, ns. A counter that rolls over is continued.
    pub ns: u64,
    /// Clock of the time.
    pub clock: StampClock,
}

/// One reading. Values that its protocol doesn't send are `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Rotation of the unit against inertial space.
    pub rotation: Option<MeasuredTriad>,
    /// Specific force, or its integral.
    pub velocity: Option<MeasuredTriad>,
    /// Length of the interval as reported by the unit, s.
    pub interval_s: Option<f64>,
    /// End of the interval.
    pub stamp: Option<Stamp>,
    /// Number of the reading. A counter that rolls over is continued.
    pub sequence: Option<u64>,
    /// Angles of the gimbals, if the unit has them.
    pub gimbal: Option<GimbalAngles>,
    /// Status reported by the unit, as far as Octant has a flag for it.
    pub status: Status,
    /// Status word of the protocol.
    pub status_word: Option<u32>,
    /// Temperature of the unit, °C.
    pub temperature_c: Option<f32>,
}

impl Reading {
    /// A reading without any value.
    pub const NOTHING: Self = Self {
        rotation: None,
        velocity: None,
        interval_s: None,
        stamp: None,
        sequence: None,
        gimbal: None,
        status: Status::empty(),
        status_word: None,
        temperature_c: None,
    };

    /// Converts a sample to the reading of a unit with Octant's resolution.
    #[must_use]
    pub fn of_sample(sample: &Sample) -> Self {
        let counts = |counts, lsb| Some(MeasuredTriad::counts(ReadingKind::Increment, counts, lsb));
        Self {
            rotation: counts(sample.delta_theta, DELTA_THETA_LSB_RAD),
            velocity: counts(sample.delta_velocity, DELTA_VELOCITY_LSB_MPS),
            interval_s: None,
            stamp: Some(Stamp { ns: sample.device_time.ns, clock: StampClock::Startup }),
            sequence: Some(sample.sequence),
            gimbal: Some(sample.gimbal),
            status: sample.status,
            status_word: Some(u32::from(sample.status.bits())),
            temperature_c: None,
        }
    }

    /// True if it has rotation or specific force.
    #[must_use]
    pub fn is_inertial(&self) -> bool {
        self.rotation.is_some() || self.velocity.is_some()
    }
}
