//! Addresses of ports as text: hosts with their ports, serial lines with their rates, and options after both.
//!
//! | module | idea |
//! |---|---|
//! | [`host`] | host and port of TCP and UDP, resolved and connected within a time |
//! | [`parts`] | what is named, and the options as written |
//!
//! Everything that reads a port reads it here, so an address that is legal for one device is legal for every other.
//! Devices differ by their defaults alone ([`InstrumentPort`]).

mod error;
pub mod host;
pub mod parts;

pub use error::AddressError;
pub use host::{CONNECT_LIMIT, HostForm, HostPort};

use parts::AddressParts;
use std::fmt;

/// A serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialAddress {
    /// Name of the port.
    pub path: String,
    /// Bit rate, bit/s.
    pub baud: u32,
}

impl SerialAddress {
    /// Option with the rate.
    pub const OPTION: &str = "baud";

    /// Reads a line from its parts; without the option it has the default rate.
    ///
    /// # Errors
    /// If the name is missing, or the rate is none. `expected` is the form of the address.
    pub fn read(
        parts: &AddressParts<'_>,
        default_baud: u32,
        expected: &str,
    ) -> Result<Self, AddressError> {
        let path = parts.named(expected)?;
        let baud = parts.rate(Self::OPTION)?.unwrap_or(default_baud);
        Ok(Self { path, baud })
    }
}

impl fmt::Display for SerialAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, baud } = self;
        write!(f, "{path}?{}={baud}", Self::OPTION)
    }
}

/// Address of an instrument of the bench, such as a supply or the controller of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InstrumentAddress {
    /// A TCP server: `tcp:HOST:PORT`.
    Tcp(HostPort),
    /// A serial line: `serial:DEVICE?baud=RATE`.
    Serial(SerialAddress),
}

impl fmt::Display for InstrumentAddress {
    /// Writes the address in the form that is parsed, with every default.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(address) => write!(f, "tcp:{address}"),
            Self::Serial(line) => write!(f, "serial:{line}"),
        }
    }
}

/// Ports of a kind of instrument: what stands for a part that isn't written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstrumentPort {
    /// TCP port; `None`: it has to be written.
    pub default_port: Option<u16>,
    /// Rate of a serial line, bit/s.
    pub default_baud: u32,
}

impl InstrumentPort {
    /// Reads an address.
    ///
    /// # Errors
    /// If the text is none.
    pub fn parse(&self, text: &str) -> Result<InstrumentAddress, AddressError> {
        let expected = self.expected();
        let form = || AddressError::Name { found: text.to_owned(), expected: expected.clone() };
        let (scheme, rest) = text.split_once(':').ok_or_else(form)?;
        match scheme {
            "tcp" => {
                let parts = AddressParts::read(text, rest, "tcp", &[])?;
                let form = HostForm::Instrument { default_port: self.default_port };
                Ok(InstrumentAddress::Tcp(form.read(&parts, "tcp")?))
            }
            "serial" => {
                let parts = AddressParts::read(text, rest, "serial", &[SerialAddress::OPTION])?;
                let line = SerialAddress::read(&parts, self.default_baud, &expected)?;
                Ok(InstrumentAddress::Serial(line))
            }
            _ => Err(form()),
        }
    }

    /// Forms of an address, with the defaults.
    #[must_use]
    pub fn expected(&self) -> String {
        let tcp = HostForm::Instrument { default_port: self.default_port }.expected("tcp");
        format!("{tcp}, or serial:DEVICE?baud=RATE ({} by default)", self.default_baud)
    }
}

#[cfg(test)]
mod tests;
