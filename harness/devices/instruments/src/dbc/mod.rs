//! Any inertial unit on a CAN bus, by its database (DBC) and a mapping.
//!
//! A [`Database`] is the maker's DBC file. A [`SignalMapping`] assigns its signals to channels, in TOML:
//!
//! ```toml
//! rotation = { x = "Gyro.rate_x", y = "Gyro.rate_y", z = "-Gyro.rate_z", unit = "deg/s" }
//! velocity = { x = "Accel.a_x", y = "Accel.a_y", z = "-Accel.a_z" }
//! sequence = { signal = "Gyro.counter" }
//! stamp = { signal = "Gyro.time", unit = "us" }
//! counters = ["Gyro.counter", "Accel.counter"]
//! ```
//!
//! A signal is `Message.signal`; a minus before it reverses the axis. A unit is needed if the database
//! has none, and must not contradict it. Angles and velocities are increments, rates and accelerations
//! means.
//!
//! A reading is complete when each of its messages has arrived, once and in order: that of `order`, or
//! of the identifiers, in which a bus delivers messages that are queued together. A missing message
//! costs the reading. If all messages have a counter (`counters`), no reading mixes two samples.

mod database;
mod gather;
mod signal;
mod signal_mapping;

pub use database::Database;
pub use gather::{CanCounters, CanFrame, Gatherer};
pub use signal_mapping::{GimbalSignals, One, SignalMapping, Three, Valid};

use std::string::String;

/// Error in a database or a mapping.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct DbcProblem {
    /// File with line, or key of the mapping.
    pub place: String,
    /// Error, with the expected form.
    pub what: String,
}
