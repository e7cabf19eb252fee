//! What an inertial unit said, in SI units.

use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{GimbalAngles, Sample, Status};

/// Whether a value is an integral or a mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Integral over the interval of the reading: rad, m/s.
    Increment,
    /// Mean over the interval, or a value at its end: rad/s, m/s². Times the interval it is an
    /// increment, without what coning and sculling inside the interval add.
    Mean,
}

/// Three axes as they were measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Increments or means.
    pub kind: Kind,
    /// x, y, z.
    pub value: [f64; 3],
    /// What one count is worth, where the protocol sends integers: `value` is a count times this.
    pub lsb: Option<f64>,
}

impl Measured {
    /// Increments that came as numbers.
    #[must_use]
    pub const fn increment(value: [f64; 3]) -> Self {
        Self { kind: Kind::Increment, value, lsb: None }
    }

    /// Means that came as numbers.
    #[must_use]
    pub const fn mean(value: [f64; 3]) -> Self {
        Self { kind: Kind::Mean, value, lsb: None }
    }

    /// Integers of which one is worth `lsb`.
    #[must_use]
    pub fn counts(kind: Kind, counts: [i32; 3], lsb: f64) -> Self {
        Self { kind, value: counts.map(|count| f64::from(count) * lsb), lsb: Some(lsb) }
    }

    /// The increments over an interval.
    #[must_use]
    #[inline]
    pub fn over(&self, interval_s: f64) -> [f64; 3] {
        match self.kind {
            Kind::Increment => self.value,
            Kind::Mean => self.value.map(|mean| mean * interval_s),
        }
    }
}

/// Whose time a stamp is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The unit's own, since it was switched on.
    Startup,
    /// GPS time since 6 January 1980.
    Gps,
}

/// When the interval of a reading ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Nanoseconds of the clock. A counter that rolls over is continued.
    pub ns: u64,
    /// Whose time it is.
    pub clock: Clock,
}

/// One reading. What its protocol doesn't say is `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Rotation of the unit against inertial space.
    pub rotation: Option<Measured>,
    /// Specific force, or its integral.
    pub velocity: Option<Measured>,
    /// Length of the interval, as the unit says it.
    pub interval_s: Option<f64>,
    /// End of the interval.
    pub stamp: Option<Stamp>,
    /// Number of the reading. A counter that rolls over is continued.
    pub sequence: Option<u64>,
    /// Angles of the gimbals, where the unit has them.
    pub gimbal: Option<GimbalAngles>,
    /// What the unit says about the reading, as far as it has a meaning here.
    pub status: Status,
    /// The status as the protocol has it.
    pub status_word: Option<u32>,
    /// Temperature of the unit, °C.
    pub temperature_c: Option<f32>,
}

impl Reading {
    /// Nothing is known.
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

    /// A sample as a unit with the resolution of this project would say it.
    #[must_use]
    pub fn of_sample(sample: &Sample) -> Self {
        let counts = |counts, lsb| Some(Measured::counts(Kind::Increment, counts, lsb));
        Self {
            rotation: counts(sample.delta_theta, DELTA_THETA_LSB_RAD),
            velocity: counts(sample.delta_velocity, DELTA_VELOCITY_LSB_MPS),
            interval_s: None,
            stamp: Some(Stamp { ns: sample.device_time.ns, clock: Clock::Startup }),
            sequence: Some(sample.sequence),
            gimbal: Some(sample.gimbal),
            status: sample.status,
            status_word: Some(u32::from(sample.status.bits())),
            temperature_c: None,
        }
    }

    /// There is rotation or specific force in it.
    #[must_use]
    pub fn is_inertial(&self) -> bool {
        self.rotation.is_some() || self.velocity.is_some()
    }
}
