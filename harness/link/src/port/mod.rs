//! Ports as they are: lines of bytes, datagrams, CAN frames.

mod listen;
mod pty;
mod serial;
mod slcan;
mod udp;

#[cfg(target_os = "linux")]
mod socket_can;

pub use listen::{Heard, Listener};
pub use pty::Pty;
pub use serial::SerialLine;
pub use slcan::Slcan;
#[cfg(target_os = "linux")]
pub use socket_can::{SocketCan, interface_bus};
pub use udp::UdpPort;

use crate::Uri;
use octant_faults::wire::Wired;
use octant_wire::Role;
use octant_wire::can::{Format, Frame};
use std::fmt::Debug;
use std::time::Duration;

/// Why a port can't be opened, or went away.
#[derive(Debug, thiserror::Error)]
pub enum PortError {
    /// It can't be opened.
    #[error("open {port}: {reason}")]
    Open {
        /// The port.
        port: String,
        /// Why.
        reason: String,
    },
    /// It was there and isn't any more.
    #[error("{port} went away: {reason}")]
    Gone {
        /// The port.
        port: String,
        /// What happened.
        reason: String,
    },
}

impl PortError {
    pub(crate) fn open(port: impl ToString, reason: impl ToString) -> Self {
        Self::Open { port: port.to_string(), reason: reason.to_string() }
    }

    pub(crate) fn gone(port: impl ToString, reason: impl ToString) -> Self {
        Self::Gone { port: port.to_string(), reason: reason.to_string() }
    }
}

/// A port that carries bytes: a line, or datagrams. What is sent in one call is one frame.
pub trait Bytes: Debug + Send {
    /// Hands over all bytes within a time. False: it did not take them all, and what it took is a
    /// piece of a frame.
    ///
    /// # Errors
    /// If the port is gone.
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError>;

    /// What has come, at least a byte, within a time; 0: nothing came. With no time it doesn't wait.
    ///
    /// # Errors
    /// If the port is gone.
    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError>;

    /// What [`Self::receive`] gives is a datagram, not a piece of a line.
    fn datagrams(&self) -> bool;

    /// The name by which the other end reaches it.
    fn reached_at(&self) -> String;

    /// A session begins with the peer that was heard last, or it ends: until then nobody else is
    /// heard.
    fn hold_peer(&mut self, hold: bool);

    /// Closes the port; until it is opened again it is gone.
    fn close(&mut self);

    /// Opens it again after it went away.
    ///
    /// # Errors
    /// If it isn't back.
    fn reopen(&mut self) -> Result<(), PortError>;

    /// Who does faults on it, where somebody does.
    fn wired(&mut self) -> Option<&mut dyn Wired> {
        None
    }
}

/// What a CAN port reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusEvent {
    /// A frame came.
    Frame(Frame),
    /// Something else did.
    Trouble(Trouble),
}

/// What can be wrong with a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trouble {
    /// An error frame that is none of the following.
    ErrorFrame,
    /// Arbitration was lost; the controller sends again by itself.
    ArbitrationLost,
    /// A frame was not acknowledged: nobody else is on the bus.
    NotAcknowledged,
    /// The controller has counted so many errors that it warns.
    Warning,
    /// The controller has counted so many errors that it only listens to those of others.
    Passive,
    /// The controller gave up and left the bus.
    Off,
    /// The controller is back on the bus.
    Restarted,
    /// Frames were lost because they were not taken in time.
    Overrun,
    /// A frame that can't be one of ours came: remote, or with 29 bits.
    Foreign,
}

/// A port that carries CAN frames.
pub trait Frames: Debug + Send {
    /// Hands a frame to the controller within a time. False: it had no room.
    ///
    /// # Errors
    /// If the port is gone.
    fn send(&mut self, frame: &Frame, wait: Duration) -> Result<bool, PortError>;

    /// What has come within a time. With no time it doesn't wait.
    ///
    /// # Errors
    /// If the port is gone.
    fn receive(&mut self, wait: Duration) -> Result<Option<BusEvent>, PortError>;

    /// Which frames it carries.
    fn format(&self) -> Format;

    /// The controller left the bus: tries to bring it back. False: it can't be done from here, and
    /// it comes back by itself or not.
    ///
    /// # Errors
    /// If the port is gone.
    fn restart(&mut self) -> Result<bool, PortError>;

    /// Closes the port; until it is opened again it is gone.
    fn close(&mut self);

    /// Opens it again after it went away.
    ///
    /// # Errors
    /// If it isn't back.
    fn reopen(&mut self) -> Result<(), PortError>;

    /// Who does faults on it, where somebody does.
    fn wired(&mut self) -> Option<&mut dyn Wired> {
        None
    }
}

/// An open port.
#[derive(Debug)]
pub enum Port {
    /// Bytes.
    Bytes(Box<dyn Bytes>),
    /// CAN frames.
    Frames(Box<dyn Frames>),
}

/// Opens a port. `role` is that of this end: the device end of UDP listens, and only it makes a
/// pseudo terminal.
///
/// # Errors
/// If it can't be opened.
pub fn open(uri: &Uri, role: Role) -> Result<Port, PortError> {
    match (uri, role) {
        (Uri::Serial(serial), _) => Ok(Port::Bytes(Box::new(SerialLine::open(serial)?))),
        (Uri::Pty { link }, Role::Device | Role::Instrument) => {
            Ok(Port::Bytes(Box::new(Pty::open(link)?)))
        }
        (Uri::Pty { .. }, Role::Harness) => Err(PortError::open(
            uri,
            "a new pseudo terminal has nobody at its other end; expected serial: with the terminal \
             that the device made",
        )),
        (Uri::Slcan(slcan), _) => Ok(Port::Frames(Box::new(Slcan::open(slcan)?))),
        (Uri::Udp(udp), Role::Harness) => Ok(Port::Bytes(Box::new(UdpPort::connect(udp)?))),
        (Uri::Udp(udp), _) => Ok(Port::Bytes(Box::new(UdpPort::listen(udp)?))),
        (Uri::Can(can), role) => open_can(can, role),
    }
}

#[cfg(target_os = "linux")]
fn open_can(can: &crate::uri::Can, role: Role) -> Result<Port, PortError> {
    Ok(Port::Frames(Box::new(SocketCan::open(can, role)?)))
}

#[cfg(not(target_os = "linux"))]
fn open_can(can: &crate::uri::Can, _: Role) -> Result<Port, PortError> {
    Err(PortError::open(
        Uri::Can(can.clone()),
        "CAN interfaces are part of Linux alone; expected slcan: with an adapter on a serial line",
    ))
}

/// What an end tells of its port to who wants to reach it.
#[must_use]
pub fn announcement(uri: &Uri, port: &Port) -> String {
    match (uri, port) {
        (Uri::Pty { .. } | Uri::Udp(_), Port::Bytes(bytes)) => bytes.reached_at(),
        _ => uri.to_string(),
    }
}
