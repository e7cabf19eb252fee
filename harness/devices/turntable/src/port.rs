//! Ports of a table's controller.

use crate::Error;
use octant_base::address::{CONNECT_LIMIT, InstrumentAddress, InstrumentPort};
use octant_base::serial::SerialPort;
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

impl TablePort for SerialPort {
    fn writer(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(Box::new(self.try_clone()?))
    }

    fn set_wait(&mut self, wait: Duration) -> io::Result<()> {
        Self::set_wait(self, wait);
        Ok(())
    }

    #[cfg(unix)]
    fn duplicate(&self) -> io::Result<std::os::fd::OwnedFd> {
        std::os::fd::AsFd::as_fd(self).try_clone_to_owned()
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

/// Ports of a table's controller. A TCP port has to be written: it belongs to the controller, of which there are many.
pub const TABLE_PORT: InstrumentPort = InstrumentPort { default_port: None, default_baud: 115_200 };

/// Text of help for an argument that is a port of a table.
#[must_use]
pub fn port_help() -> String {
    let ports = TABLE_PORT.expected();
    format!("Port of the controller, {ports}, or a scenario with [turntable.drive]")
}

/// Checks that a text is the address of a table, without opening it.
///
/// # Errors
/// If the text is no such address.
pub fn check_port(uri: &str) -> Result<(), Error> {
    TABLE_PORT.parse(uri).map(drop).map_err(Error::Address)
}

/// Opens a port of a table, [`TABLE_PORT`], within a limit of time (serial lines 8N1, exclusive).
///
/// # Errors
/// If the text is no such address, or the port can't be opened.
pub fn open(uri: &str) -> Result<Box<dyn TablePort>, Error> {
    let address = TABLE_PORT.parse(uri).map_err(Error::Address)?;
    let opened: io::Result<Box<dyn TablePort>> = match &address {
        InstrumentAddress::Tcp(address) => {
            address.connect(CONNECT_LIMIT).map(|stream| Box::new(stream) as _)
        }
        InstrumentAddress::Serial(line) => {
            SerialPort::open(&line.path, line.baud).map(|mut port| {
                port.set_wait(Duration::from_millis(20));
                Box::new(port) as _
            })
        }
    };
    opened.map_err(|error| Error::Open { port: address.to_string(), reason: error.to_string() })
}
