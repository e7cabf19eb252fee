//! Values that are set in an FMU before it starts, checked against its description.

use super::convert::{ChannelConversionError, article, conversion};
use super::find::{UnknownVariable, count, find, unknown};
pub use super::starts::Starts;
use super::starts::settable;
use octant_fmu_host::description::{Causality, Description, Variability, Variable, VariableType};
use octant_fmu_host::instance::{Access, InstanceError, VariableGroup, whole};
use octant_scenario::channel::{Channel, Class};
use octant_scenario::{Set, UnitDimension, quantity_of};
use std::ops::Range;

/// Reason why a value can't be set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingError {
    /// No variable has the name.
    #[error(transparent)]
    Unknown(#[from] UnknownVariable),
    /// The variable has another number of elements.
    #[error("found {found} values, and {name} has {expected} elements")]
    Count {
        /// Name of the variable.
        name: String,
        /// Number of values.
        found: usize,
        /// Number of elements.
        expected: usize,
    },
    /// The name is that of one element of an array.
    #[error("{name} is one element of {array}: expected a value for each of its elements")]
    Element {
        /// Name found.
        name: String,
        /// Name of the array.
        array: String,
    },
    /// The variable has no start value that may be changed.
    #[error("{variable} can't be set: it is {is}")]
    Fixed {
        /// Name of the variable.
        variable: String,
        /// Its causality and variability, in words.
        is: &'static str,
    },
    /// The type of the variable doesn't have the value.
    #[error(
        "found {}, and {variable} is {}: expected {expected}",
        in_words(.found),
        article(.kind.name())
    )]
    Value {
        /// Name of the variable.
        variable: String,
        /// Its type.
        kind: VariableType,
        /// Value found.
        found: Set,
        /// Value expected.
        expected: String,
    },
    /// The value is beyond a limit of the variable.
    #[error("found {found}{unit}, and {variable} is {side} {limit}{unit}")]
    Limit {
        /// Name of the variable.
        variable: String,
        /// Value found, in the variable's unit.
        found: f64,
        /// `at least` or `at most`.
        side: &'static str,
        /// Limit.
        limit: f64,
        /// Unit after a blank; empty if there is none.
        unit: String,
    },
    /// A quantity was found for a variable without unit.
    #[error("found {found:?}, and {variable} has no unit in its description: expected a number")]
    NoUnit {
        /// Name of the variable.
        variable: String,
        /// Quantity found.
        found: String,
    },
    /// A quantity is of a dimension that scenarios don't have.
    #[error("found {found:?}, of a dimension that no variable of a scenario has")]
    NoDimension {
        /// Quantity found.
        found: String,
    },
    /// A quantity doesn't fit the variable's unit.
    #[error(transparent)]
    Conversion(#[from] ChannelConversionError),
}

fn in_words(value: &Set) -> String {
    match value {
        Set::Number(number) => format!("the number {number}"),
        Set::Whole(number) => format!("the number {number}"),
        Set::Flag(flag) => flag.to_string(),
        Set::Text(text) => format!("{text:?}"),
    }
}

/// Collects values to set; a later value of a variable replaces an earlier one.
#[derive(Debug)]
pub struct ValueSettings<'a> {
    description: &'a Description,
    numbers: Vec<(&'a Variable, Vec<f64>)>,
    texts: Vec<(&'a Variable, Vec<String>)>,
    bytes: Vec<(&'a Variable, Vec<Vec<u8>>)>,
}

impl<'a> ValueSettings<'a> {
    /// Creates an empty collection for an FMU.
    #[must_use]
    pub fn new(description: &'a Description) -> Self {
        Self { description, numbers: Vec::new(), texts: Vec::new(), bytes: Vec::new() }
    }

    /// Sets a variable by its name.
    ///
    /// # Errors
    /// If there is no such variable, it can't be set, or a value doesn't fit: found and expected.
    pub fn set(&mut self, name: &str, values: &[Set]) -> Result<(), SettingError> {
        let description = self.description;
        for (variable, range) in whole(description, name, values.len(), settable)? {
            let values = &values[range];
            check_settable(variable)?;
            if variable.kind == VariableType::String {
                let texts = values.iter().map(|value| match value {
                    Set::Text(text) => Ok(text.clone()),
                    other => Err(wrong(variable, other, "a text")),
                });
                let texts = texts.collect::<Result<_, _>>()?;
                self.texts.retain(|(known, _)| !std::ptr::eq(*known, variable));
                self.texts.push((variable, texts));
            } else if variable.kind == VariableType::Binary {
                let bytes = values.iter().map(|value| hexadecimal(variable, value));
                let bytes = bytes.collect::<Result<_, _>>()?;
                self.bytes.retain(|(known, _)| !std::ptr::eq(*known, variable));
                self.bytes.push((variable, bytes));
            } else {
                let numbers = values.iter().map(|value| number(description, variable, value));
                self.put(variable, numbers.collect::<Result<_, _>>()?);
            }
        }
        Ok(())
    }

    /// Sets the numbers of a variable of one of our own FMUs, without conversion.
    ///
    /// # Errors
    /// If the FMU doesn't have it.
    pub fn own(&mut self, name: &str, numbers: &[f64]) -> Result<(), SettingError> {
        for (variable, range) in whole(self.description, name, numbers.len(), settable)? {
            let carried = |number: &f64| {
                let whole = if whole::is_wide(variable.kind) { whole::of(*number) } else { None };
                whole.and_then(|whole| whole::to_bits(variable.kind, whole)).unwrap_or(*number)
            };
            self.put(variable, numbers[range].iter().map(carried).collect());
        }
        Ok(())
    }

    fn put(&mut self, variable: &'a Variable, numbers: Vec<f64>) {
        match self.numbers.iter_mut().find(|(known, _)| std::ptr::eq(*known, variable)) {
            Some((_, values)) => *values = numbers,
            None => self.numbers.push((variable, numbers)),
        }
    }

    /// Returns everything that was set.
    ///
    /// # Errors
    /// If the variables can't be set together.
    pub fn finish(self) -> Result<Starts, InstanceError> {
        let mut numbers: Vec<(VariableGroup, Vec<f64>)> = Vec::new();
        for (variable, values) in self.numbers {
            let one = VariableGroup::of(self.description, variable)?.exactly();
            let same = |(group, _): &&mut (VariableGroup, Vec<f64>)| {
                group.kind == one.kind && group.access == one.access
            };
            match numbers.iter_mut().find(same) {
                Some((group, all)) => {
                    group.references.extend(one.references);
                    group.elements += one.elements;
                    all.extend(values);
                }
                None => numbers.push((one, values)),
            }
        }
        numbers.sort_by_key(|(group, _)| group.access != Access::Configuration);
        let texts = self.texts.into_iter();
        let texts = texts
            .map(|(variable, texts)| Ok((VariableGroup::of(self.description, variable)?, texts)));
        let bytes = self
            .bytes
            .into_iter()
            .map(|(variable, bytes)| Ok((VariableGroup::of(self.description, variable)?, bytes)));
        Ok(Starts {
            numbers,
            texts: texts.collect::<Result<_, InstanceError>>()?,
            bytes: bytes.collect::<Result<_, InstanceError>>()?,
        })
    }
}

/// Finds the whole variables to which a name refers, each with its range of the given values.
fn whole<'a>(
    description: &'a Description,
    name: &str,
    values: usize,
    could: impl Fn(&Variable) -> bool,
) -> Result<Vec<(&'a Variable, Range<usize>)>, SettingError> {
    let Some(found) = find(description, name, values).filter(|found| !found.negated) else {
        return Err(unknown(description, name, could).into());
    };
    if found.elements.len() != values {
        return Err(SettingError::Count {
            name: name.to_owned(),
            found: values,
            expected: found.elements.len(),
        });
    }
    let Some((first, _)) = found.elements.first() else { return Ok(Vec::new()) };
    // An array in the file, or one whose elements are scalars there.
    if found.elements.iter().all(|(variable, _)| std::ptr::eq(*variable, *first)) {
        if count(description, first) != values {
            return Err(SettingError::Element { name: name.to_owned(), array: first.name.clone() });
        }
        return Ok(vec![(first, 0..values)]);
    }
    Ok(found.elements.iter().enumerate().map(|(n, (variable, _))| (*variable, n..n + 1)).collect())
}

fn check_settable(variable: &Variable) -> Result<(), SettingError> {
    if settable(variable) {
        return Ok(());
    }
    Err(SettingError::Fixed {
        variable: variable.name.clone(),
        is: match (variable.variability, variable.causality) {
            (Variability::Constant, _) => "a constant",
            (_, Causality::CalculatedParameter) => "calculated from parameters",
            (_, Causality::Independent) => "the independent variable",
            (_, Causality::Output) => "an output that the FMU calculates",
            _ => "calculated by the FMU",
        },
    })
}

fn wrong(variable: &Variable, found: &Set, expected: &str) -> SettingError {
    SettingError::Value {
        variable: variable.name.clone(),
        kind: variable.kind,
        found: found.clone(),
        expected: expected.to_owned(),
    }
}

/// Converts a value into the number that is passed to the FMU, within the limits of the variable
/// and its type.
fn number(
    description: &Description,
    variable: &Variable,
    value: &Set,
) -> Result<f64, SettingError> {
    let mut carried = None;
    let number = match (variable.kind, value) {
        (VariableType::Boolean, Set::Flag(flag)) => return Ok(f64::from(u8::from(*flag))),
        (VariableType::Boolean, other) => return Err(wrong(variable, other, "true or false")),
        (VariableType::Binary | VariableType::Clock | VariableType::String, other) => {
            return Err(wrong(variable, other, "another variable: a clock ticks, and isn't set"));
        }
        (VariableType::Enumeration, value) => return item(description, variable, value),
        (VariableType::Float64 | VariableType::Float32, Set::Number(number)) => *number,
        (VariableType::Float64 | VariableType::Float32, Set::Whole(whole)) => whole::exact(*whole)
            .ok_or_else(|| wrong(variable, value, "a number that the type has"))?,
        (VariableType::Float64 | VariableType::Float32, Set::Text(text)) => {
            quantity(description, variable, text)?
        }
        (VariableType::Float64 | VariableType::Float32, other) => {
            return Err(wrong(variable, other, "a number, or a quantity with its unit"));
        }
        (kind, value) => {
            let (from, to) = limits(kind);
            let expected =
                || wrong(variable, value, &format!("a whole number from {from} to {to}"));
            let whole = match value {
                // Beyond this size digits may have been lost already.
                Set::Number(number) => {
                    whole::of(*number).filter(|whole| whole.abs() <= whole::EXACT_MAX)
                }
                Set::Whole(whole) => Some(*whole),
                // A configuration file has no whole numbers beyond 2⁶³, but texts.
                Set::Text(text) => text.trim().parse().ok(),
                Set::Flag(_) => None,
            };
            let whole = whole.filter(|whole| (from..=to).contains(whole)).ok_or_else(expected)?;
            carried = if whole::is_wide(kind) { whole::to_bits(kind, whole) } else { None };
            whole as f64
        }
    };
    let unit = variable.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
    let beyond = |side, limit| SettingError::Limit {
        variable: variable.name.clone(),
        found: number,
        side,
        limit,
        unit: unit.clone(),
    };
    if let Some(min) = variable.min.filter(|min| number < *min) {
        return Err(beyond("at least", min));
    }
    if let Some(max) = variable.max.filter(|max| number > *max) {
        return Err(beyond("at most", max));
    }
    Ok(carried.unwrap_or(number))
}

/// Returns the value of an enumeration's item, by its name or its number.
fn item(description: &Description, variable: &Variable, value: &Set) -> Result<f64, SettingError> {
    let items = variable
        .enumeration
        .as_ref()
        .and_then(|name| description.enumeration(name))
        .unwrap_or_default();
    let found = match value {
        Set::Text(text) => items.iter().find(|(_, name)| name == text),
        Set::Number(number) => {
            let whole = whole::of(*number).filter(|whole| whole.abs() <= whole::EXACT_MAX);
            items.iter().find(|(item, _)| Some(i128::from(*item)) == whole)
        }
        Set::Whole(whole) => items.iter().find(|(item, _)| i128::from(*item) == *whole),
        Set::Flag(_) => None,
    };
    let bits = found.and_then(|(item, _)| whole::to_bits(variable.kind, i128::from(*item)));
    if let Some(bits) = bits {
        return Ok(bits);
    }
    let known: Vec<String> =
        items.iter().map(|(item, name)| format!("{name:?} ({item})")).collect();
    Err(wrong(variable, value, &format!("one of {}", known.join(", "))))
}

/// Converts a quantity into the unit of the variable.
fn quantity(
    description: &Description,
    variable: &Variable,
    text: &str,
) -> Result<f64, SettingError> {
    let Ok(found) = quantity_of(text) else {
        let found = Set::Text(text.to_owned());
        return Err(wrong(variable, &found, "a number, or a quantity with its unit"));
    };
    if variable.unit.is_none() {
        return Err(SettingError::NoUnit {
            variable: variable.name.clone(),
            found: text.to_owned(),
        });
    }
    let Some(dimension) = UnitDimension::of(found) else {
        return Err(SettingError::NoDimension { found: text.to_owned() });
    };
    // Treated as a channel into the FMU.
    let channel =
        Channel { name: "the value", class: Class::Quantity(dimension), elements: 1, doc: "" };
    let conversion = conversion(description, variable, &channel, None, 1.0)?;
    Ok(conversion.from_si(found.si))
}

/// Returns the range of a whole-number type.
fn limits(kind: VariableType) -> (i128, i128) {
    match kind {
        VariableType::Int8 => (i8::MIN.into(), i8::MAX.into()),
        VariableType::UInt8 => (0, u8::MAX.into()),
        VariableType::Int16 => (i16::MIN.into(), i16::MAX.into()),
        VariableType::UInt16 => (0, u16::MAX.into()),
        VariableType::Int32 => (i32::MIN.into(), i32::MAX.into()),
        VariableType::UInt32 => (0, u32::MAX.into()),
        VariableType::UInt64 => (0, u64::MAX.into()),
        _ => (i64::MIN.into(), i64::MAX.into()),
    }
}

/// Reads the bytes of a Binary, written as hexadecimal digits.
fn hexadecimal(variable: &Variable, value: &Set) -> Result<Vec<u8>, SettingError> {
    let digits = match value {
        Set::Text(text) => text.clone(),
        // Digits alone were read as a number, which has lost its first zeros.
        Set::Number(_) | Set::Whole(_) | Set::Flag(_) => String::from("-"),
    };
    let digits = digits.trim();
    let digits = digits.strip_prefix("0x").unwrap_or(digits);
    let pairs = digits.as_bytes().chunks(2).map(|pair| {
        let text = std::str::from_utf8(pair).ok().filter(|text| text.len() == 2)?;
        u8::from_str_radix(text, 16).ok().filter(|_| !text.starts_with('+'))
    });
    pairs.collect::<Option<Vec<u8>>>().ok_or_else(|| {
        wrong(variable, value, "bytes as pairs of hexadecimal digits in quotes, such as \"00ff2a\"")
    })
}
