//! Converts between the unit of an FMU's variable and SI.

use octant_fmu_host::description::units::{UnitConversion as Units, UnitError};
use octant_fmu_host::description::{Description, Variable, VariableType};
use octant_scenario::UnitDimension;
use octant_scenario::channel::{Channel, Class};

/// SI value = factor · value + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelConversion {
    /// SI units in a unit of the value.
    pub factor: f64,
    /// SI value of zero.
    pub offset: f64,
}

impl ChannelConversion {
    /// Passes the value unchanged, to the last bit.
    pub const IDENTITY: Self = Self { factor: 1.0, offset: 0.0 };

    /// Converts into SI.
    #[must_use]
    #[inline]
    pub fn to_si(self, value: f64) -> f64 {
        // A sum would lose the sign of zero.
        if self == Self::IDENTITY { value } else { self.factor * value + self.offset }
    }

    /// Converts from SI.
    #[must_use]
    #[inline]
    pub fn from_si(self, si: f64) -> f64 {
        if self == Self::IDENTITY { si } else { (si - self.offset) / self.factor }
    }

    fn scaled(units: Units, scale: f64) -> Self {
        Self { factor: units.factor * scale, offset: units.offset }
    }
}

/// Reason why values of a variable can't become those of a channel.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChannelConversionError {
    /// The type of the variable can't hold the values of the channel.
    #[error("{variable} is {}, and {channel} is {expected}", article(.kind.name()))]
    Type {
        /// Name of the variable.
        variable: String,
        /// Type found.
        kind: VariableType,
        /// Name of the channel.
        channel: &'static str,
        /// Values of the channel.
        expected: &'static str,
    },
    /// A scale was given for values that have none.
    #[error("found a scale, and {channel} is nothing that can be scaled")]
    Scale {
        /// Name of the channel.
        channel: &'static str,
    },
    /// Neither description nor scenario give the unit.
    #[error(
        "{variable} has no unit in its description, and {channel} is {}: say which, as in {{ \
         variable = {variable:?}, unit = {:?} }}",
        .dimension.name, .dimension.unit
    )]
    NoUnit {
        /// Name of the variable.
        variable: String,
        /// Name of the channel.
        channel: &'static str,
        /// Dimension expected.
        dimension: UnitDimension,
    },
    /// The unit is of another dimension.
    #[error("{variable} is in {unit}, {found}, and {channel} is {expected}")]
    Dimension {
        /// Name of the variable.
        variable: String,
        /// Its unit.
        unit: String,
        /// Dimension found.
        found: String,
        /// Name of the channel.
        channel: &'static str,
        /// Dimension expected.
        expected: String,
    },
    /// The unit can't be converted.
    #[error("{variable}: {error}")]
    Unit {
        /// Name of the variable.
        variable: String,
        /// Reason.
        error: UnitError,
    },
    /// Scenario and description give different units.
    #[error("found unit = {found:?}, and the description says that {variable} is in {expected}")]
    OtherUnit {
        /// Name of the variable.
        variable: String,
        /// Unit of the scenario.
        found: String,
        /// Unit of the description.
        expected: String,
    },
}

/// Returns the conversion from values of a variable to those of a channel. `unit` is the scenario's
/// unit, for a description without one.
///
/// # Errors
/// If type or unit don't fit: found and expected.
pub fn conversion(
    description: &Description,
    variable: &Variable,
    channel: &Channel,
    unit: Option<&str>,
    scale: f64,
) -> Result<ChannelConversion, ChannelConversionError> {
    fits(variable, channel)?;
    match channel.class {
        Class::Flag | Class::Code if scale != 1.0 => {
            Err(ChannelConversionError::Scale { channel: channel.name })
        }
        Class::Flag | Class::Code | Class::Whole => {
            Ok(ChannelConversion::scaled(Units::IDENTITY, scale))
        }
        Class::Nanoseconds => {
            let units = units(description, variable, channel, unit, "ns")?;
            Ok(ChannelConversion::scaled(units.unwrap_or(Units::IDENTITY), scale))
        }
        Class::Number => {
            let units = units(description, variable, channel, unit, "1")?;
            Ok(ChannelConversion::scaled(units.unwrap_or(Units::IDENTITY), scale))
        }
        Class::Quantity(dimension) => {
            match units(description, variable, channel, unit, dimension.si_unit())? {
                Some(units) => Ok(ChannelConversion::scaled(units, scale)),
                None => Err(ChannelConversionError::NoUnit {
                    variable: variable.name.clone(),
                    channel: channel.name,
                    dimension,
                }),
            }
        }
    }
}

/// Checks that the type of a variable can hold the values of a channel.
///
/// # Errors
/// If it can't: found and expected.
pub fn fits(variable: &Variable, channel: &Channel) -> Result<(), ChannelConversionError> {
    let number = !matches!(
        variable.kind,
        VariableType::Boolean | VariableType::String | VariableType::Binary | VariableType::Clock
    );
    let (good, expected) = match channel.class {
        Class::Flag => {
            (variable.kind == VariableType::Boolean || is_whole(variable.kind), "true or false")
        }
        Class::Code => (number, "a code: a whole number or an enumeration"),
        Class::Whole | Class::Nanoseconds => (number, "a whole number"),
        Class::Number | Class::Quantity(_) => (number, "a number"),
    };
    if good {
        return Ok(());
    }
    Err(ChannelConversionError::Type {
        variable: variable.name.clone(),
        kind: variable.kind,
        channel: channel.name,
        expected,
    })
}

fn is_whole(kind: VariableType) -> bool {
    !kind.is_float()
        && !matches!(
            kind,
            VariableType::Boolean
                | VariableType::String
                | VariableType::Binary
                | VariableType::Clock
        )
}

/// Returns the conversion from a variable's unit into `wanted`; `None` where no unit is given.
fn units(
    description: &Description,
    variable: &Variable,
    channel: &Channel,
    said: Option<&str>,
    wanted: &str,
) -> Result<Option<Units>, ChannelConversionError> {
    let problem = |error: UnitError, unit: &str| match error {
        UnitError::Dimension { from_exponents, .. } => {
            let found = match UnitDimension::with_exponents(&from_exponents) {
                Some(dimension) => dimension.name.to_owned(),
                None => octant_fmu_host::description::units::dimension(from_exponents),
            };
            let expected = match channel.class {
                Class::Quantity(dimension) => {
                    format!("{}, such as {}", dimension.name, dimension.unit)
                }
                Class::Nanoseconds => "a time, in ns".to_owned(),
                _ => "a number without unit".to_owned(),
            };
            ChannelConversionError::Dimension {
                variable: variable.name.clone(),
                unit: unit.to_owned(),
                found,
                channel: channel.name,
                expected,
            }
        }
        error => ChannelConversionError::Unit { variable: variable.name.clone(), error },
    };
    match (&variable.unit, said) {
        (None, None) => Ok(None),
        (None, Some(said)) => {
            let found = Units::between(description, said, wanted).map_err(|e| problem(e, said))?;
            Ok(Some(found))
        }
        (Some(unit), said) => {
            let found =
                Units::of(description, variable, wanted).map_err(|error| problem(error, unit))?;
            if let Some(said) = said
                && !Units::between(description, said, unit).is_ok_and(|units| units.is_identity())
            {
                return Err(ChannelConversionError::OtherUnit {
                    variable: variable.name.clone(),
                    found: said.to_owned(),
                    expected: unit.clone(),
                });
            }
            Ok(Some(found))
        }
    }
}

/// Puts the indefinite article before a word.
pub(super) fn article(word: &str) -> String {
    let vowel = word.starts_with(['A', 'E', 'I', 'O', 'a', 'e', 'i', 'o']);
    format!("{} {word}", if vowel { "an" } else { "a" })
}
