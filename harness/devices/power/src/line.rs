//! Connection that carries lines of text: a TCP socket or a serial port.

use crate::PowerError;
use octant_base::address::{CONNECT_LIMIT, InstrumentAddress, InstrumentPort};
use octant_base::serial::SerialPort;
use std::fmt::Debug;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Ports of a supply. 5025 is the port that IANA lists as `scpi-raw`, where instruments take SCPI over a socket.
pub const POWER_PORT: InstrumentPort =
    InstrumentPort { default_port: Some(5025), default_baud: 9600 };

/// Longest reply that is read, bytes.
const REPLY_BYTES_MAX: usize = 4096;
/// Pause between two looks at a serial port.
const LOOK: Duration = Duration::from_millis(20);

/// Text of help for an argument that is a port of a supply.
#[must_use]
pub fn port_help() -> String {
    let ports = POWER_PORT.expected();
    format!("Port of a supply or of relays, {ports}, or a scenario with [power]")
}

fn address(port: &str) -> Result<InstrumentAddress, PowerError> {
    POWER_PORT.parse(port).map_err(PowerError::Address)
}

/// Checks that a text is a port of a supply, without opening it.
///
/// # Errors
/// If it is none.
pub fn check_power_port(port: &str) -> Result<(), PowerError> {
    address(port).map(drop)
}

/// Open port.
#[derive(Debug)]
enum Port {
    Tcp(TcpStream),
    Serial(SerialPort),
}

impl Port {
    fn set_wait(&mut self, wait: Duration) -> io::Result<()> {
        match self {
            // A socket takes a wait of zero for one without an end.
            Self::Tcp(stream) => {
                let wait = wait.max(Duration::from_millis(1));
                stream.set_read_timeout(Some(wait))?;
                stream.set_write_timeout(Some(wait))
            }
            Self::Serial(port) => {
                port.set_wait(wait);
                Ok(())
            }
        }
    }
}

impl Read for Port {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Tcp(stream) => stream.read(buffer),
            Self::Serial(port) => port.read(buffer),
        }
    }
}

impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Tcp(stream) => stream.write(bytes),
            Self::Serial(port) => port.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Tcp(stream) => stream.flush(),
            Self::Serial(port) => port.flush(),
        }
    }
}

/// Connection to an instrument, by lines that end with a line feed.
#[derive(Debug)]
pub(crate) struct Line {
    name: String,
    port: Port,
    /// Bytes received after the last whole line.
    rest: Vec<u8>,
    wait: Duration,
}

fn is_late(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

impl Line {
    /// Opens a port; `wait` is the time limit of a line in either direction.
    pub(crate) fn open(name: &str, wait: Duration) -> Result<Self, PowerError> {
        let address = address(name)?;
        let opened = match &address {
            InstrumentAddress::Tcp(address) => address.connect(CONNECT_LIMIT).map(Port::Tcp),
            InstrumentAddress::Serial(line) => {
                SerialPort::open(&line.path, line.baud).map(Port::Serial)
            }
        };
        let port = opened.map_err(|error| PowerError::Open {
            port: address.to_string(),
            reason: error.to_string(),
        })?;
        Ok(Self { name: name.to_owned(), port, rest: Vec::new(), wait })
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn wait(&self) -> Duration {
        self.wait
    }

    /// Opens a further handle that writes, while this one is in use.
    pub(crate) fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(match &self.port {
            Port::Tcp(stream) => Box::new(stream.try_clone()?),
            Port::Serial(port) => {
                let mut port = port.try_clone()?;
                port.set_wait(self.wait);
                Box::new(port)
            }
        })
    }

    fn gone(&self, reason: impl ToString) -> PowerError {
        PowerError::Gone { port: self.name.clone(), reason: reason.to_string() }
    }

    /// Drops input that nobody asked for, such as a reply that came too late.
    pub(crate) fn forget(&mut self) -> Result<(), PowerError> {
        self.rest.clear();
        let until = Instant::now() + self.wait;
        let mut buffer = [0; 256];
        while Instant::now() < until {
            self.port.set_wait(Duration::ZERO).map_err(|error| self.gone(error))?;
            match self.port.read(&mut buffer) {
                Ok(0) => return Err(self.gone("the other end closed the connection")),
                Ok(_) => {}
                Err(error) if is_late(&error) => return Ok(()),
                Err(error) => return Err(self.gone(error)),
            }
        }
        Err(self.gone("it sends without being asked"))
    }

    /// Sends a line.
    pub(crate) fn send(&mut self, text: &str) -> Result<(), PowerError> {
        let bytes = [text.as_bytes(), b"\n"].concat();
        self.port.set_wait(self.wait).map_err(|error| self.gone(error))?;
        let sent = self.port.write_all(&bytes).and_then(|()| self.port.flush());
        sent.map_err(|error| self.gone(error))
    }

    /// Receives a line without its end; `None`: none came in time.
    pub(crate) fn receive(&mut self) -> Result<Option<String>, PowerError> {
        let until = Instant::now() + self.wait;
        let mut buffer = [0; 256];
        loop {
            if let Some(end) = self.rest.iter().position(|byte| *byte == b'\n') {
                let line: Vec<u8> = self.rest.drain(..=end).collect();
                return Ok(Some(String::from_utf8_lossy(&line).trim().to_owned()));
            }
            if self.rest.len() > REPLY_BYTES_MAX {
                return Err(self.gone(format!("{REPLY_BYTES_MAX} bytes came without a line feed")));
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            self.port.set_wait(left).map_err(|error| self.gone(error))?;
            match self.port.read(&mut buffer) {
                Ok(0) if matches!(self.port, Port::Serial(_)) => std::thread::sleep(LOOK),
                Ok(0) => return Err(self.gone("the other end closed the connection")),
                Ok(count) => self.rest.extend_from_slice(&buffer[..count]),
                Err(error) if is_late(&error) => {}
                Err(error) => return Err(self.gone(error)),
            }
        }
    }
}
