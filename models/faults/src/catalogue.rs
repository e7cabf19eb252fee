//! Kinds of faults as data: name, place, parameters and effect.

use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;

pub use crate::dimension::Dimension;

/// A kind of fault.
#[derive(Debug)]
pub struct FaultKind {
    /// Name in scenarios: lower case, words joined by hyphens.
    pub name: &'static str,
    /// Family of the kind.
    pub family: Family,
    /// Place where it acts.
    pub acts: Acts,
    /// Summary in one sentence.
    pub summary: &'static str,
    /// Exact effect on samples: the page of `octant faults describe`. Paragraphs are separated by
    /// empty lines, equations stand on indented lines.
    pub model: &'static str,
    /// Parameters, beside those that every fault has.
    pub parameters: &'static [FaultParameter],
    /// Duration of faults of this kind.
    pub lasts: Lasts,
    /// Example of the kind, as its page shows it.
    pub example: Example,
    /// Makes the rule of one fault of this kind.
    pub build: fn(&Values, &Setup) -> Result<FaultRule, FaultBuildError>,
}

impl FaultKind {
    /// Finds a parameter by its name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&'static FaultParameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}

/// Groups of kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Motion and environment, inside the plant.
    Physics,
    /// Errors of the sensors that are still measurements.
    Analogue,
    /// Optical effects of ring lasers.
    RingLaser,
    /// Alteration of numbers after they were measured.
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

    /// Name shown to users.
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

/// Place where a fault acts. Each is a place on the path of a sample; the trait of the place is in
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
    /// On the host that the harness runs on. The kind says what it needs.
    Host,
    /// On the supply of the unit under test. Needs a device with a supply whose voltage can be set.
    Power,
}

/// Duration of a fault of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lasts {
    /// As long as its `duration`, without fading.
    Span,
    /// As long as its `duration`, then it fades linearly over its `recovery`.
    Fading,
    /// An instant: it has no duration.
    Instant,
}

/// Example of a kind: the values that its form alone doesn't give, and the length of its picture.
#[derive(Debug)]
pub struct Example {
    values: &'static [(&'static str, &'static str)],
    /// Seconds from the onset that the picture shows, where the kind is over in an instant.
    pub shown_s: f64,
}

impl Example {
    /// Example in which every value is the usual one of its form.
    pub const NONE: Self = Self::of(&[]);

    /// Makes an example with values of its own: keys, and values as TOML.
    #[must_use]
    pub const fn of(values: &'static [(&'static str, &'static str)]) -> Self {
        Self { values, shown_s: 10.0 }
    }

    /// Sets the seconds from the onset that the picture shows.
    #[must_use]
    pub const fn showing_s(self, shown_s: f64) -> Self {
        Self { shown_s, ..self }
    }

    /// Finds the value of a key, as TOML.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<&'static str> {
        self.values.iter().find(|(name, _)| *name == key).map(|(_, value)| *value)
    }
}

/// One parameter of a kind.
#[derive(Debug)]
pub struct FaultParameter {
    /// Key in the scenario.
    pub name: &'static str,
    /// Form of the value.
    pub takes: Takes,
    /// Value if the scenario gives none, in the form of a scenario; `None`: the parameter is
    /// required.
    pub default: Option<&'static str>,
    /// Meaning in one sentence.
    pub doc: &'static str,
}

/// Forms of a parameter's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Takes {
    /// A quantity of one of these dimensions.
    Quantity(&'static [Dimension], ParameterBounds),
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
    Number(ParameterBounds),
    /// On a connection: a value that its input can have, with a unit or in that of the input, or
    /// `last`.
    Value,
    /// On a connection: a difference of values, with a unit or in that of the input.
    Difference(ParameterBounds),
}

/// Limits of a quantity, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterBounds {
    /// Any finite value but zero: at zero the fault would have no effect.
    NotZero,
    /// Any finite value.
    Any,
    /// Above zero.
    Positive,
    /// Zero or more.
    NotNegative,
    /// Lower limit, upper limit, SI, and their text for the user ("from 0 to 1").
    Within(f64, f64, &'static str),
}
