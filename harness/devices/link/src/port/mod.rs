//! Open ports: lines of bytes, datagrams, CAN frames.

mod bytes;
mod error;
mod exec;
mod frames;
mod listen;
mod pty;
#[doc(hidden)]
pub mod seal;
mod serial;
mod slcan;
mod tcp;
mod udp;
mod udp_stamps;

#[cfg(all(target_os = "linux", feature = "can"))]
#[doc(hidden)]
pub mod socket_can;

pub use bytes::Bytes;
pub use error::PortError;
pub use exec::{ERROR_OUTPUT, ExecPort, StdioPort};
pub use frames::{BusEvent, BusTrouble, Frames, HeardFrame};
pub use listen::Listener;
pub use pty::Pty;
pub use serial::SerialLine;
pub use slcan::SlcanPort;
#[cfg(all(target_os = "linux", feature = "can"))]
pub use socket_can::{SocketCan, interface_bus};
pub use tcp::TcpPort;
pub use udp::UdpPort;

use crate::Uri;
#[cfg(not(all(target_os = "linux", feature = "can")))]
use error::WITHOUT_CAN;
use octant_wire::EndRole;

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
        (Uri::Tcp(tcp), _) if tcp.listen => Err(PortError::open(
            uri,
            "listen is for an instrument that connects to this host, expected tcp:HOST:PORT alone",
        )),
        (Uri::Tcp(tcp), EndRole::Harness) => {
            Ok(Port::Bytes(Box::new(TcpPort::connect(&tcp.address)?)))
        }
        (Uri::Tcp(tcp), _) => Ok(Port::Bytes(Box::new(TcpPort::listen(&tcp.address)?))),
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

/// Opens the port of an instrument that sends on its own. An instrument on TCP, or the server of its serial line, is
/// connected to, unless the URI says that it connects itself; on UDP this host listens.
///
/// # Errors
/// If the port can't be opened.
pub fn open_instrument(uri: &Uri) -> Result<Port, PortError> {
    match uri {
        Uri::Tcp(tcp) if tcp.listen => Ok(Port::Bytes(Box::new(TcpPort::listen(&tcp.address)?))),
        Uri::Tcp(tcp) => Ok(Port::Bytes(Box::new(TcpPort::connect(&tcp.address)?))),
        other => open(other, EndRole::Device),
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

/// Text that tells an operator how to reach a port.
#[must_use]
pub fn announcement(uri: &Uri, port: &Port) -> String {
    match port {
        Port::Bytes(bytes) => bytes.reached_at(),
        Port::Frames(_) => uri.to_string(),
    }
}
