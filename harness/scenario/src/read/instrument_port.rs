//! A real instrument on a port, as read from `source.uri` and `[source.live]`.

use super::Reader;
use super::source::FileName;
use crate::error::Problem;
use octant_instruments::{Axes, Protocol};
use octant_link::Uri;

/// An instrument on a port.
#[derive(Clone, Debug, PartialEq)]
pub struct Instrument {
    /// The port.
    pub uri: Uri,
    /// What it speaks.
    pub speaks: Speaks,
    /// How it is mounted.
    pub axes: Axes,
    /// How long a reading is waited for, s.
    pub silence_s: f64,
}

/// What an instrument speaks.
#[derive(Clone, Debug, PartialEq)]
pub enum Speaks {
    /// A protocol on a line of bytes.
    Bytes(Protocol),
    /// Messages on a CAN bus.
    Can(Messages),
}

impl Speaks {
    /// Its name in a scenario.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Bytes(protocol) => protocol.name(),
            Self::Can(_) => "dbc",
        }
    }
}

/// Messages on a CAN bus, by the files that say what is in them.
#[derive(Clone, Debug, PartialEq)]
pub struct Messages {
    /// The database.
    pub database: FileName,
    /// Which signals are which channels.
    pub mapping: FileName,
}

/// Reads it.
pub(super) fn instrument(source: &Reader<'_>, uri: &str) -> Result<Instrument, Problem> {
    let uri: Uri = uri
        .parse()
        .map_err(|error: octant_link::uri::UriError| source.problem("uri", error.to_string()))?;
    let bus = matches!(uri, Uri::Can(_) | Uri::Slcan(_));
    if !bus && !matches!(uri, Uri::Serial(_) | Uri::Udp(_)) {
        let message =
            format!("found {uri}, expected an instrument at serial:, udp:, can: or slcan:");
        return Err(source.problem("uri", message));
    }
    let live = source.table("live")?;
    let name = live.text("protocol")?;
    if bus != (name == "dbc") {
        let expected = if bus { "\"dbc\" on a CAN bus" } else { "the protocol of a line of bytes" };
        return Err(live.problem("protocol", format!("found {name:?}, expected {expected}")));
    }
    let file = |key: &str| match live.optional_text(key) {
        Some(file) if !file.is_empty() => Ok(FileName(file.to_owned())),
        _ => Err(live.problem(key, "missing, expected a file: protocol is \"dbc\"")),
    };
    let speaks = if bus {
        Speaks::Can(Messages { database: file("database")?, mapping: file("mapping")? })
    } else {
        Speaks::Bytes(Protocol::of_name(name).ok_or_else(|| {
            live.problem("protocol", format!("found {name:?}, which no codec reads"))
        })?)
    };
    let axes = Axes::parse(live.text("axes")?)
        .map_err(|error| live.problem("axes", format!("it says no mounting: {error}")))?;
    Ok(Instrument { uri, speaks, axes, silence_s: live.si("silence")? })
}
