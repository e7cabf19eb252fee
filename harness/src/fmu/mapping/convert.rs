//! Between the unit of an FMU's variable and SI.

use octant_fmu_host::description::units::{Conversion as Units, UnitError};
use octant_fmu_host::description::{Description, Kind, Variable};
use octant_scenario::Dimension;
use octant_scenario::channel::{Channel, Class};

/// SI value = factor · value + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    factor: f64,
    offset: f64,
}

impl Conversion {
    /// The value as it is, to the last bit.
    pub const IDENTITY: Self = Self { factor: 1.0, offset: 0.0 };

    /// Into SI.
    #[must_use]
    #[inline]
    pub fn to_si(self, value: f64) -> f64 {
        // A sum would lose the sign of zero.
        if self == Self::IDENTITY { value } else { self.factor * value + self.offset }
    }

    /// From SI.
    #[must_use]
    #[inline]
    pub fn from_si(self, si: f64) -> f64 {
        if self == Self::IDENTITY { si } else { (si - self.offset) / self.factor }
    }

    fn scaled(units: Units, scale: f64) -> Self {
        Self { factor: units.factor * scale, offset: units.offset }
    }
}

/// How values of a variable become those of a channel. `unit` is what the scenario says where the
/// description doesn't.
///
/// # Errors
/// If type or unit don't fit: what was found and what is expected.
pub fn conversion(
    description: &Description,
    variable: &Variable,
    channel: &Channel,
    unit: Option<&str>,
    scale: f64,
) -> Result<Conversion, String> {
    fits(variable, channel)?;
    match channel.class {
        Class::Flag | Class::Code if scale != 1.0 => {
            Err(format!("found a scale, and {} is nothing that can be scaled", channel.name))
        }
        Class::Flag | Class::Code | Class::Whole => Ok(Conversion::scaled(Units::IDENTITY, scale)),
        Class::Nanoseconds => {
            let units = units(description, variable, channel, unit, "ns")?;
            Ok(Conversion::scaled(units.unwrap_or(Units::IDENTITY), scale))
        }
        Class::Number => {
            let units = units(description, variable, channel, unit, "1")?;
            Ok(Conversion::scaled(units.unwrap_or(Units::IDENTITY), scale))
        }
        Class::Quantity(dimension) => {
            match units(description, variable, channel, unit, dimension.si_unit())? {
                Some(units) => Ok(Conversion::scaled(units, scale)),
                None => Err(format!(
                    "{} has no unit in its description, and {} is {}: say which, as in {{ variable \
                     = {:?}, unit = {:?} }}",
                    variable.name, channel.name, dimension.name, variable.name, dimension.unit
                )),
            }
        }
    }
}

/// Whether the type of a variable can hold what a channel is.
///
/// # Errors
/// If it can't: both, in words.
pub fn fits(variable: &Variable, channel: &Channel) -> Result<(), String> {
    let number =
        !matches!(variable.kind, Kind::Boolean | Kind::String | Kind::Binary | Kind::Clock);
    let (good, expected) = match channel.class {
        Class::Flag => (variable.kind == Kind::Boolean || is_whole(variable.kind), "true or false"),
        Class::Code => (number, "a code: a whole number or an enumeration"),
        Class::Whole | Class::Nanoseconds => (number, "a whole number"),
        Class::Number | Class::Quantity(_) => (number, "a number"),
    };
    if good {
        return Ok(());
    }
    Err(format!(
        "{} is {}, and {} is {expected}",
        variable.name,
        article(variable.kind.name()),
        channel.name
    ))
}

fn is_whole(kind: Kind) -> bool {
    !kind.is_float() && !matches!(kind, Kind::Boolean | Kind::String | Kind::Binary | Kind::Clock)
}

/// From the unit of a variable into another; `None` where nobody says one.
fn units(
    description: &Description,
    variable: &Variable,
    channel: &Channel,
    said: Option<&str>,
    wanted: &str,
) -> Result<Option<Units>, String> {
    let problem = |error: UnitError, unit: &str| match error {
        UnitError::Dimension { from_exponents, .. } => {
            let found = match Dimension::with_exponents(&from_exponents) {
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
            format!("{} is in {unit}, {found}, and {} is {expected}", variable.name, channel.name)
        }
        other => format!("{}: {other}", variable.name),
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
                return Err(format!(
                    "found unit = {said:?}, and the description says that {} is in {unit}",
                    variable.name
                ));
            }
            Ok(Some(found))
        }
    }
}

/// A word with its article.
pub(super) fn article(word: &str) -> String {
    let vowel = word.starts_with(['A', 'E', 'I', 'O', 'a', 'e', 'i', 'o']);
    format!("{} {word}", if vowel { "an" } else { "a" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conversion_and_its_inverse() {
        let celsius = Conversion { factor: 1.0, offset: 273.15 };
        assert_eq!(celsius.to_si(20.0), 293.15);
        assert!((celsius.from_si(293.15) - 20.0).abs() < 1e-12);
        assert_eq!(Conversion::IDENTITY.to_si(-0.0).to_bits(), (-0.0f64).to_bits());
        assert_eq!(Conversion::IDENTITY.from_si(-0.0).to_bits(), (-0.0f64).to_bits());
    }
}
