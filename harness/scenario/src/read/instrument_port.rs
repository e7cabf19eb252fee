//! Reads a real instrument on a port from `source.uri` and `[source.live]`.

use crate::error::Problem;
use crate::keys::{At, SourceKeys, SourceLiveKeys};
use crate::model::{FileName, Instrument, Messages, Speaks};
use octant_instruments::novatel::CountScale;
use octant_instruments::{Axes, Protocol};
use octant_link::Uri;

/// Reads a port and `[source.live]`.
pub(super) fn instrument(keys: &SourceKeys) -> Result<Instrument, Problem> {
    let uri: Uri = (keys.uri.parse())
        .map_err(|error: octant_link::uri::UriError| keys.uri.problem(error.to_string()))?;
    let bus = matches!(uri, Uri::Can(_) | Uri::Slcan(_));
    if !bus && !matches!(uri, Uri::Serial(_) | Uri::Udp(_)) {
        let message =
            format!("found {uri}, expected an instrument at serial:, udp:, can: or slcan:");
        return Err(keys.uri.problem(message));
    }
    let live = keys.live.as_ref().ok_or_else(|| keys.uri.problem("source.live is missing"))?;
    let name = live.protocol.as_str();
    if bus != (name == "dbc") {
        let expected = if bus { "\"dbc\" on a CAN bus" } else { "the protocol of a line of bytes" };
        return Err(live.protocol.problem(format!("found {name:?}, expected {expected}")));
    }
    let file = |key: &At<Option<String>>| match key.as_deref() {
        Some(file) if !file.is_empty() => Ok(FileName(file.to_owned())),
        _ => Err(key.problem("missing, expected a file: protocol is \"dbc\"")),
    };
    let speaks = if bus {
        Speaks::Can(Messages { database: file(&live.database)?, mapping: file(&live.mapping)? })
    } else {
        Speaks::Bytes(Protocol::of_name(name).ok_or_else(|| {
            live.protocol.problem(format!("found {name:?}, which no codec reads"))
        })?)
    };
    let count = count_scale(live, &speaks)?;
    let axes = Axes::parse(&live.axes)
        .map_err(|error| live.axes.problem(format!("it says no mounting: {error}")))?;
    Ok(Instrument { uri, speaks, count, axes, silence_s: live.silence })
}

/// Reads the size of a count, which no protocol but NovAtel's leaves to the kind of unit.
fn count_scale(live: &SourceLiveKeys, speaks: &Speaks) -> Result<Option<CountScale>, Problem> {
    let (gyro, accel) = (&live.gyro_count, &live.accel_count);
    let (given, missing) = match (**gyro, **accel) {
        (None, None) => return Ok(None),
        (Some(rotation_rad), Some(velocity_mps)) if *speaks == Speaks::Bytes(Protocol::NovAtel) => {
            return Ok(Some(CountScale { rotation_rad, velocity_mps }));
        }
        (Some(_), Some(_)) => {
            let message = format!(
                "protocol {:?} has a scale of its own, expected none: only \"novatel\" has counts of the unit",
                speaks.name()
            );
            return Err(gyro.problem(message));
        }
        (Some(_), None) => (gyro, "accel_count"),
        (None, Some(_)) => (accel, "gyro_count"),
    };
    Err(given.problem(format!("source.live.{missing} is missing, expected both or none")))
}
