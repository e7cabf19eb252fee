//! Serial lines.

use super::bytes::Bytes;
use super::error::PortError;
use crate::Uri;
use crate::uri::SerialAddress;
use octant_base::serial::SerialPort;
use std::io::{ErrorKind, Read, Write};
use std::time::Duration;

/// A serial line: 8 data bits, no parity, 1 stop bit, no flow control, opened exclusively.
pub struct SerialLine {
    serial: SerialAddress,
    uri: String,
    /// `None` while the line is closed.
    port: Option<SerialPort>,
}

impl std::fmt::Debug for SerialLine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SerialLine").field("uri", &self.uri).finish_non_exhaustive()
    }
}

impl SerialLine {
    /// Opens the line exclusively.
    ///
    /// # Errors
    /// If the port isn't there or is in use, or if its driver sets another rate than requested.
    pub fn open(serial: &SerialAddress) -> Result<Self, PortError> {
        let uri = Uri::Serial(serial.clone()).to_string();
        let port = open(serial).map_err(|error| PortError::open(&uri, explain(&error)))?;
        Ok(Self { serial: serial.clone(), uri, port: Some(port) })
    }
}

/// Number of times that a port is tried that another program has, and the time between them.
const TRIES: u32 = 10;
const BETWEEN: Duration = Duration::from_millis(50);

/// Opens a port. A process that was just started holds what was open in this one until it runs its program: a port that
/// has just been closed may be held for some milliseconds.
fn open(serial: &SerialAddress) -> std::io::Result<SerialPort> {
    let mut tries = TRIES;
    loop {
        tries -= 1;
        match SerialPort::open(&serial.path, serial.baud) {
            Err(error)
                if tries > 0
                    && matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::ResourceBusy) =>
            {
                std::thread::sleep(BETWEEN);
            }
            result => return result,
        }
    }
}

/// Error text with a remedy for the user.
fn explain(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::PermissionDenied => {
            format!("{error}; on Linux the user has to be in the group of the port, often dialout")
        }
        ErrorKind::NotFound => {
            format!("{error}; expected a serial port that is there, and that no other program has")
        }
        ErrorKind::WouldBlock | ErrorKind::ResourceBusy => {
            format!("{error}; another program has it")
        }
        _ => error.to_string(),
    }
}

impl Bytes for SerialLine {
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError> {
        match &mut self.port {
            Some(port) => write(port, &self.uri, bytes, wait),
            None => Err(closed(&self.uri)),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        match &mut self.port {
            Some(port) => read(port, &self.uri, buffer, wait),
            None => Err(closed(&self.uri)),
        }
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn reached_at(&self) -> String {
        self.uri.clone()
    }

    /// A line has only one other end.
    fn hold_peer(&mut self, _: bool) {}

    fn close(&mut self) {
        self.port = None;
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        // The port is opened exclusively, also against this program: it must be closed first.
        self.port = None;
        *self = Self::open(&self.serial)?;
        Ok(())
    }
}

/// Error of a closed port.
pub(super) fn closed(uri: &str) -> PortError {
    PortError::gone(uri, "it is closed")
}

/// Writes all bytes within a time.
pub(super) fn write(
    port: &mut SerialPort,
    uri: &str,
    bytes: &[u8],
    wait: Duration,
) -> Result<bool, PortError> {
    let gone = |reason: &dyn std::fmt::Display| PortError::gone(uri, reason);
    port.set_wait(wait);
    let mut rest = bytes;
    while !rest.is_empty() {
        match port.write(rest) {
            Ok(0) => return Err(gone(&"it takes no bytes any more")),
            Ok(count) => rest = &rest[count..],
            Err(error) if error.kind() == ErrorKind::TimedOut => return Ok(false),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(gone(&error)),
        }
    }
    Ok(true)
}

/// Reads the bytes available, or waits for some.
pub(super) fn read(
    port: &mut SerialPort,
    uri: &str,
    buffer: &mut [u8],
    wait: Duration,
) -> Result<usize, PortError> {
    let gone = |reason: &dyn std::fmt::Display| PortError::gone(uri, reason);
    port.set_wait(wait);
    match port.read(buffer) {
        Ok(0) => Err(gone(&"the other end hung up")),
        Ok(count) => Ok(count),
        Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => Ok(0),
        Err(error) => Err(gone(&error)),
    }
}
