//! What a kind of fault is: its name, where it acts, what it takes and what it does, as data.

use crate::rule::Rule;
use crate::setup::{BuildError, Setup};
use crate::values::Values;

/// A kind of fault.
#[derive(Debug)]
pub struct Kind {
    /// Name in scenarios: lower case, words joined by hyphens.
    pub name: &'static str,
    /// What it belongs to.
    pub family: Family,
    /// Where it acts.
    pub acts: Acts,
    /// What it is, in one sentence.
    pub summary: &'static str,
    /// What it does to samples, exactly: the page of `octant faults describe`. Paragraphs are
    /// separated by empty lines, equations stand on indented lines.
    pub model: &'static str,
    /// What it takes, beside what every fault takes.
    pub parameters: &'static [Parameter],
    /// How long it lasts.
    pub lasts: Lasts,
    /// Makes the rule of one fault of this kind.
    pub build: fn(&Values, &Setup) -> Result<Rule, BuildError>,
}

impl Kind {
    /// The parameter of a name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}

/// What kinds belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Motion and environment, inside the plant.
    Physics,
    /// Errors of the sensors that are still measurements.
    Analogue,
    /// Optical effects of ring lasers.
    RingLaser,
    /// What happens to numbers after they were measured.
    Digital,
    /// Stamps, order and delivery.
    Time,
    /// Gimbals, drives and encoders.
    Turntable,
    /// The unit under test itself.
    Unit,
    /// The reference of the calibration.
    Aiding,
    /// The wire to a device.
    Wire,
    /// The host that the harness runs on.
    Host,
}

impl Family {
    /// All families, in the order of the documentation.
    pub const ALL: [Self; 10] = [
        Self::Physics,
        Self::Analogue,
        Self::RingLaser,
        Self::Digital,
        Self::Time,
        Self::Turntable,
        Self::Unit,
        Self::Aiding,
        Self::Wire,
        Self::Host,
    ];

    /// Name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Analogue => "sensor, analogue",
            Self::RingLaser => "sensor, ring laser",
            Self::Digital => "sensor, digital",
            Self::Time => "time",
            Self::Turntable => "turntable",
            Self::Unit => "unit under test",
            Self::Aiding => "aiding",
            Self::Wire => "wire",
            Self::Host => "host",
        }
    }
}

/// Where a fault acts. Each is a place on the way of a sample; the trait of the place is in
/// [`crate::rule`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Acts {
    /// Inside the plant, before the sensors integrate. Needs a simulated source.
    Plant,
    /// On the set point on its way from the core to the turntable. Needs a source with a turntable.
    Command,
    /// On samples and aiding on their way to the core, one epoch at a time. Any source.
    Samples,
    /// On the delivery of epochs: lost, late, in another order. Any source.
    Delivery,
    /// On the unit under test.
    Unit,
    /// On the wire to the unit under test. Needs an endpoint with a wire.
    Wire,
    /// On the host that the harness runs on. What it needs is said by its kind.
    Host,
}

/// How long a fault of a kind lasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lasts {
    /// As long as its `duration`, then it is gone. It can't fade: it is there or it isn't.
    Span,
    /// As long as its `duration`, then it fades linearly over its `recovery`.
    Fading,
    /// An instant: it has no duration.
    Instant,
}

/// What a kind takes under a name.
#[derive(Debug)]
pub struct Parameter {
    /// Key in the scenario.
    pub name: &'static str,
    /// What it takes.
    pub takes: Takes,
    /// What stands in where it is left out, as it would be written in a scenario; `None`: it can't
    /// be left out.
    pub default: Option<&'static str>,
    /// What it means, in one sentence.
    pub doc: &'static str,
}

/// Forms of a parameter's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Takes {
    /// A quantity of one of these dimensions.
    Quantity(&'static [Dimension], Bounds),
    /// A quantity for each of x, y, z.
    Vector(&'static [Dimension]),
    /// A whole number, from and to.
    Integer(i64, i64),
    /// Yes or no.
    Flag,
    /// One of these names, with their meanings.
    Choice(&'static [(&'static str, &'static str)]),
    /// Channels of the sensors.
    Channels,
    /// A plain number.
    Number(Bounds),
    /// Of a connection: a value that its input can have, with a unit or in that of the input, or
    /// `last`.
    Value,
    /// Of a connection: a difference of values, with a unit or in that of the input.
    Difference(Bounds),
}

/// Limits of a quantity, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// Any finite value but zero: with zero the fault would do nothing.
    NotZero,
    /// Any finite value.
    Any,
    /// Above zero.
    Positive,
    /// Zero or more.
    NotNegative,
    /// From, to, SI, and how the user reads it ("from 0 to 1").
    Within(f64, f64, &'static str),
}

/// What a quantity measures. A value in [`Values`] is in the SI unit named here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// s.
    Time,
    /// Whole samples; written `"20 samples"`.
    Samples,
    /// 1/s.
    Frequency,
    /// rad.
    Angle,
    /// rad, written in arcsec.
    SmallAngle,
    /// rad/s of a motion.
    AngularRate,
    /// rad/s of a gyro error.
    GyroBias,
    /// rad/s².
    AngularAcceleration,
    /// rad/√s.
    AngleRandomWalk,
    /// rad/s/√s.
    RateRandomWalk,
    /// (rad/s)/(m/s²).
    GDependent,
    /// m.
    Length,
    /// m/s.
    Velocity,
    /// m/s².
    Acceleration,
    /// m/s² of an accelerometer error.
    AccelBias,
    /// (m/s²)/√Hz.
    VelocityRandomWalk,
    /// (m/s²)/√s, a random walk of the accelerometer bias.
    AccelRandomWalk,
    /// 1.
    Ratio,
    /// K.
    Temperature,
    /// K/s.
    TemperatureRate,
    /// (rad/s)/K.
    GyroBiasPerK,
    /// (m/s²)/K.
    AccelBiasPerK,
    /// 1/K.
    ScalePerK,
    /// (m/s²)²/Hz, written in g²/Hz.
    AccelerationPsd,
}
