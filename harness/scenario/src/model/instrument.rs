//! A real instrument on a port.

use super::file_name::FileName;
use octant_instruments::novatel::CountScale;
use octant_instruments::{Axes, Protocol};
use octant_link::Uri;

/// An instrument on a port.
#[derive(Clone, Debug, PartialEq)]
pub struct Instrument {
    /// The port.
    pub uri: Uri,
    /// Protocol or messages of the instrument.
    pub speaks: Speaks,
    /// Size of one count, where the scenario gives it in place of the protocol's table.
    pub count: Option<CountScale>,
    /// Mounting.
    pub axes: Axes,
    /// Longest wait for a reading, s.
    pub silence_s: f64,
}

/// The bytes that an instrument sent, as a file.
#[derive(Clone, Debug, PartialEq)]
pub struct InstrumentLog {
    /// The file, as written.
    pub file: FileName,
    /// Protocol of the instrument.
    pub protocol: Protocol,
    /// Size of one count, where the scenario gives it in place of the protocol's table.
    pub count: Option<CountScale>,
    /// Mounting.
    pub axes: Axes,
}

/// Encoding of an instrument's readings.
#[derive(Clone, Debug, PartialEq)]
pub enum Speaks {
    /// A protocol on a line of bytes.
    Bytes(Protocol),
    /// Messages on a CAN bus.
    Can(Messages),
}

impl Speaks {
    /// Name in a scenario.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Bytes(protocol) => protocol.name(),
            Self::Can(_) => "dbc",
        }
    }
}

/// Messages on a CAN bus, with the files that describe them.
#[derive(Clone, Debug, PartialEq)]
pub struct Messages {
    /// Database.
    pub database: FileName,
    /// Mapping of signals to channels.
    pub mapping: FileName,
}
