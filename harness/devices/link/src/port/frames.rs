//! Ports that carry CAN frames, and what is heard on a bus.

use super::error::PortError;
use octant_faults::wire::Wired;
use octant_wire::can::{BusFrame, CanVersion};
use std::fmt::Debug;
use std::time::Duration;

/// Event on a CAN port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusEvent {
    /// A frame arrived.
    Frame(BusFrame),
    /// The controller reported a problem, or a foreign frame arrived.
    Trouble(BusTrouble),
}

/// Problem of a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BusTrouble {
    /// An error frame that is none of the following.
    ErrorFrame,
    /// Arbitration was lost; the controller sends again by itself.
    ArbitrationLost,
    /// A frame was not acknowledged: no other node is on the bus.
    NotAcknowledged,
    /// The controller reached its warning limit of errors.
    Warning,
    /// The controller is error-passive: it counted so many errors that it no longer signals errors of
    /// its own.
    Passive,
    /// The controller is bus-off.
    Off,
    /// The controller is back on the bus.
    Restarted,
    /// Frames were lost because they were not taken in time.
    Overrun,
    /// A frame that can't belong to this protocol arrived: remote, or with 29 bits.
    Foreign,
}

/// A port that carries CAN frames.
pub trait Frames: Debug + Send {
    /// Hands a frame to the controller within a time. False: the controller had no room.
    ///
    /// # Errors
    /// If the port is gone.
    fn send(&mut self, frame: &BusFrame, wait: Duration) -> Result<bool, PortError>;

    /// Receives the next event within a time. With a zero wait it returns at once.
    ///
    /// # Errors
    /// If the port is gone.
    fn receive(&mut self, wait: Duration) -> Result<Option<BusEvent>, PortError>;

    /// Format of the frames that it carries.
    fn format(&self) -> CanVersion;

    /// Tries to bring back a controller that left the bus. False: that is impossible from here; the
    /// controller comes back by itself or not at all.
    ///
    /// # Errors
    /// If the port is gone.
    fn restart(&mut self) -> Result<bool, PortError>;

    /// Closes the port, which is gone until it is opened again.
    fn close(&mut self);

    /// Opens the port again after it went away.
    ///
    /// # Errors
    /// If the port isn't back.
    fn reopen(&mut self) -> Result<(), PortError>;

    /// Fault injection of this port, if it has one.
    fn wired(&mut self) -> Option<&mut dyn Wired> {
        None
    }
}

/// A frame of any node.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct HeardFrame {
    /// Identifier.
    pub id: u32,
    /// True for an identifier of 29 bits.
    pub extended: bool,
    pub(super) length: u8,
    pub(super) bytes: [u8; 64],
}

impl HeardFrame {
    /// Creates a frame with at most 64 data bytes; more are left out.
    #[must_use]
    pub fn new(id: u32, extended: bool, data: &[u8]) -> Self {
        let mut bytes = [0; 64];
        let length = data.len().min(64);
        bytes[..length].copy_from_slice(&data[..length]);
        Self { id, extended, length: length as u8, bytes }
    }

    /// Data bytes.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }
}

impl std::fmt::Debug for HeardFrame {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:X}{}#{:02X?}", self.id, if self.extended { "x" } else { "" }, self.data())
    }
}
