//! Between the unit of an FMU's variable and SI.

use super::channel::{Channel, Class};
use crate::fmu::description::{BaseUnit, Description, Kind, Variable};
use crate::scenario::{Dimension, unit_of_name};

/// SI value = factor · value + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    factor: f64,
    offset: f64,
}

impl Conversion {
    /// The value as it is, to the last bit.
    pub const IDENTITY: Self = Self { factor: 1.0, offset: 0.0 };

    /// With this factor.
    #[must_use]
    pub const fn times(factor: f64) -> Self {
        Self { factor, offset: 0.0 }
    }

    /// This one after the value was multiplied.
    #[must_use]
    pub fn scaled(self, scale: f64) -> Self {
        Self { factor: self.factor * scale, ..self }
    }

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
    let wrong = |expected: &str| {
        Err(format!(
            "{} is {}, and {} is {expected}",
            variable.name,
            article(kind_name(variable.kind)),
            channel.name
        ))
    };
    let whole = matches!(
        variable.kind,
        Kind::Int8
            | Kind::UInt8
            | Kind::Int16
            | Kind::UInt16
            | Kind::Int32
            | Kind::UInt32
            | Kind::Int64
            | Kind::UInt64
            | Kind::Enumeration
    );
    let real = matches!(variable.kind, Kind::Float64 | Kind::Float32);
    match channel.class {
        Class::Flag if variable.kind == Kind::Boolean || whole => no_scale(channel, scale),
        Class::Flag => wrong("true or false"),
        Class::Code if whole || real => no_scale(channel, scale),
        Class::Code => wrong("a code: a whole number or an enumeration"),
        Class::Whole if whole || real => Ok(Conversion::times(scale)),
        Class::Whole => wrong("a whole number"),
        _ if !whole && !real => wrong("a number"),
        Class::Nanoseconds => {
            let unit = unit_of(description, variable, channel, unit, Dimension::TIME)?;
            Ok(unit.map_or(Conversion::times(scale), |unit| {
                // A nanosecond has to be one to the last bit.
                let factor = unit.factor * 1e9;
                let factor = if (factor - 1.0).abs() < 1e-12 { 1.0 } else { factor };
                Conversion::times(factor).scaled(scale)
            }))
        }
        Class::Number => {
            let unit = unit_of(description, variable, channel, unit, Dimension::RATIO)?;
            Ok(unit.unwrap_or(Conversion::IDENTITY).scaled(scale))
        }
        Class::Quantity(dimension) => {
            match unit_of(description, variable, channel, unit, dimension)? {
                Some(unit) => Ok(unit.scaled(scale)),
                None => Err(format!(
                    "{} has no unit in its description, and {} is {}: say which, as in {{ variable \
                     = {:?}, unit = {:?} }}",
                    variable.name, channel.name, dimension.name, variable.name, dimension.unit
                )),
            }
        }
    }
}

fn no_scale(channel: &Channel, scale: f64) -> Result<Conversion, String> {
    if scale == 1.0 {
        return Ok(Conversion::IDENTITY);
    }
    Err(format!("found a scale, and {} is nothing that can be scaled", channel.name))
}

/// The unit of a variable as a conversion into SI of a dimension; `None` where nobody says one.
fn unit_of(
    description: &Description,
    variable: &Variable,
    channel: &Channel,
    said: Option<&str>,
    dimension: Dimension,
) -> Result<Option<Conversion>, String> {
    let described = match &variable.unit {
        None => None,
        Some(name) => Some((name, of_description(description, name, variable)?)),
    };
    let said = match said {
        None => None,
        Some(name) => {
            Some((name, by_name(name).ok_or_else(|| format!("found the unknown unit {name:?}"))?))
        }
    };
    let base = match (&described, &said) {
        (None, None) => return Ok(None),
        (None, Some((_, base))) => *base,
        (Some((_, base)), None) => *base,
        (Some((name, base)), Some((said, other))) => {
            if !same(base, other) {
                return Err(format!(
                    "found unit = {said:?}, and the description says that {} is in {name}",
                    variable.name
                ));
            }
            *base
        }
    };
    let expected = dimension.exponents().unwrap_or_default();
    let is = base.exponents;
    let but_rad = is[..7] == expected[..7];
    // Many tools leave the radian out of base units: its name tells.
    let angular = is[7] == 0
        && but_rad
        && described.as_ref().is_some_and(|(name, _)| {
            ["rad", "deg", "°", "arc", "grad"].iter().any(|part| name.contains(part))
        });
    if is != expected && !angular {
        let name = described.as_ref().map(|(name, _)| name.as_str());
        let name = name.or(said.as_ref().map(|(name, _)| *name)).unwrap_or_default();
        let found = Dimension::with_exponents(&is).map_or("another dimension", |d| d.name);
        let expected = if dimension == Dimension::RATIO {
            "a number without unit".to_owned()
        } else {
            format!("{}, such as {}", dimension.name, dimension.unit)
        };
        return Err(format!(
            "{} is in {name}, {found}, and {} is {expected}",
            variable.name, channel.name
        ));
    }
    Ok(Some(Conversion { factor: base.factor, offset: base.offset }))
}

fn same(a: &BaseUnit, b: &BaseUnit) -> bool {
    a.exponents[..7] == b.exponents[..7]
        && (a.factor - b.factor).abs() <= 1e-9 * b.factor.abs()
        && a.offset == b.offset
}

/// The unit of a variable; `None` where it has none.
///
/// # Errors
/// If nobody knows it.
pub fn base_unit(
    description: &Description,
    variable: &Variable,
) -> Result<Option<BaseUnit>, String> {
    variable.unit.as_ref().map(|name| of_description(description, name, variable)).transpose()
}

/// A unit as the description defines it, or by its name where it has no definition.
fn of_description(
    description: &Description,
    name: &str,
    variable: &Variable,
) -> Result<BaseUnit, String> {
    let defined = description.units.iter().find(|unit| unit.name == name);
    defined.and_then(|unit| unit.base).or_else(|| by_name(name)).ok_or_else(|| {
        format!(
            "{} is in {name}, a unit that the description doesn't define and that isn't known by \
             its name",
            variable.name
        )
    })
}

/// A unit by its name.
fn by_name(name: &str) -> Option<BaseUnit> {
    let (factor, exponents) = unit_of_name(name)?;
    Some(BaseUnit { exponents, factor, offset: 0.0 })
}

/// The name of a type as the standards have it.
pub(super) fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Float64 => "Real (Float64)",
        Kind::Float32 => "Float32",
        Kind::Int8 => "Int8",
        Kind::UInt8 => "UInt8",
        Kind::Int16 => "Int16",
        Kind::UInt16 => "UInt16",
        Kind::Int32 => "Integer (Int32)",
        Kind::UInt32 => "UInt32",
        Kind::Int64 => "Int64",
        Kind::UInt64 => "UInt64",
        Kind::Boolean => "Boolean",
        Kind::String => "String",
        Kind::Binary => "Binary",
        Kind::Enumeration => "Enumeration",
        Kind::Clock => "Clock",
    }
}

/// A word with its article.
pub(super) fn article(word: &str) -> String {
    let vowel = word.starts_with(['A', 'E', 'I', 'O', 'a', 'e', 'i', 'o']);
    format!("{} {word}", if vowel { "an" } else { "a" })
}
