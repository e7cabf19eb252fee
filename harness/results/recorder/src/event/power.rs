//! The supply or the relay of a device, and each of its switchings.

use serde::{Deserialize, Serialize};

/// The supply or the relay of a device in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PowerRecord {
    /// Current limit, A; null for a relay.
    pub current_limit_a: Option<f64>,
    /// Voltage dips.
    pub dips: u32,
    /// State in the end; null if it could not be read.
    pub end: Option<PowerReadingRecord>,
    /// Reply of the instrument to `*IDN?`.
    pub identity: String,
    /// The channel or the relay.
    pub outlet: String,
    /// Port of the instrument.
    pub port: String,
    /// Dips in which the device kept its session.
    pub ridden_through: u32,
    /// All switchings, in order.
    pub switchings: Vec<SwitchingRecord>,
    /// Voltage, V; null for a relay.
    pub voltage_v: Option<f64>,
}

/// One switching.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SwitchingRecord {
    /// State after, when the voltage had settled.
    pub after: PowerReadingRecord,
    /// Time of the host at which the command was sent, UTC.
    pub at: String,
    /// State before.
    pub before: PowerReadingRecord,
    /// Command that switched.
    pub command: String,
    /// Number of the sample before which it happened, from 1; null: before the first or after the last.
    pub sample: Option<u64>,
}

/// State of an output, as the instrument measured it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PowerReadingRecord {
    /// Current, A; null for a relay.
    pub current_a: Option<f64>,
    /// True if it is on.
    pub on: bool,
    /// Voltage, V; null for a relay.
    pub voltage_v: Option<f64>,
}
