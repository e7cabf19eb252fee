//! Values of a fault's parameters, checked and in SI.

use crate::dimension::Dimension;
use crate::setup::FaultBuildError;
use alloc::vec::Vec;

/// Value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A quantity, SI, with the dimension in which it was written.
    Quantity(f64, Dimension),
    /// A quantity for each of x, y, z.
    Vector([f64; 3], Dimension),
    /// A whole number.
    Integer(i64),
    /// A number; for faults on connections, in the unit of the input.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// A chosen name.
    Choice(&'static str),
    /// Channels.
    Channels(Channels),
}

/// Values of one fault by name: every parameter of its kind, defaults filled in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    entries: Vec<(&'static str, Value)>,
}

impl Values {
    /// Sets the value of a name; replaces an earlier one.
    pub fn set(&mut self, name: &'static str, value: Value) {
        match self.entries.iter_mut().find(|(known, _)| *known == name) {
            Some(entry) => entry.1 = value,
            None => self.entries.push((name, value)),
        }
    }

    /// Value of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<Value> {
        self.entries.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }

    /// Iterates over names and values in the order in which they were set.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, Value)> + '_ {
        self.entries.iter().copied()
    }

    /// Reads a quantity in SI.
    ///
    /// # Errors
    /// If there is none under the name.
    pub fn quantity(&self, name: &'static str) -> Result<f64, FaultBuildError> {
        self.quantity_and_dimension(name).map(|(value, _)| value)
    }

    /// Reads a quantity in SI, with its dimension.
    ///
    /// # Errors
    /// If there is none under the name.
    pub fn quantity_and_dimension(
        &self,
        name: &'static str,
    ) -> Result<(f64, Dimension), FaultBuildError> {
        match self.get(name) {
            Some(Value::Quantity(value, dimension)) => Ok((value, dimension)),
            _ => Err(FaultBuildError::missing(name)),
        }
    }

    /// Reads a vector in SI.
    ///
    /// # Errors
    /// If there is none under the name.
    pub fn vector(&self, name: &'static str) -> Result<[f64; 3], FaultBuildError> {
        match self.get(name) {
            Some(Value::Vector(value, _)) => Ok(value),
            _ => Err(FaultBuildError::missing(name)),
        }
    }

    /// Reads a whole number.
    ///
    /// # Errors
    /// If there is none under the name.
    pub fn integer(&self, name: &'static str) -> Result<i64, FaultBuildError> {
        match self.get(name) {
            Some(Value::Integer(value)) => Ok(value),
            _ => Err(FaultBuildError::missing(name)),
        }
    }

    /// Reads a number.
    ///
    /// # Errors
    /// If there is none under the name.
    pub fn number(&self, name: &'static str) -> Result<f64, FaultBuildError> {
        match self.get(name) {
            Some(Value::Number(value)) => Ok(value),
            _ => Err(FaultBuildError::missing(name)),
        }
    }

    /// Reads a yes or no.
    ///
    /// # Errors
    /// If there is none under the name.
    pub fn flag(&self, name: &'static str) -> Result<bool, FaultBuildError> {
        match self.get(name) {
            Some(Value::Flag(value)) => Ok(value),
            _ => Err(FaultBuildError::missing(name)),
        }
    }

    /// Reads a chosen name.
    ///
    /// # Errors
    /// If there is none under the name.
    pub fn choice(&self, name: &'static str) -> Result<&'static str, FaultBuildError> {
        match self.get(name) {
            Some(Value::Choice(value)) => Ok(value),
            _ => Err(FaultBuildError::missing(name)),
        }
    }

    /// Reads channels.
    ///
    /// # Errors
    /// If there are none under the name.
    pub fn channels(&self, name: &'static str) -> Result<Channels, FaultBuildError> {
        match self.get(name) {
            Some(Value::Channels(value)) => Ok(value),
            _ => Err(FaultBuildError::missing(name)),
        }
    }
}

/// A set of the six inertial channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Channels(u8);

impl Channels {
    /// The three gyros.
    pub const GYRO: Self = Self(0b000_111);
    /// The three accelerometers.
    pub const ACCELEROMETER: Self = Self(0b111_000);
    /// All six.
    pub const ALL: Self = Self(0b111_111);

    /// Names in scenarios, with their channels.
    pub const NAMES: [(&'static str, Self); 9] = [
        ("gyro x", Self(1)),
        ("gyro y", Self(1 << 1)),
        ("gyro z", Self(1 << 2)),
        ("accelerometer x", Self(1 << 3)),
        ("accelerometer y", Self(1 << 4)),
        ("accelerometer z", Self(1 << 5)),
        ("gyro", Self::GYRO),
        ("accelerometer", Self::ACCELEROMETER),
        ("all", Self::ALL),
    ];

    /// Finds a set by its name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, channels)| *channels)
    }

    /// One gyro: 0 x, 1 y, 2 z.
    #[must_use]
    pub const fn gyro(axis: usize) -> Self {
        Self(1 << (axis % 3))
    }

    /// One accelerometer: 0 x, 1 y, 2 z.
    #[must_use]
    pub const fn accelerometer(axis: usize) -> Self {
        Self(1 << (3 + axis % 3))
    }

    /// Union of both sets.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns whether a gyro is in the set.
    #[must_use]
    pub const fn has_gyro(self, axis: usize) -> bool {
        self.0 & Self::gyro(axis).0 != 0
    }

    /// Returns whether an accelerometer is in the set.
    #[must_use]
    pub const fn has_accelerometer(self, axis: usize) -> bool {
        self.0 & Self::accelerometer(axis).0 != 0
    }

    /// Returns whether only gyros are in the set.
    #[must_use]
    pub const fn gyros_only(self) -> bool {
        self.0 & Self::ACCELEROMETER.0 == 0
    }

    /// Returns whether only accelerometers are in the set.
    #[must_use]
    pub const fn accelerometers_only(self) -> bool {
        self.0 & Self::GYRO.0 == 0
    }

    /// Iterates over the channels of the set: 0 to 2 gyros, 3 to 5 accelerometers.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        (0..6).filter(move |channel| self.0 & (1 << channel) != 0)
    }
}
