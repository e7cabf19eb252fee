//! A real instrument on a port, as read from `source.uri` and `[source.live]`.

use super::Reader;
use crate::scenario::error::Problem;
use octant_instruments::{Axes, Protocol};
use octant_link::Uri;

/// An instrument on a port.
#[derive(Clone, Debug, PartialEq)]
pub struct Instrument {
    /// The port.
    pub uri: Uri,
    /// What it speaks.
    pub protocol: Protocol,
    /// How it is mounted.
    pub axes: Axes,
    /// How long a reading is waited for, s.
    pub silence_s: f64,
}

/// Reads it.
pub(super) fn instrument(source: &Reader<'_>, uri: &str) -> Result<Instrument, Problem> {
    let uri: Uri = uri
        .parse()
        .map_err(|error: octant_link::uri::UriError| source.problem("uri", error.to_string()))?;
    if !matches!(uri, Uri::Serial(_) | Uri::Udp(_)) {
        let message = format!("found {uri}, expected an instrument at serial: or udp:");
        return Err(source.problem("uri", message));
    }
    let live = source.table("live")?;
    let name = live.text("protocol")?;
    let protocol = Protocol::of_name(name)
        .ok_or_else(|| live.problem("protocol", format!("found {name:?}, which no codec reads")))?;
    let axes = Axes::parse(live.text("axes")?)
        .map_err(|error| live.problem("axes", format!("it says no mounting: {error}")))?;
    Ok(Instrument { uri, protocol, axes, silence_s: live.si("silence")? })
}
