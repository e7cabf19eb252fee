//! Open ports: lines of bytes, datagrams, CAN frames.

mod exec;
mod listen;
mod pty;
#[doc(hidden)]
pub mod seal;
mod secret;
mod serial;
mod slcan;
mod tcp;
mod udp;
mod udp_stamps;

#[cfg(all(target_os = "linux", feature = "can"))]
#[doc(hidden)]
pub mod socket_can;

pub use exec::{ERROR_OUTPUT, ExecPort, StdioPort};
pub use listen::{HeardFrame, Listener};
pub use pty::Pty;
pub use serial::SerialLine;
pub use slcan::SlcanPort;
#[cfg(all(target_os = "linux", feature = "can"))]
pub use socket_can::{SocketCan, interface_bus};
pub use tcp::TcpPort;
pub use udp::UdpPort;

use crate::Uri;
use octant_faults::wire::Wired;
use octant_wire::EndRole;
use octant_wire::can::{BusFrame, CanVersion};
use std::fmt::Debug;
use std::time::{Duration, SystemTime};

/// Error of a port: it can't be opened, or went away.
#[derive(Debug, thiserror::Error)]
pub enum PortError {
    /// The port can't be opened.
    #[error("open {port}: {reason}")]
    Open {
        /// The port.
        port: String,
        /// Reason.
        reason: String,
    },
    /// The port was open and went away.
    #[error("{port} went away: {reason}")]
    Gone {
        /// The port.
        port: String,
        /// Reason.
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

/// A port that carries bytes: a line, or datagrams. The bytes of one call of [`Self::send`] are one
/// frame.
pub trait Bytes: Debug + Send {
    /// Sends all bytes within a time. False: the port did not accept them all, and those that it did
    /// are a piece of a frame.
    ///
    /// # Errors
    /// If the port is gone.
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError>;

    /// Receives at least one byte within a time; 0: nothing came. With a zero wait it returns at once.
    ///
    /// # Errors
    /// If the port is gone.
    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError>;

    /// True if [`Self::receive`] gives whole datagrams, not pieces of a line.
    fn datagrams(&self) -> bool;

    /// Name under which the other end reaches this port.
    fn reached_at(&self) -> String;

    /// Number of datagrams that don't have the seal of the [secret](crate::uri::Udp::secret), and were dropped.
    fn unsealed(&self) -> u64 {
        0
    }

    /// Binds the port to the peer that was heard last, for a session, or releases it. While it is
    /// bound, nobody else is heard.
    fn hold_peer(&mut self, hold: bool);

    /// Asks the kernel for the times at which data arrives. False: it has none for this port.
    fn stamp_arrivals(&mut self) -> bool {
        false
    }

    /// Time by the kernel's realtime clock at which the data of the last [`Self::receive`] arrived.
    fn arrived(&self) -> Option<SystemTime> {
        None
    }

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

/// An open port.
#[derive(Debug)]
pub enum Port {
    /// Bytes.
    Bytes(Box<dyn Bytes>),
    /// CAN frames.
    Frames(Box<dyn Frames>),
}

/// Opens a port for the end of a role. The device end of UDP and TCP listens, and only the device end creates a
/// pseudo terminal.
///
/// # Errors
/// If the port can't be opened.
pub fn open(uri: &Uri, role: EndRole) -> Result<Port, PortError> {
    match (uri, role) {
        (Uri::Serial(serial), _) => Ok(Port::Bytes(Box::new(SerialLine::open(serial)?))),
        (Uri::Pty { link }, EndRole::Device | EndRole::Instrument) => {
            Ok(Port::Bytes(Box::new(Pty::open(link)?)))
        }
        (Uri::Pty { .. }, EndRole::Harness) => Err(PortError::open(
            uri,
            "a new pseudo terminal has nobody at its other end; expected serial: with the terminal \
             that the device made",
        )),
        (Uri::Slcan(slcan), _) => Ok(Port::Frames(Box::new(SlcanPort::open(slcan)?))),
        (Uri::Udp(udp), EndRole::Harness) => Ok(Port::Bytes(Box::new(UdpPort::connect(udp)?))),
        (Uri::Udp(udp), _) => Ok(Port::Bytes(Box::new(UdpPort::listen(udp)?))),
        (Uri::Tcp(tcp), EndRole::Harness) => Ok(Port::Bytes(Box::new(TcpPort::connect(tcp)?))),
        (Uri::Tcp(tcp), _) => Ok(Port::Bytes(Box::new(TcpPort::listen(tcp)?))),
        (Uri::Exec(exec), EndRole::Harness) => Ok(Port::Bytes(Box::new(ExecPort::open(exec)?))),
        (Uri::Exec(_), _) => Err(PortError::open(
            uri,
            "it starts a device, and this is the device end; expected stdio:, tcp:, udp:, pty: or serial:",
        )),
        (Uri::Stdio, EndRole::Harness) => Err(PortError::open(
            uri,
            "it is the device end of exec:; expected exec: with the program",
        )),
        (Uri::Stdio, _) => Ok(Port::Bytes(Box::new(StdioPort::open()?))),
        (Uri::Can(can), role) => open_can(can, role),
    }
}

#[cfg(all(target_os = "linux", feature = "can"))]
fn open_can(can: &crate::uri::Can, role: EndRole) -> Result<Port, PortError> {
    Ok(Port::Frames(Box::new(SocketCan::open(can, role)?)))
}

#[cfg(not(all(target_os = "linux", feature = "can")))]
fn open_can(can: &crate::uri::Can, _: EndRole) -> Result<Port, PortError> {
    Err(PortError::open(Uri::Can(can.clone()), WITHOUT_CAN))
}

/// Reason why no CAN interface can be opened.
#[cfg(not(all(target_os = "linux", feature = "can")))]
const WITHOUT_CAN: &str = if cfg!(target_os = "linux") {
    "this program was built without CAN interfaces, expected one built with its default features, \
     or with --features octant/can, or slcan: with an adapter on a serial line"
} else {
    "CAN interfaces are part of Linux alone; expected slcan: with an adapter on a serial line"
};

/// Text that tells an operator how to reach a port.
#[must_use]
pub fn announcement(uri: &Uri, port: &Port) -> String {
    match port {
        Port::Bytes(bytes) => bytes.reached_at(),
        Port::Frames(_) => uri.to_string(),
    }
}
