//! UDP, with one frame in each datagram.

use super::bytes::Bytes;
use super::error::PortError;
use super::seal::{OpenedSeal, SEAL_LEN, Seal, SealEnd, secret_in};
use super::udp_stamps::ArrivalStamps;
use crate::uri::Udp;
use octant_base::address::CONNECT_LIMIT;
use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::{Duration, SystemTime};

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
    sealed: Option<Box<Sealed>>,
    /// The kernel's times of arrival, once they were asked for.
    stamps: Option<ArrivalStamps>,
}

/// Room of a datagram: more than any frame needs.
const DATAGRAM: usize = 4096;

/// Datagrams with a seal.
#[derive(Debug)]
struct Sealed {
    seal: Seal,
    /// File with the secret, as the other end has to be told.
    file: String,
    received: [u8; DATAGRAM],
    /// Frames that were sent last, and room for their seal.
    sent: [u8; DATAGRAM],
    sent_len: usize,
    /// Number of datagrams without the secret's seal.
    unsealed: u64,
}

impl Sealed {
    fn of(end: SealEnd, udp: &Udp) -> Result<Option<Box<Self>>, PortError> {
        let Some(file) = &udp.secret else { return Ok(None) };
        let refused = |reason: String| PortError::open(crate::Uri::Udp(udp.clone()), reason);
        let seal = secret_in(file).and_then(|secret| {
            Seal::new(end, &secret).ok_or_else(|| format!("the secret in {file} is no key"))
        });
        Ok(Some(Box::new(Self {
            seal: seal.map_err(refused)?,
            file: file.clone(),
            received: [0; DATAGRAM],
            sent: [0; DATAGRAM],
            sent_len: 0,
            unsealed: 0,
        })))
    }

    /// The datagram that was kept, sealed anew.
    fn datagram(&mut self) -> &[u8] {
        let datagram = &mut self.sent[..self.sent_len + SEAL_LEN];
        self.seal.seal(datagram);
        datagram
    }
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
        let sealed = Sealed::of(SealEnd::Harness, udp)?;
        let refused = |error: std::io::Error| PortError::open(&uri, error);
        let socket = UdpSocket::bind((near, 0)).map_err(refused)?;
        Ok(Self { peer: Some(peer), held: true, sealed, ..Self::of(socket, uri.clone()) })
    }

    /// Opens the device end, which listens; a session binds it to the peer that began it.
    ///
    /// # Errors
    /// If the address doesn't belong to this host, or the port is taken.
    pub fn listen(udp: &Udp) -> Result<Self, PortError> {
        let address = resolve(udp)?;
        let sealed = Sealed::of(SealEnd::Device, udp)?;
        let refused = |error: std::io::Error| PortError::open(format!("udp:{address}"), error);
        let socket = UdpSocket::bind(address).map_err(refused)?;
        let uri = format!("udp:{}", socket.local_addr().map_err(refused)?);
        Ok(Self { listens: true, sealed, ..Self::of(socket, uri) })
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
            sealed: None,
            stamps: None,
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

/// Resolves the address; an empty host is loopback.
fn resolve(udp: &Udp) -> Result<SocketAddr, PortError> {
    let refused = |reason: String| PortError::open(crate::Uri::Udp(udp.clone()), reason);
    let found = udp.address.resolve(CONNECT_LIMIT).map_err(|error| refused(error.to_string()))?;
    found.first().copied().ok_or_else(|| refused("the host has no address".to_owned()))
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

/// Frames of a datagram that is sealed for this end. What is sealed otherwise is answered as far as both ends need it to
/// get to know each other.
fn opened<'a>(
    sealed: &'a mut Sealed,
    count: usize,
    socket: &UdpSocket,
    from: SocketAddr,
) -> Option<&'a [u8]> {
    // An answer that can't be sent now is asked for again.
    match sealed.seal.open(&sealed.received[..count]) {
        OpenedSeal::Frames(length) => return Some(&sealed.received[..length]),
        OpenedSeal::Learnt => {
            let _ = socket.send_to(sealed.datagram(), from);
        }
        OpenedSeal::Unknown => {
            sealed.unsealed += 1;
            let _ = socket.send_to(&sealed.seal.challenge(&sealed.received[..count]), from);
        }
        OpenedSeal::Dropped => sealed.unsealed += 1,
    }
    None
}

impl Bytes for UdpPort {
    fn send(&mut self, bytes: &[u8], _: Duration) -> Result<bool, PortError> {
        let Some(peer) = self.peer else { return Ok(false) };
        let datagram = match &mut self.sealed {
            None => bytes,
            Some(sealed) => {
                let Some(room) = sealed.sent[..DATAGRAM - SEAL_LEN].get_mut(..bytes.len()) else {
                    return Ok(false);
                };
                room.copy_from_slice(bytes);
                sealed.sent_len = bytes.len();
                sealed.datagram()
            }
        };
        match self.socket.send_to(datagram, peer) {
            Ok(count) => Ok(count == datagram.len()),
            Err(error) if passes(&error) => Ok(false),
            Err(error) => Err(self.gone(&error)),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        self.waits(wait).map_err(|error| self.gone(&error))?;
        let into = self.sealed.as_mut().map_or(&mut *buffer, |sealed| &mut sealed.received);
        let received = match &mut self.stamps {
            None => self.socket.recv_from(into),
            Some(stamps) => stamps.receive(&self.socket, into),
        };
        match received {
            Ok((count, from)) => {
                if self.held && self.peer != Some(from) {
                    self.strangers += 1;
                    return Ok(0);
                }
                let count = match &mut self.sealed {
                    None => count,
                    Some(sealed) => {
                        let Some(frames) = opened(sealed, count, &self.socket, from) else {
                            return Ok(0);
                        };
                        let taken = frames.len().min(buffer.len());
                        buffer[..taken].copy_from_slice(&frames[..taken]);
                        taken
                    }
                };
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
        match &self.sealed {
            None => self.uri.clone(),
            Some(sealed) => format!("{}?secret={}", self.uri, sealed.file),
        }
    }

    fn unsealed(&self) -> u64 {
        self.sealed.as_ref().map_or(0, |sealed| sealed.unsealed)
    }

    fn hold_peer(&mut self, hold: bool) {
        if self.listens {
            self.held = hold;
        }
    }

    fn stamp_arrivals(&mut self) -> bool {
        self.stamps = ArrivalStamps::of(&self.socket);
        self.stamps.is_some()
    }

    fn arrived(&self) -> Option<SystemTime> {
        self.stamps.as_ref()?.arrived()
    }

    /// The socket stays open, and datagrams that arrive meanwhile are queued in it.
    fn close(&mut self) {}

    /// A network that is back needs no new socket.
    fn reopen(&mut self) -> Result<(), PortError> {
        Ok(())
    }
}
