//! Device and traffic of a run over a wire.

use serde::{Deserialize, Serialize};

/// Device and traffic of a run over a wire.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinkRecord {
    /// Arbitrations lost on a bus.
    pub arbitration_lost: u64,
    /// Total time that the port was away, s.
    pub away_s: f64,
    /// Share of a bus's time that frames took; null on other ports.
    pub bus_load: Option<f64>,
    /// Times that the port was off the bus.
    pub bus_off: u64,
    /// True if both ends compared their configurations.
    pub configuration_compared: bool,
    /// Damaged messages.
    pub damaged: u64,
    /// Name of the device.
    pub device: String,
    /// Answers received a second time.
    pub doubled: u64,
    /// Error frames on a bus.
    pub error_frames: u64,
    /// Times that the port was error passive.
    pub error_passive: u64,
    /// Firmware of the device.
    pub firmware: String,
    /// Lost messages.
    pub lost: u64,
    /// Missing messages.
    pub missing: u64,
    /// Messages that could not be sent.
    pub not_sent: u64,
    /// Messages out of order.
    pub out_of_order: u64,
    /// Pacing of the steps.
    pub pacing: String,
    /// URI of the port.
    pub port: String,
    /// Messages received.
    pub received: u64,
    /// Times that the port went away and came back.
    pub reconnected: u32,
    /// Requests that were sent again.
    pub repeated: u64,
    /// Restarts of a bus's controller.
    pub restarted: u64,
    /// Messages sent.
    pub sent: u64,
    /// Unreadable messages.
    pub unreadable: u64,
    /// Host time of the run, s.
    pub wall_s: f64,
}
