//! UDP, with one frame in each datagram.

use super::{Bytes, PortError};
use crate::uri::Udp;
use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use std::time::Duration;

/// A UDP socket that listens to one peer at a time.
#[derive(Debug)]
pub struct UdpPort {
    uri: String,
    socket: UdpSocket,
    /// Peer that is answered. At the harness end it is always the one named in the URI.
    peer: Option<SocketAddr>,
    /// True while datagrams of others than the peer are dropped.
    held: bool,
    /// True at the device end, where a session binds the port to its peer.
    listens: bool,
    wait: Wait,
    /// Number of datagrams from strangers, all dropped.
    strangers: u64,
}

/// Present timeout of the socket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wait {
    Unknown,
    None,
    For(Duration),
}

impl UdpPort {
    /// Opens the harness end, which exchanges datagrams with one address only.
    ///
    /// # Errors
    /// If the address can't be resolved, or no port is free.
    pub fn connect(udp: &Udp) -> Result<Self, PortError> {
        let peer = resolve(udp)?;
        if peer.port() == 0 {
            let uri = crate::Uri::Udp(udp.clone());
            return Err(PortError::open(uri, "nobody listens at port 0, expected 1 to 65535"));
        }
        let near: IpAddr = match peer.ip() {
            IpAddr::V4(ip) if ip.is_loopback() => Ipv4Addr::LOCALHOST.into(),
            IpAddr::V4(_) => Ipv4Addr::UNSPECIFIED.into(),
            IpAddr::V6(ip) if ip.is_loopback() => Ipv6Addr::LOCALHOST.into(),
            IpAddr::V6(_) => Ipv6Addr::UNSPECIFIED.into(),
        };
        let uri = format!("udp:{peer}");
        let refused = |error: std::io::Error| PortError::open(&uri, error);
        let socket = UdpSocket::bind((near, 0)).map_err(refused)?;
        Ok(Self { peer: Some(peer), held: true, ..Self::of(socket, uri.clone()) })
    }

    /// Opens the device end, which listens; a session binds it to the peer that began it.
    ///
    /// # Errors
    /// If the address doesn't belong to this host, or the port is taken.
    pub fn listen(udp: &Udp) -> Result<Self, PortError> {
        let address = resolve(udp)?;
        let refused = |error: std::io::Error| PortError::open(format!("udp:{address}"), error);
        let socket = UdpSocket::bind(address).map_err(refused)?;
        let uri = format!("udp:{}", socket.local_addr().map_err(refused)?);
        Ok(Self { listens: true, ..Self::of(socket, uri) })
    }

    fn of(socket: UdpSocket, uri: String) -> Self {
        Self {
            uri,
            socket,
            peer: None,
            held: false,
            listens: false,
            wait: Wait::Unknown,
            strangers: 0,
        }
    }

    /// Number of datagrams that came from others than the peer, and were dropped.
    #[must_use]
    pub fn strangers(&self) -> u64 {
        self.strangers
    }

    fn gone(&self, error: &std::io::Error) -> PortError {
        PortError::gone(&self.uri, error)
    }

    fn waits(&mut self, wait: Duration) -> std::io::Result<()> {
        let wait = if wait.is_zero() { Wait::None } else { Wait::For(wait) };
        if wait != self.wait {
            match wait {
                Wait::None | Wait::Unknown => self.socket.set_nonblocking(true)?,
                Wait::For(wait) => {
                    if !matches!(self.wait, Wait::For(_)) {
                        self.socket.set_nonblocking(false)?;
                    }
                    self.socket.set_read_timeout(Some(wait))?;
                }
            }
            self.wait = wait;
        }
        Ok(())
    }
}

/// Resolves a host name; an empty one is loopback.
fn resolve(udp: &Udp) -> Result<SocketAddr, PortError> {
    if udp.host.is_empty() {
        return Ok((Ipv4Addr::LOCALHOST, udp.port).into());
    }
    let refused = |reason: String| PortError::open(crate::Uri::Udp(udp.clone()), reason);
    (udp.host.as_str(), udp.port)
        .to_socket_addrs()
        .map_err(|error| refused(error.to_string()))?
        .next()
        .ok_or_else(|| refused("the name stands for no address".to_owned()))
}

/// True for errors that concern the other end only, or nothing.
fn passes(error: &std::io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock
            | ErrorKind::TimedOut
            | ErrorKind::Interrupted
            // Nobody listens there at the moment: the sender notices by the silence.
            | ErrorKind::ConnectionRefused
            | ErrorKind::ConnectionReset
    )
}

impl Bytes for UdpPort {
    fn send(&mut self, bytes: &[u8], _: Duration) -> Result<bool, PortError> {
        let Some(peer) = self.peer else { return Ok(false) };
        match self.socket.send_to(bytes, peer) {
            Ok(count) => Ok(count == bytes.len()),
            Err(error) if passes(&error) => Ok(false),
            Err(error) => Err(self.gone(&error)),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        self.waits(wait).map_err(|error| self.gone(&error))?;
        match self.socket.recv_from(buffer) {
            Ok((count, from)) => {
                if self.held && self.peer != Some(from) {
                    self.strangers += 1;
                    return Ok(0);
                }
                self.peer = Some(from);
                Ok(count)
            }
            Err(error) if passes(&error) => Ok(0),
            Err(error) => Err(self.gone(&error)),
        }
    }

    fn datagrams(&self) -> bool {
        true
    }

    fn reached_at(&self) -> String {
        self.uri.clone()
    }

    fn hold_peer(&mut self, hold: bool) {
        if self.listens {
            self.held = hold;
        }
    }

    /// The socket stays open, and datagrams that arrive meanwhile are queued in it.
    fn close(&mut self) {}

    /// A network that is back needs no new socket.
    fn reopen(&mut self) -> Result<(), PortError> {
        Ok(())
    }
}
