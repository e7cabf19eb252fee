//! Tables of an export: their names, their columns, and the cells of a row.

use serde::Serialize;

/// Table of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Table {
    /// Outputs of the core, joined with encoders, truth and errors of the same epoch.
    Navigation,
    /// Inertial samples that reached the core, with the source's where a fault altered them.
    Samples,
    /// References that reached the core.
    Aiding,
    /// Estimated parameters with σ, and their errors where the true ones are known.
    Parameters,
    /// Normalized innovations squared of the measurements.
    Innovations,
    /// Onsets and ends of faults.
    Faults,
    /// All events.
    Events,
}

impl Table {
    /// All tables.
    pub const ALL: [Self; 7] = [
        Self::Navigation,
        Self::Samples,
        Self::Aiding,
        Self::Parameters,
        Self::Innovations,
        Self::Faults,
        Self::Events,
    ];

    /// Name on the command line, and of the table's file or variable.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Navigation => "navigation",
            Self::Samples => "samples",
            Self::Aiding => "aiding",
            Self::Parameters => "parameters",
            Self::Innovations => "innovations",
            Self::Faults => "faults",
            Self::Events => "events",
        }
    }

    /// Table of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|table| table.name() == name)
    }

    /// True if a coarser time step leaves out rows; events are never left out.
    #[must_use]
    pub const fn is_resampled(self) -> bool {
        !matches!(self, Self::Faults | Self::Events)
    }
}

/// Type of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CellKind {
    /// Double.
    Number,
    /// Whole number with 64 bits.
    Integer,
    /// Boolean.
    Boolean,
    /// UTF-8 text.
    Text,
}

/// Column of a table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Name, with the unit as its suffix.
    pub name: String,
    /// Unit; empty for counts, codes and texts.
    pub unit: &'static str,
    /// Type.
    pub kind: CellKind,
    /// Description: quantity, axes, sign.
    pub description: String,
}

impl Column {
    /// Creates a column.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        unit: &'static str,
        kind: CellKind,
        description: impl Into<String>,
    ) -> Self {
        Self { name: name.into(), unit, kind, description: description.into() }
    }
}

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// No value: null, or NaN where a format has no null.
    Empty,
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A boolean.
    Boolean(bool),
    /// A text.
    Text(String),
}

impl Cell {
    /// Number of a cell; NaN without one.
    #[must_use]
    pub fn as_f64(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Integer(number) => *number as f64,
            Self::Boolean(value) => f64::from(u8::from(*value)),
            Self::Empty | Self::Text(_) => f64::NAN,
        }
    }
}

impl From<f64> for Cell {
    /// A number that isn't finite is no value.
    fn from(number: f64) -> Self {
        if number.is_finite() { Self::Number(number) } else { Self::Empty }
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Empty, Self::from)
    }
}

impl From<u64> for Cell {
    /// A number beyond the range of the column is no value.
    fn from(number: u64) -> Self {
        i64::try_from(number).map_or(Self::Empty, Self::Integer)
    }
}

impl From<u32> for Cell {
    fn from(number: u32) -> Self {
        Self::Integer(i64::from(number))
    }
}

impl From<u16> for Cell {
    fn from(number: u16) -> Self {
        Self::Integer(i64::from(number))
    }
}

impl From<u8> for Cell {
    fn from(number: u8) -> Self {
        Self::Integer(i64::from(number))
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Self::Boolean(value)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}
