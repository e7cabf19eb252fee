//! Lines of JSON between the run that drives a table and its guests.

use serde::{Deserialize, Serialize};

/// Version of the lines.
pub(super) const VERSION: u32 = 1;

/// A line of the driving run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum HostWord {
    /// First of all lines.
    Table { version: u32, units: usize },
    /// The guest isn't taken.
    Refused(String),
    /// Everybody is there: the runs begin.
    Go,
    /// A look at the table.
    Look(SharedLook),
    /// The table was stopped, for this reason.
    Stopped(String),
    /// The driving run has ended in order.
    End,
}

/// A look at the table, with the set point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SharedLook {
    /// Azimuth and roll.
    pub(super) axes: [SharedAxis; 2],
    /// Set point of both, counts; none before the first.
    pub(super) target: Option<[i32; 2]>,
}

/// A look at an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SharedAxis {
    pub(super) at_ns: Option<u64>,
    pub(super) within_ns: u64,
    pub(super) angle_rad: f64,
    pub(super) rate_radps: Option<f64>,
}

/// A line of a guest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum GuestWord {
    /// Its run has all its samples.
    Done,
    /// Its run ends without them, for this reason.
    Left(String),
}

/// Writes a line.
pub(super) fn line<T: Serialize>(word: &T) -> Vec<u8> {
    let mut line = serde_json::to_vec(word).unwrap_or_default();
    line.push(b'\n');
    line
}
