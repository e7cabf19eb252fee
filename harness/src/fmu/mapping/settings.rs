//! Values that are set in an FMU before it starts, checked against its description.

use super::convert::conversion;
use super::find::{count, find, unknown};
use octant_fmu_host::description::{Causality, Description, Initial, Kind, Variability, Variable};
use octant_fmu_host::instance::{Access, Group, Instance, InstanceError};
use octant_scenario::channel::{Channel, Class};
use octant_scenario::{Dimension, Set, quantity_of};
use std::ops::Range;

/// Values that are set before an FMU starts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Starts {
    /// Numbers by group, those of configuration mode first.
    numbers: Vec<(Group, Vec<f64>)>,
    /// Texts.
    texts: Vec<(Group, Vec<String>)>,
}

impl Starts {
    /// Sets them.
    ///
    /// # Errors
    /// If the FMU refuses.
    pub fn apply(&self, instance: &mut dyn Instance) -> Result<(), InstanceError> {
        for (group, numbers) in &self.numbers {
            instance.set(group, numbers)?;
        }
        for (group, texts) in &self.texts {
            instance.set_strings(group, texts)?;
        }
        Ok(())
    }
}

/// Collects what is set; what comes later counts.
#[derive(Debug)]
pub struct Settings<'a> {
    description: &'a Description,
    numbers: Vec<(&'a Variable, Vec<f64>)>,
    texts: Vec<(&'a Variable, Vec<String>)>,
}

impl<'a> Settings<'a> {
    /// Of an FMU.
    #[must_use]
    pub fn new(description: &'a Description) -> Self {
        Self { description, numbers: Vec::new(), texts: Vec::new() }
    }

    /// Sets a variable that somebody names.
    ///
    /// # Errors
    /// If there is no such variable, it can't be set, or a value doesn't fit: what was found and
    /// what is expected.
    pub fn set(&mut self, name: &str, values: &[Set]) -> Result<(), String> {
        let description = self.description;
        for (variable, range) in whole(description, name, values.len(), settable)? {
            let values = &values[range];
            check_settable(variable)?;
            if variable.kind == Kind::String {
                let texts = values.iter().map(|value| match value {
                    Set::Text(text) => Ok(text.clone()),
                    other => Err(wrong(variable, other, "a text")),
                });
                let texts = texts.collect::<Result<_, _>>()?;
                self.texts.retain(|(known, _)| !std::ptr::eq(*known, variable));
                self.texts.push((variable, texts));
            } else {
                let numbers = values.iter().map(|value| number(description, variable, value));
                self.put(variable, numbers.collect::<Result<_, _>>()?);
            }
        }
        Ok(())
    }

    /// Sets the numbers of a variable of one of our own FMUs as they are.
    ///
    /// # Errors
    /// If the FMU doesn't have it.
    pub fn own(&mut self, name: &str, numbers: &[f64]) -> Result<(), String> {
        for (variable, range) in whole(self.description, name, numbers.len(), settable)? {
            self.put(variable, numbers[range].to_vec());
        }
        Ok(())
    }

    fn put(&mut self, variable: &'a Variable, numbers: Vec<f64>) {
        match self.numbers.iter_mut().find(|(known, _)| std::ptr::eq(*known, variable)) {
            Some((_, values)) => *values = numbers,
            None => self.numbers.push((variable, numbers)),
        }
    }

    /// Everything that was set.
    ///
    /// # Errors
    /// If the variables can't be set together.
    pub fn finish(self) -> Result<Starts, InstanceError> {
        let mut numbers: Vec<(Group, Vec<f64>)> = Vec::new();
        for (variable, values) in self.numbers {
            let one = Group::of(self.description, variable)?;
            let same = |(group, _): &&mut (Group, Vec<f64>)| {
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
        let texts =
            texts.map(|(variable, texts)| Ok((Group::of(self.description, variable)?, texts)));
        Ok(Starts { numbers, texts: texts.collect::<Result<_, InstanceError>>()? })
    }
}

/// Whole variables that a name stands for, with the part of so many values that each gets.
fn whole<'a>(
    description: &'a Description,
    name: &str,
    values: usize,
    could: impl Fn(&Variable) -> bool,
) -> Result<Vec<(&'a Variable, Range<usize>)>, String> {
    let Some(found) = find(description, name, values).filter(|found| !found.negated) else {
        return Err(unknown(description, name, could));
    };
    if found.elements.len() != values {
        return Err(format!(
            "found {values} values, and {name} has {} elements",
            found.elements.len()
        ));
    }
    let Some((first, _)) = found.elements.first() else { return Ok(Vec::new()) };
    // An array as it is in the file, or one that is scalars there.
    if found.elements.iter().all(|(variable, _)| std::ptr::eq(*variable, *first)) {
        if count(description, first) != values {
            return Err(format!(
                "{name} is one element of {}: expected a value for each of its elements",
                first.name
            ));
        }
        return Ok(vec![(first, 0..values)]);
    }
    Ok(found.elements.iter().enumerate().map(|(n, (variable, _))| (*variable, n..n + 1)).collect())
}

fn check_settable(variable: &Variable) -> Result<(), String> {
    if settable(variable) {
        return Ok(());
    }
    Err(format!(
        "{} can't be set: it is {}",
        variable.name,
        match (variable.variability, variable.causality) {
            (Variability::Constant, _) => "a constant",
            (_, Causality::CalculatedParameter) => "calculated from parameters",
            (_, Causality::Independent) => "the independent variable",
            (_, Causality::Output) => "an output that the FMU calculates",
            _ => "calculated by the FMU",
        }
    ))
}

/// Whether a variable has a start value that may be changed.
fn settable(variable: &Variable) -> bool {
    if variable.variability == Variability::Constant {
        return false;
    }
    match variable.causality {
        Causality::Parameter | Causality::StructuralParameter | Causality::Input => true,
        Causality::CalculatedParameter | Causality::Independent => false,
        Causality::Output | Causality::Local => {
            matches!(variable.initial, Some(Initial::Exact | Initial::Approx))
        }
    }
}

fn wrong(variable: &Variable, found: &Set, expected: &str) -> String {
    let found = match found {
        Set::Number(number) => format!("the number {number}"),
        Set::Flag(flag) => flag.to_string(),
        Set::Text(text) => format!("{text:?}"),
    };
    format!(
        "found {found}, and {} is {}: expected {expected}",
        variable.name,
        super::convert::article(variable.kind.name())
    )
}

/// A value as the number that travels, within the limits of the variable and its type.
fn number(description: &Description, variable: &Variable, value: &Set) -> Result<f64, String> {
    let number = match (variable.kind, value) {
        (Kind::Boolean, Set::Flag(flag)) => return Ok(f64::from(u8::from(*flag))),
        (Kind::Boolean, other) => return Err(wrong(variable, other, "true or false")),
        (Kind::Binary | Kind::Clock | Kind::String, other) => {
            return Err(wrong(variable, other, "another variable: such can't be set here"));
        }
        (Kind::Enumeration, value) => return item(description, variable, value),
        (Kind::Float64 | Kind::Float32, Set::Number(number)) => *number,
        (Kind::Float64 | Kind::Float32, Set::Text(text)) => quantity(description, variable, text)?,
        (Kind::Float64 | Kind::Float32, other) => {
            return Err(wrong(variable, other, "a number, or a quantity with its unit"));
        }
        (kind, Set::Number(number)) => {
            let (from, to) = limits(kind);
            if number.fract() != 0.0 || !(from..=to).contains(number) {
                return Err(wrong(variable, value, &format!("a whole number from {from} to {to}")));
            }
            *number
        }
        (_, other) => return Err(wrong(variable, other, "a whole number")),
    };
    let unit = variable.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
    if let Some(min) = variable.min.filter(|min| number < *min) {
        return Err(format!("found {number}{unit}, and {} is at least {min}{unit}", variable.name));
    }
    if let Some(max) = variable.max.filter(|max| number > *max) {
        return Err(format!("found {number}{unit}, and {} is at most {max}{unit}", variable.name));
    }
    Ok(number)
}

/// The value of an enumeration's item, by its name or its number.
fn item(description: &Description, variable: &Variable, value: &Set) -> Result<f64, String> {
    let items = variable
        .enumeration
        .as_ref()
        .and_then(|name| description.enumeration(name))
        .unwrap_or_default();
    let found = match value {
        Set::Text(text) => items.iter().find(|(_, name)| name == text),
        Set::Number(number) => items.iter().find(|(item, _)| *item as f64 == *number),
        Set::Flag(_) => None,
    };
    if let Some((item, _)) = found {
        return Ok(*item as f64);
    }
    let known: Vec<String> =
        items.iter().map(|(item, name)| format!("{name:?} ({item})")).collect();
    Err(wrong(variable, value, &format!("one of {}", known.join(", "))))
}

/// A quantity in the unit of the variable.
fn quantity(description: &Description, variable: &Variable, text: &str) -> Result<f64, String> {
    let Ok(found) = quantity_of(text) else {
        let found = Set::Text(text.to_owned());
        return Err(wrong(variable, &found, "a number, or a quantity with its unit"));
    };
    if variable.unit.is_none() {
        return Err(format!(
            "found {text:?}, and {} has no unit in its description: expected a number",
            variable.name
        ));
    }
    let Some(dimension) = Dimension::of(found) else {
        return Err(format!("found {text:?}, of a dimension that no variable of a scenario has"));
    };
    // As if it were a channel that goes into the FMU.
    let channel =
        Channel { name: "the value", class: Class::Quantity(dimension), elements: 1, doc: "" };
    let conversion = conversion(description, variable, &channel, None, 1.0)?;
    Ok(conversion.from_si(found.si))
}

/// Range of a whole-number type that f64 holds exactly.
fn limits(kind: Kind) -> (f64, f64) {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    match kind {
        Kind::Int8 => (i8::MIN.into(), i8::MAX.into()),
        Kind::UInt8 => (0.0, u8::MAX.into()),
        Kind::Int16 => (i16::MIN.into(), i16::MAX.into()),
        Kind::UInt16 => (0.0, u16::MAX.into()),
        Kind::Int32 => (i32::MIN.into(), i32::MAX.into()),
        Kind::UInt32 => (0.0, u32::MAX.into()),
        Kind::UInt64 => (0.0, EXACT),
        _ => (-EXACT, EXACT),
    }
}
