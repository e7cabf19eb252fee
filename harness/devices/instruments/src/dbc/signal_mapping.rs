//! Mapping of signals to channels.

use super::DbcProblem;
use octant_toml_tree::error::Place;
use std::string::{String, ToString};
use std::vec::Vec;

/// Three signals.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Three {
    /// Signal of the unit's x axis, `Message.signal`, with a minus if it points the other way.
    pub x: String,
    /// Signal of y.
    pub y: String,
    /// Signal of z.
    pub z: String,
    /// Unit, if the database has none.
    pub unit: Option<String>,
    /// Factor of the values, beside their unit.
    pub scale: Option<f64>,
}

/// Two signals with angles of the gimbals.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GimbalSignals {
    /// Signal of the inner gimbal.
    pub azimuth: String,
    /// Signal of the outer gimbal.
    pub roll: String,
    /// Unit, if the database has none.
    pub unit: Option<String>,
}

/// One signal.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct One {
    /// The signal.
    pub signal: String,
    /// Unit, if the database has none.
    pub unit: Option<String>,
}

/// A signal that tells whether a reading is valid.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Valid {
    /// The signal.
    pub signal: String,
    /// Value of the signal for a valid reading.
    pub equals: u64,
}

/// Mapping of signals to channels.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignalMapping {
    /// Name of its file, for messages.
    #[serde(skip)]
    pub file: String,
    /// Rotation: increments or rates.
    pub rotation: Three,
    /// Velocity increments or specific force.
    pub velocity: Three,
    /// Angles of the gimbals.
    pub gimbal: Option<GimbalSignals>,
    /// Counter of the readings; it may roll over.
    pub sequence: Option<One>,
    /// Time of the unit at the end of the interval; it may roll over.
    pub stamp: Option<One>,
    /// Length of the interval.
    pub interval: Option<One>,
    /// Temperature of the unit.
    pub temperature: Option<One>,
    /// Validity of the reading.
    pub valid: Option<Valid>,
    /// Order of the messages of a reading; by default, that of their identifiers.
    pub order: Option<Vec<String>>,
    /// Signals that are equal in all messages of a reading.
    #[serde(default)]
    pub counters: Vec<String>,
}

impl SignalMapping {
    /// Parses a mapping; `file` is its name in messages.
    ///
    /// # Errors
    /// If the text is no mapping, with file, line and key.
    pub fn parse(file: &str, text: &str) -> Result<Self, DbcProblem> {
        let mapping: Self = octant_toml_tree::read_as(text).map_err(|problem| {
            let place = match problem.place {
                Place::File { line, .. } => std::format!("{file}:{line}"),
                _ => file.into(),
            };
            DbcProblem { place, what: problem.message.trim().to_string() }
        })?;
        Ok(Self { file: file.into(), ..mapping })
    }
}
