//! A real instrument on a port.

use super::file_name::FileName;
use crate::choices::DESCRIBED;
use octant_instruments::novatel::CountScale;
use octant_instruments::{Axes, Protocol, StampScale};
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
    /// Pulses at the whole seconds of its stamps, if it has them.
    pub pulses: Option<UnitPulses>,
    /// Time scale of its stamps, if it is known.
    pub known_stamps: Option<KnownStamps>,
}

/// Stamps by a known time scale.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownStamps {
    /// The scale.
    pub scale: StampScale,
    /// Bound of the error of the stamps, s.
    pub within_s: f64,
    /// Clock of a network card that PTP keeps at TAI; `None`: the host's realtime clock.
    pub host_clock: Option<String>,
    /// Bound of the error of the host's clock, s; `None`: the kernel's.
    pub host_within_s: Option<f64>,
    /// Seconds by which TAI is ahead of UTC; `None`: the kernel's.
    pub tai_offset_s: Option<u32>,
}

/// Pulses at the whole seconds of a unit's stamps.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitPulses {
    /// Device, or file in its place, as written.
    pub device: String,
    /// True if the second begins at the clear edge.
    pub at_clear: bool,
    /// Longest time without a pulse, s.
    pub silence_s: f64,
    /// Bound of the time between a whole second of the stamps and the kernel's stamp of its pulse, s.
    pub within_s: f64,
}

/// The bytes that an instrument sent, as a file.
#[derive(Clone, Debug, PartialEq)]
pub struct InstrumentLog {
    /// The file, as written.
    pub file: FileName,
    /// Protocol of the instrument; never messages on a CAN bus.
    pub speaks: Speaks,
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
    /// Records on a line of bytes, by a description of their frames.
    Described(DescriptionChoice),
    /// Messages on a CAN bus.
    Can(Messages),
}

impl Speaks {
    /// Name in a scenario.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Bytes(protocol) => protocol.name(),
            Self::Described(_) => DESCRIBED,
            Self::Can(_) => "dbc",
        }
    }

    /// Name for people: of a described protocol its description.
    #[must_use]
    pub fn told(&self) -> String {
        match self {
            Self::Described(DescriptionChoice::Ready(name)) => format!("{DESCRIBED} as {name}"),
            Self::Described(DescriptionChoice::File(file)) => {
                format!("{DESCRIBED} by {}", file.0)
            }
            other => other.name().to_owned(),
        }
    }

    /// File of the description, if there is one.
    pub(crate) fn described_by(&self) -> Option<&FileName> {
        match self {
            Self::Described(DescriptionChoice::File(file)) => Some(file),
            _ => None,
        }
    }
}

/// Description of a unit's frames.
#[derive(Clone, Debug, PartialEq)]
pub enum DescriptionChoice {
    /// One that comes with the program, by its name.
    Ready(String),
    /// A file.
    File(FileName),
}

impl DescriptionChoice {
    /// True for a text that names a file, and not a description that comes with the program.
    #[must_use]
    pub fn is_file(text: &str) -> bool {
        text.ends_with(".toml")
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
