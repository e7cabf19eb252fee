//! Variables of FMUs: ports of channels, settings, codes.

use crate::error::{Place, Problem};

/// Place of an entry in a scenario, for messages after its reading.
///
/// Two scenarios that differ only in it are equal.
#[derive(Clone)]
pub struct EntryPlace {
    /// Place.
    pub place: Place,
    /// Dotted path of the key.
    pub path: String,
}

impl PartialEq for EntryPlace {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

impl std::fmt::Debug for EntryPlace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Written")
    }
}

impl EntryPlace {
    /// Makes a problem of this entry.
    #[must_use]
    pub fn problem(&self, message: impl Into<String>) -> Problem {
        Problem { place: self.place.clone(), path: self.path.clone(), message: message.into() }
    }
}

/// One or all elements of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelElement {
    /// Variable or constant.
    pub what: Made,
    /// Place of the entry.
    pub at: EntryPlace,
}

/// Origin of a channel's element.
#[derive(Clone, Debug, PartialEq)]
pub enum Made {
    /// A variable of the FMU.
    Variable {
        /// Name; a minus sign before it negates the value.
        name: String,
        /// Unit, if the description doesn't give it.
        unit: Option<String>,
        /// Value in the unit = scale · value of the variable.
        scale: f64,
    },
    /// A constant, SI.
    Constant(f64),
}

/// A setting of an FMU's variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Name of the variable.
    pub name: String,
    /// Values of the elements; one for a scalar.
    pub values: Vec<Set>,
    /// Place of the entry.
    pub at: EntryPlace,
}

/// One value.
#[derive(Clone, Debug, PartialEq)]
pub enum Set {
    /// A number in the variable's own unit.
    Number(f64),
    /// A whole number beyond 2⁵³, which f64 may not have.
    Whole(i128),
    /// True or false.
    Flag(bool),
    /// A text, the name of an enumeration's item, or a quantity.
    Text(String),
}

/// A value of a variable that stands for a mode.
#[derive(Clone, Debug, PartialEq)]
pub enum Code {
    /// The number.
    Number(i64),
    /// The name of an enumeration's item.
    Name(String),
}
