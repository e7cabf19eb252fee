//! TCP, as a line of bytes: for programs that have sockets and no datagrams.

use super::bytes::Bytes;
use super::error::PortError;
use crate::uri::HostPort;
use octant_base::address::CONNECT_LIMIT;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

/// Time between two looks for a connection at the device end.
const LOOK: Duration = Duration::from_millis(5);
/// Time that a connection without a session has at the device end, before it gives way to one that waits.
const IDLE: Duration = Duration::from_secs(2);

/// A TCP connection: made by the harness, accepted by the device, one at a time.
#[derive(Debug)]
pub struct TcpPort {
    uri: String,
    tcp: HostPort,
    /// At the device end.
    listener: Option<TcpListener>,
    /// `None` while nobody is connected.
    stream: Option<TcpStream>,
    /// Present timeout of reading; `None`: not known.
    wait: Option<Duration>,
    /// True while a session has the connection.
    held: bool,
    /// Time at which the connection was made, or its session ended.
    idle_since: Instant,
    /// Number of connections that were made.
    connections: u64,
}

impl TcpPort {
    /// Connects the harness end.
    ///
    /// # Errors
    /// If nobody listens there.
    pub fn connect(tcp: &HostPort) -> Result<Self, PortError> {
        let uri = format!("tcp:{tcp}");
        let stream = tcp.connect(CONNECT_LIMIT).map_err(|error| PortError::open(&uri, error))?;
        Ok(Self { stream: Some(stream), connections: 1, ..Self::of(uri, tcp) })
    }

    /// Listens at the device end.
    ///
    /// # Errors
    /// If the address doesn't belong to this host, or the port is taken.
    pub fn listen(tcp: &HostPort) -> Result<Self, PortError> {
        let name = format!("tcp:{tcp}");
        let refused = |error: std::io::Error| PortError::open(&name, error);
        let addresses = tcp.resolve(CONNECT_LIMIT).map_err(refused)?;
        let listener = TcpListener::bind(&*addresses).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let uri = format!("tcp:{}", listener.local_addr().map_err(refused)?);
        Ok(Self { listener: Some(listener), ..Self::of(uri, tcp) })
    }

    fn of(uri: String, tcp: &HostPort) -> Self {
        Self {
            uri,
            tcp: tcp.clone(),
            listener: None,
            stream: None,
            wait: None,
            held: false,
            idle_since: Instant::now(),
            connections: 0,
        }
    }

    fn gone(&self, reason: impl ToString) -> PortError {
        PortError::gone(&self.uri, reason)
    }

    /// Waits for a connection at the device end; true if there is one.
    fn accept(&mut self, wait: Duration) -> Result<bool, PortError> {
        let until = Instant::now() + wait;
        loop {
            let Some(listener) = &self.listener else { return Ok(false) };
            match listener.accept() {
                Ok((stream, _)) => {
                    set_up(&stream).map_err(|error| self.gone(error))?;
                    (self.stream, self.wait) = (Some(stream), None);
                    self.idle_since = Instant::now();
                    self.connections += 1;
                    return Ok(true);
                }
                Err(error) if passes(&error) => {}
                Err(error) => return Err(self.gone(error)),
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(false);
            }
            std::thread::sleep(left.min(LOOK));
        }
    }

    /// Notes that the other end closed the connection: the device waits for the next one.
    fn hung_up(&mut self, reason: impl ToString) -> Result<(), PortError> {
        (self.stream, self.wait) = (None, None);
        if self.listener.is_some() { Ok(()) } else { Err(self.gone(reason)) }
    }
}

/// Sends small frames at once.
fn set_up(stream: &TcpStream) -> std::io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)
}

/// True for errors that only mean that nothing came.
fn passes(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

impl Bytes for TcpPort {
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError> {
        let Some(stream) = &mut self.stream else { return Ok(false) };
        let sent = stream
            .set_write_timeout(Some(wait.max(Duration::from_millis(1))))
            .and_then(|()| stream.write_all(bytes));
        match sent {
            Ok(()) => Ok(true),
            Err(error) if passes(&error) => Ok(false),
            Err(error) => self.hung_up(error).map(|()| false),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        if self.stream.is_none() {
            if self.listener.is_none() {
                return Err(self.gone("it is closed"));
            }
            self.accept(wait)?;
            return Ok(0);
        }
        if self.listener.is_some() && !self.held && self.idle_since.elapsed() >= IDLE {
            // One that waits takes its place; without one it stays.
            self.accept(Duration::ZERO)?;
        }
        let known = self.wait == Some(wait);
        let Some(stream) = &mut self.stream else { return Ok(0) };
        let read = (if known {
            Ok(())
        } else if wait.is_zero() {
            stream.set_nonblocking(true)
        } else {
            stream.set_nonblocking(false).and_then(|()| stream.set_read_timeout(Some(wait)))
        })
        .and_then(|()| stream.read(buffer));
        self.wait = Some(wait);
        if wait.is_zero()
            && let Some(stream) = &self.stream
        {
            // Sending waits again.
            stream.set_nonblocking(false).map_err(|error| self.gone(error))?;
            self.wait = None;
        }
        match read {
            Ok(0) => self.hung_up("the other end closed the connection").map(|()| 0),
            Ok(count) => Ok(count),
            Err(error) if passes(&error) => Ok(0),
            Err(error) => self.hung_up(error).map(|()| 0),
        }
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn connections(&self) -> u64 {
        self.connections
    }

    fn reached_at(&self) -> String {
        self.uri.clone()
    }

    /// A connection has only one other end: while it is held, it gives way to no other.
    fn hold_peer(&mut self, hold: bool) {
        (self.held, self.idle_since) = (hold, Instant::now());
    }

    fn close(&mut self) {
        (self.stream, self.wait) = (None, None);
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        if self.listener.is_none() {
            let connections = self.connections + 1;
            *self = Self { connections, ..Self::connect(&self.tcp)? };
        }
        Ok(())
    }
}
