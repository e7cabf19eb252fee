//! Serial lines.

use super::{Bytes, PortError};
use crate::Uri;
use crate::uri::Serial;
use serialport::{DataBits, FlowControl, Parity, SerialPort, StopBits};
use std::io::ErrorKind;
use std::time::Duration;

/// A serial line: 8 data bits, no parity, 1 stop bit, no flow control, opened exclusively.
pub struct SerialLine {
    serial: Serial,
    uri: String,
    /// `None` while the line is closed.
    port: Option<Box<dyn SerialPort>>,
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
    pub fn open(serial: &Serial) -> Result<Self, PortError> {
        let uri = Uri::Serial(serial.clone()).to_string();
        let refused = |reason: String| PortError::open(&uri, reason);
        let port = serialport::new(&serial.path, serial.baud)
            .data_bits(DataBits::Eight)
            .parity(Parity::None)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::None)
            .timeout(Duration::ZERO)
            .open()
            .map_err(|error| refused(explain(&error)))?;
        // A driver that can't set a rate may silently take another one.
        let found = port.baud_rate().map_err(|error| refused(error.to_string()))?;
        if found != serial.baud {
            return Err(refused(format!(
                "the driver gave {found} baud, expected {}: this port can't do that rate",
                serial.baud
            )));
        }
        // Bytes from before the opening belong to no session.
        port.clear(serialport::ClearBuffer::Input).map_err(|error| refused(error.to_string()))?;
        Ok(Self { serial: serial.clone(), uri, port: Some(port) })
    }
}

/// Error text with a remedy for the user.
fn explain(error: &serialport::Error) -> String {
    let what = error.to_string();
    match error.kind {
        serialport::ErrorKind::Io(ErrorKind::PermissionDenied) => {
            format!("{what}; on Linux the user has to be in the group of the port, often dialout")
        }
        serialport::ErrorKind::NoDevice | serialport::ErrorKind::Io(ErrorKind::NotFound) => {
            format!("{what}; expected a serial port that is there, and that no other program has")
        }
        serialport::ErrorKind::Io(ErrorKind::WouldBlock | ErrorKind::ResourceBusy) => {
            format!("{what}; another program has it")
        }
        _ => what,
    }
}

impl Bytes for SerialLine {
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError> {
        match &mut self.port {
            Some(port) => write(port.as_mut(), &self.uri, bytes, wait),
            None => Err(closed(&self.uri)),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        match &mut self.port {
            Some(port) => read(port.as_mut(), &self.uri, buffer, wait),
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
    port: &mut dyn SerialPort,
    uri: &str,
    bytes: &[u8],
    wait: Duration,
) -> Result<bool, PortError> {
    let gone = |reason: &dyn std::fmt::Display| PortError::gone(uri, reason);
    port.set_timeout(wait).map_err(|error| gone(&error))?;
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
    port: &mut dyn SerialPort,
    uri: &str,
    buffer: &mut [u8],
    wait: Duration,
) -> Result<usize, PortError> {
    let gone = |reason: &dyn std::fmt::Display| PortError::gone(uri, reason);
    if wait.is_zero() {
        // Without this check, each read of an empty line would allocate an error.
        if port.bytes_to_read().map_err(|error| gone(&error))? == 0 {
            return Ok(0);
        }
    }
    port.set_timeout(wait).map_err(|error| gone(&error))?;
    match port.read(buffer) {
        Ok(0) => Err(gone(&"the other end hung up")),
        Ok(count) => Ok(count),
        Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => Ok(0),
        Err(error) => Err(gone(&error)),
    }
}
