//! Connection that carries lines of text: a TCP socket or a serial port.

use crate::PowerError;
use octant_base::serial::SerialPort;
use std::fmt::Debug;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Port that IANA lists as `scpi-raw`, where instruments take SCPI over a socket.
const SCPI_RAW: u16 = 5025;
/// Default rate of a serial port, bit/s.
const BAUD: u32 = 9600;
/// Longest reply that is read, bytes.
const REPLY_BYTES_MAX: usize = 4096;
/// Longest time for making a connection.
const CONNECT: Duration = Duration::from_secs(5);
/// Pause between two looks at a serial port.
const LOOK: Duration = Duration::from_millis(20);

/// Address of an instrument.
#[derive(Debug, PartialEq, Eq)]
enum Address<'a> {
    /// Host and port.
    Tcp(&'a str, u16),
    /// Device and rate, bit/s.
    Serial(&'a str, u32),
}

fn address(port: &str) -> Result<Address<'_>, PowerError> {
    let wrong =
        |reason: &str| PowerError::Address { port: port.to_owned(), reason: reason.to_owned() };
    if let Some(rest) = port.strip_prefix("tcp:") {
        // The colons of an IPv6 address are in brackets.
        let (host, number) = match rest.strip_prefix('[') {
            Some(rest) => {
                let (host, after) = rest.split_once(']').ok_or_else(|| wrong("without `]`"))?;
                (host, after.strip_prefix(':').or(after.is_empty().then_some("")))
            }
            None => match rest.split_once(':') {
                None => (rest, Some("")),
                Some((host, number)) => (host, Some(number).filter(|number| !number.is_empty())),
            },
        };
        let number = match number {
            Some("") => Some(SCPI_RAW),
            Some(text) => text.parse().ok().filter(|number| *number > 0),
            None => None,
        };
        let number = number.ok_or_else(|| wrong("whose number is none from 1 to 65535"))?;
        if host.is_empty() {
            return Err(wrong("without a host"));
        }
        return Ok(Address::Tcp(host, number));
    }
    let Some(rest) = port.strip_prefix("serial:") else {
        return Err(wrong("which begins with neither tcp: nor serial:"));
    };
    let (device, baud) = match rest.split_once('?') {
        None => (rest, BAUD),
        Some((device, option)) => {
            let rate = option.strip_prefix("baud=").and_then(|rate| rate.parse().ok());
            let rate = rate.filter(|rate| *rate > 0);
            (device, rate.ok_or_else(|| wrong("whose option isn't baud=RATE"))?)
        }
    };
    if device.is_empty() {
        return Err(wrong("without a device"));
    }
    Ok(Address::Serial(device, baud))
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
        let failed = |reason: String| PowerError::Open { port: name.to_owned(), reason };
        let port = match address(name)? {
            Address::Tcp(host, number) => Port::Tcp(connected(host, number).map_err(failed)?),
            Address::Serial(device, baud) => {
                let port = SerialPort::open(device, baud);
                Port::Serial(port.map_err(|error| failed(error.to_string()))?)
            }
        };
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

fn connected(host: &str, number: u16) -> Result<TcpStream, String> {
    let mut reason = "the name has no address".to_owned();
    let found = (host, number).to_socket_addrs().map_err(|error| error.to_string())?;
    for address in found {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => {
                stream.set_nodelay(true).map_err(|error| error.to_string())?;
                return Ok(stream);
            }
            Err(error) => reason = error.to_string(),
        }
    }
    Err(reason)
}
