//! Ports of a table's controller.

use crate::Error;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// A line to a controller.
pub trait TablePort: Read + Write + Send {
    /// Makes another handle for writing, which works while this one is in use.
    ///
    /// # Errors
    /// If there is no other handle.
    fn writer(&self) -> io::Result<Box<dyn Write + Send>>;

    /// Sets the longest wait of a read, which then returns `TimedOut` or `WouldBlock`. A write doesn't
    /// wait longer either.
    ///
    /// # Errors
    /// If the wait can't be set.
    fn set_wait(&mut self, wait: Duration) -> io::Result<()>;

    /// Makes another handle for the guard.
    ///
    /// # Errors
    /// If there is no other handle.
    #[cfg(unix)]
    fn duplicate(&self) -> io::Result<std::os::fd::OwnedFd>;
}

impl TablePort for TcpStream {
    fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(Box::new(self.try_clone()?))
    }

    fn set_wait(&mut self, wait: Duration) -> io::Result<()> {
        self.set_read_timeout(Some(wait))?;
        self.set_write_timeout(Some(wait.max(Duration::from_millis(100))))
    }

    #[cfg(unix)]
    fn duplicate(&self) -> io::Result<std::os::fd::OwnedFd> {
        Ok(self.try_clone()?.into())
    }
}

#[cfg(unix)]
impl TablePort for serialport::TTYPort {
    fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(Box::new(self.try_clone_native()?))
    }

    fn set_wait(&mut self, wait: Duration) -> io::Result<()> {
        Ok(serialport::SerialPort::set_timeout(self, wait)?)
    }

    #[allow(unsafe_code, reason = "the serial port gives its handle as a number only")]
    fn duplicate(&self) -> io::Result<std::os::fd::OwnedFd> {
        use std::os::fd::{FromRawFd, IntoRawFd};
        let raw = self.try_clone_native()?.into_raw_fd();
        // SAFETY: the clone released its handle with `into_raw_fd`: it is open, and has no other owner.
        Ok(unsafe { std::os::fd::OwnedFd::from_raw_fd(raw) })
    }
}

#[cfg(windows)]
impl TablePort for serialport::COMPort {
    fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(Box::new(serialport::SerialPort::try_clone(self)?))
    }

    fn set_wait(&mut self, wait: Duration) -> io::Result<()> {
        Ok(serialport::SerialPort::set_timeout(self, wait)?)
    }
}

impl TablePort for Box<dyn TablePort> {
    fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        (**self).writer()
    }

    fn set_wait(&mut self, wait: Duration) -> io::Result<()> {
        (**self).set_wait(wait)
    }

    #[cfg(unix)]
    fn duplicate(&self) -> io::Result<std::os::fd::OwnedFd> {
        (**self).duplicate()
    }
}

/// Address of a port.
enum Address<'a> {
    Tcp(&'a str),
    Serial(&'a str, u32),
}

fn address(uri: &str) -> Result<Address<'_>, Error> {
    let failed = |reason: String| Error::Open { port: uri.into(), reason };
    if let Some(address) = uri.strip_prefix("tcp:") {
        let port = address.rsplit_once(':').and_then(|(host, port)| {
            port.parse::<u16>().ok().filter(|port| *port > 0 && !host.is_empty())
        });
        return match port {
            Some(_) => Ok(Address::Tcp(address)),
            None => Err(failed(format!("`{address}` is not HOST:PORT"))),
        };
    }
    let Some(serial) = uri.strip_prefix("serial:") else {
        return Err(failed("the address has neither tcp: nor serial:".into()));
    };
    let (device, baud) = match serial.split_once('?') {
        None => (serial, 115_200),
        Some((device, query)) => {
            let rate = query.strip_prefix("baud=").and_then(|rate| rate.parse().ok());
            (device, rate.ok_or_else(|| failed(format!("`{query}` is not baud=RATE")))?)
        }
    };
    if device.is_empty() || baud == 0 {
        return Err(failed("the address has no device, or no rate".into()));
    }
    Ok(Address::Serial(device, baud))
}

/// Checks that a text is the address of a table, without opening it.
///
/// # Errors
/// If the text is no such address.
pub fn check_port(uri: &str) -> Result<(), Error> {
    address(uri).map(|_| ())
}

/// Opens `tcp:HOST:PORT` or `serial:DEVICE?baud=RATE` (8N1, exclusive; the default rate is 115200).
///
/// # Errors
/// If the text is no such address, or the port can't be opened.
pub fn open(uri: &str) -> Result<Box<dyn TablePort>, Error> {
    let failed = |reason: String| Error::Open { port: uri.into(), reason };
    let (device, baud) = match address(uri)? {
        Address::Tcp(address) => {
            let stream = TcpStream::connect(address).map_err(|error| failed(error.to_string()))?;
            stream.set_nodelay(true).map_err(|error| failed(error.to_string()))?;
            return Ok(Box::new(stream));
        }
        Address::Serial(device, baud) => (device, baud),
    };
    let builder = serialport::new(device, baud).timeout(Duration::from_millis(20));
    let port = builder.open_native().map_err(|error| failed(error.to_string()))?;
    // Some drivers silently set another rate.
    match serialport::SerialPort::baud_rate(&port) {
        Ok(found) if found != baud => {
            Err(failed(format!("the line runs at {found} baud, expected {baud}")))
        }
        _ => Ok(Box::new(port)),
    }
}
