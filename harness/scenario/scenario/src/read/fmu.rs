//! Reads FMUs as source and as endpoint from `[source.fmu]` and `[endpoint.fmu]`, and a core at the other end of a wire from
//! `endpoint.uri` and `[endpoint.link]`.
//!
//! Settings and maps of variables are checked when the FMU is opened: a scenario is read without its
//! files.

use super::reader::Reader;
use crate::error::Problem;
use crate::keys::{
    At, ENDPOINT_MAP, EndpointKeys, FmuKeys, Kind, Raw, SOURCE_MAP, Section, SourceKeys,
};
use crate::model::{Code, EndpointSpec, EntryPlace, FileName, Fmu, Live, Mapped};
use crate::ports;
use octant_link::Uri;
use octant_sample::Mode;

/// Reads `[source.fmu]`.
pub(super) fn source(
    source: &SourceKeys,
    file: &str,
    sample_period_ns: u64,
) -> Result<Fmu, Problem> {
    let keys = source.fmu.as_ref().ok_or_else(|| source.uri.problem("source.fmu is missing"))?;
    let mut fmu = fmu(&source.uri, keys.common(), file, &SOURCE_MAP, sample_period_ns)?;
    if let Some(step_s) = *keys.step {
        fmu.step_ns = (step_s * 1e9).round() as u64;
        let found = &keys.step.text;
        let fits = |big: u64, small: u64| small > 0 && big.is_multiple_of(small);
        if fmu.is_motion() {
            if !fits(fmu.step_ns, sample_period_ns) {
                return Err(keys.step.problem(format!(
                    "found {found:?}, expected a multiple of the sample period, {sample_period_ns} ns"
                )));
            }
        } else if !fits(sample_period_ns, fmu.step_ns) {
            return Err(keys.step.problem(format!(
                "found {found:?}, expected the sample period, {sample_period_ns} ns, divided by a \
                 whole number"
            )));
        }
    }
    if let Some(case) = fmu.map.iter().find(|mapped| mapped.channel.name.starts_with("case."))
        && let Some(other) = fmu.map.iter().find(|mapped| !mapped.channel.name.starts_with("case."))
    {
        return Err(other.at.problem(format!(
            "found {} beside {}: an FMU is the motion under Octant's plant, or an instrument, and not both",
            other.channel.name, case.channel.name
        )));
    }
    Ok(fmu)
}

/// Reads `[endpoint]`.
pub(super) fn endpoint(
    keys: &EndpointKeys,
    sample_period_ns: u64,
) -> Result<EndpointSpec, Problem> {
    let uri = keys.uri.as_str();
    match uri.split_once(':') {
        None if uri == "in-process" => Ok(EndpointSpec::InProcess),
        Some(("fmu", file)) if !file.is_empty() => {
            let of_fmu = keys.fmu.as_ref();
            let of_fmu = of_fmu.ok_or_else(|| keys.uri.problem("endpoint.fmu is missing"))?;
            let mut fmu = fmu(&keys.uri, of_fmu.common(), file, &ENDPOINT_MAP, sample_period_ns)?;
            fmu.modes = of_fmu.modes.as_ref().map(modes).unwrap_or_default();
            Ok(EndpointSpec::Fmu(Box::new(fmu)))
        }
        Some(_) if octant_link::Uri::is_one(uri) => Ok(EndpointSpec::Live(Box::new(live(keys)?))),
        _ => {
            Err(keys.uri.problem(format!("found {uri:?}, expected in-process, fmu:FILE or a port")))
        }
    }
}

fn fmu(
    uri: &At<String>,
    keys: FmuKeys<'_>,
    file: &str,
    map: &'static Section,
    sample_period_ns: u64,
) -> Result<Fmu, Problem> {
    let mut mapped = Vec::new();
    if let Some(table) = keys.map {
        channels(&table.reader(), map, &mut mapped)?;
    }
    let settings = keys.parameters.map(|raw| ports::settings(&raw.table, &raw.path)).transpose()?;
    Ok(Fmu {
        file: FileName(file.to_owned()),
        interface: keys.interface,
        process: keys.process,
        // In the shared process a call can't be interrupted.
        time_limit_s: keys.time_limit.unwrap_or(f64::INFINITY),
        allow_tool: keys.allow_tool,
        step_ns: sample_period_ns,
        tolerance: keys.tolerance,
        settings: settings.unwrap_or_default(),
        map: mapped,
        modes: Vec::new(),
        at: EntryPlace { place: uri.place.clone(), path: uri.path.clone() },
    })
}

/// Reads the channels given in a map's tables.
fn channels(
    table: &Reader<'_>,
    section: &'static Section,
    all: &mut Vec<Mapped>,
) -> Result<(), Problem> {
    for key in section.keys {
        match (&key.kind, table.node(key.name)) {
            (Kind::Port(channel), Some(node)) => {
                let path = table.join(key.name);
                all.push(Mapped {
                    channel,
                    ports: ports::ports(node, channel, &path)?,
                    at: EntryPlace { place: node.place.clone(), path },
                });
            }
            (Kind::Table(inner), Some(_)) => channels(&table.table(key.name)?, inner, all)?,
            _ => {}
        }
    }
    Ok(())
}

fn modes(modes: &Raw) -> Vec<(Mode, Vec<Code>)> {
    let codes = |mode: Mode| {
        let codes = ports::codes(&modes.table.get(mode.name())?.value)?;
        Some((mode, codes))
    };
    Mode::ALL.into_iter().filter_map(codes).collect()
}

/// Reads a port and `[endpoint.link]`.
pub(super) fn live(keys: &EndpointKeys) -> Result<Live, Problem> {
    let uri: Uri = (keys.uri.parse())
        .map_err(|error: octant_link::uri::UriError| keys.uri.problem(error.to_string()))?;
    if let Uri::Pty { .. } = uri {
        let message = "found pty:, expected serial: with the terminal that octant serve announces";
        return Err(keys.uri.problem(message));
    }
    if let Uri::Stdio = uri {
        let message = "found stdio:, expected exec: with the program whose input and output it is";
        return Err(keys.uri.problem(message));
    }
    if matches!(&uri, Uri::Tcp(tcp) if tcp.listen) {
        let message = format!(
            "found {uri}, expected tcp:HOST:PORT alone: listen is for an instrument that connects to this host"
        );
        return Err(keys.uri.problem(message));
    }
    let link = keys.link.as_ref().ok_or_else(|| keys.uri.problem("endpoint.link is missing"))?;
    let live = Live {
        uri,
        hello_s: link.hello,
        answer_s: link.answer,
        repeat_s: *link.repeat,
        reconnect_s: *link.reconnect,
    };
    if live.repeat_s > live.answer_s {
        let message = "an answer would be given up before it is asked for again; expected no more \
                       than endpoint.link.answer";
        return Err(link.repeat.problem(message));
    }
    Ok(live)
}
