//! Reads a real instrument on a port from `source.uri` and `[source.live]`.

use super::reader::Reader;
use crate::error::Problem;
use crate::model::{FileName, Instrument, Messages, Speaks};
use octant_instruments::{Axes, Protocol};
use octant_link::Uri;

/// Reads a port and `[source.live]`.
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
