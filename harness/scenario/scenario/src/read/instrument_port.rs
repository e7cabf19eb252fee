//! Reads a real instrument on a port from `source.uri` and `[source.live]`, and what one sent from
//! `[source.log]`.

use crate::choices::DESCRIBED;
use crate::error::Problem;
use crate::keys::{At, SourceKeys, SourceLiveKeys};
use crate::model::{
    DescriptionChoice, FileName, Instrument, InstrumentLog, KnownStamps, Messages, Speaks,
    UnitPulses,
};
use octant_base::names::suggestion;
use octant_instruments::description::READY;
use octant_instruments::novatel::CountScale;
use octant_instruments::{Axes, Protocol, StampScale};
use octant_link::Uri;

/// Time that the kernel may take to stamp a pulse, s: the latency of its interrupt.
const PULSE_WITHIN_S: f64 = 20e-6;

/// Reads a port and `[source.live]`.
pub(super) fn instrument(keys: &SourceKeys) -> Result<Instrument, Problem> {
    let uri: Uri = (keys.uri.parse())
        .map_err(|error: octant_link::uri::UriError| keys.uri.problem(error.to_string()))?;
    let bus = matches!(uri, Uri::Can(_) | Uri::Slcan(_));
    if !bus && !matches!(uri, Uri::Serial(_) | Uri::Udp(_) | Uri::Tcp(_)) {
        let message =
            format!("found {uri}, expected an instrument at serial:, udp:, tcp:, can: or slcan:");
        return Err(keys.uri.problem(message));
    }
    if matches!(&uri, Uri::Udp(udp) if udp.secret.is_some()) {
        let message =
            format!("found {uri}, expected no secret: an instrument's datagrams have no seal");
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
        line(&live.protocol, &live.description)?
    };
    let count = count_scale("live", [&live.gyro_count, &live.accel_count], &speaks)?;
    let axes = mounting(&live.axes)?;
    let pulses = live.pps.as_ref().map(|device| UnitPulses {
        device: device.clone(),
        at_clear: live.pps_edge,
        silence_s: live.pps_silence,
        within_s: live.stamps_within.unwrap_or(PULSE_WITHIN_S),
    });
    let known_stamps = known_stamps(live)?;
    Ok(Instrument { uri, speaks, count, axes, silence_s: live.silence, pulses, known_stamps })
}

/// Reads the time scale of the stamps; `None` of a clock of the unit's own.
fn known_stamps(live: &SourceLiveKeys) -> Result<Option<KnownStamps>, Problem> {
    let Some(scale) = *live.stamps else { return Ok(None) };
    if live.pps.is_some() {
        let message = "found a time scale beside source.live.pps, expected one of both: pulses are for a \
                       clock of the unit's own";
        return Err(live.stamps.problem(message));
    }
    let missing = |key: &str, reason: &str| {
        live.stamps.problem(format!("source.live.{key} is missing, expected {reason}"))
    };
    let within_s = live
        .stamps_within
        .ok_or_else(|| missing("stamps_within", "the bound of the stamps' error"))?;
    let host_clock = live.host_clock.clone();
    if host_clock.is_some() && live.host_within.is_none() {
        let reason = "the bound of host_clock's error, which only the program knows that sets it";
        return Err(missing("host_within", reason));
    }
    if host_clock.is_some() && scale == StampScale::Utc && live.tai_offset.is_none() {
        let reason = "how far TAI is ahead: the stamps are UTC, and host_clock is TAI";
        return Err(missing("tai_offset", reason));
    }
    let (host_within_s, tai_offset_s) = (live.host_within, live.tai_offset);
    Ok(Some(KnownStamps { scale, within_s, host_clock, host_within_s, tai_offset_s }))
}

/// Reads the bytes that an instrument sent, from a file and `[source.log]`.
pub(super) fn log(keys: &SourceKeys, file: &str) -> Result<InstrumentLog, Problem> {
    let Some(log) = &*keys.log else {
        let message =
            "missing, expected the protocol of the instrument whose bytes source.uri names";
        return Err(keys.log.problem(message));
    };
    let speaks = line(&log.protocol, &log.description)?;
    let counts = [&log.gyro_count, &log.accel_count];
    let count = count_scale("log", counts, &speaks)?;
    let axes = mounting(&log.axes)?;
    Ok(InstrumentLog { file: FileName(file.to_owned()), speaks, count, axes })
}

/// Reads the protocol of a line of bytes.
fn line(protocol: &At<String>, description: &At<Option<String>>) -> Result<Speaks, Problem> {
    let name = protocol.as_str();
    if name != DESCRIBED {
        let unknown = || protocol.problem(format!("found {name:?}, which no codec reads"));
        return Protocol::of_name(name).map(Speaks::Bytes).ok_or_else(unknown);
    }
    let ready = || READY.iter().map(|(name, _)| *name);
    match description.as_deref() {
        Some(file) if DescriptionChoice::is_file(file) => {
            Ok(Speaks::Described(DescriptionChoice::File(FileName(file.to_owned()))))
        }
        Some(name) if ready().any(|known| known == name) => {
            Ok(Speaks::Described(DescriptionChoice::Ready(name.to_owned())))
        }
        Some(name) => {
            let known = suggestion(name, ready(), "expected a file NAME.toml or one of");
            Err(description.problem(format!("found {name:?}; {known}")))
        }
        None => {
            let known: Vec<&str> = ready().collect();
            Err(description.problem(format!(
                "missing, expected a file NAME.toml or one of {}: protocol is \"described\"",
                known.join(", ")
            )))
        }
    }
}

fn mounting(axes: &At<String>) -> Result<Axes, Problem> {
    Axes::parse(axes).map_err(|error| axes.problem(format!("it says no mounting: {error}")))
}

/// Reads the size of a count from two keys of a table, which no protocol but NovAtel's leaves to the kind of
/// unit.
fn count_scale(
    table: &str,
    [gyro, accel]: [&At<Option<f64>>; 2],
    speaks: &Speaks,
) -> Result<Option<CountScale>, Problem> {
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
    Err(given.problem(format!("source.{table}.{missing} is missing, expected both or none")))
}
