//! Reads FMUs as source and as endpoint from `[source.fmu]` and `[endpoint.fmu]`.
//!
//! Settings and maps of variables are checked when the FMU is opened: a scenario is read without its
//! files.

use super::live;
use super::reader::Reader;
use crate::document::{Node, Value};
use crate::error::Problem;
use crate::keys::{ENDPOINT_MAP, Kind, SOURCE_MAP, Section};
use crate::model::{Code, Endpoint, FileName, Fmu, InterfaceChoice, Mapped, Process, Written};
use crate::ports;
use octant_sample::Mode;

/// Reads `[source.fmu]`.
pub(super) fn source(
    source: &Reader<'_>,
    file: &str,
    sample_period_ns: u64,
) -> Result<Fmu, Problem> {
    let table = source.table("fmu")?;
    let mut fmu = fmu(source, &table, file, &SOURCE_MAP, sample_period_ns)?;
    if let Some(step_s) = table.optional_si("step") {
        fmu.step_ns = (step_s * 1e9).round() as u64;
        let found = table.text("step")?;
        let fits = |big: u64, small: u64| small > 0 && big.is_multiple_of(small);
        if fmu.is_motion() {
            if !fits(fmu.step_ns, sample_period_ns) {
                return Err(table.problem(
                    "step",
                    format!("found {found:?}, expected a multiple of the sample period, {sample_period_ns} ns"),
                ));
            }
        } else if !fits(sample_period_ns, fmu.step_ns) {
            return Err(table.problem(
                "step",
                format!("found {found:?}, expected the sample period, {sample_period_ns} ns, divided by a whole number"),
            ));
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
pub(super) fn endpoint(endpoint: &Reader<'_>, sample_period_ns: u64) -> Result<Endpoint, Problem> {
    let uri = endpoint.text("uri")?;
    match uri.split_once(':') {
        None if uri == "in-process" => Ok(Endpoint::InProcess),
        Some(("fmu", file)) if !file.is_empty() => {
            let table = endpoint.table("fmu")?;
            let mut fmu = fmu(endpoint, &table, file, &ENDPOINT_MAP, sample_period_ns)?;
            fmu.modes = modes(&table);
            Ok(Endpoint::Fmu(Box::new(fmu)))
        }
        Some(_) if octant_link::Uri::is_one(uri) => {
            Ok(Endpoint::Live(Box::new(live::live(endpoint, uri)?)))
        }
        _ => {
            let message = format!("found {uri:?}, expected in-process, fmu:FILE or a port");
            Err(endpoint.problem("uri", message))
        }
    }
}

fn fmu(
    parent: &Reader<'_>,
    table: &Reader<'_>,
    file: &str,
    map: &'static Section,
    sample_period_ns: u64,
) -> Result<Fmu, Problem> {
    let mut mapped = Vec::new();
    if let Some(table) = table.optional_table("map") {
        channels(&table, map, &mut mapped)?;
    }
    let settings = match table.node("parameters") {
        Some(Node { value: Value::Table(values), .. }) => {
            ports::settings(values, &table.join("parameters"))?
        }
        _ => Vec::new(),
    };
    let uri = parent.problem("uri", "");
    Ok(Fmu {
        file: FileName(file.to_owned()),
        interface: match table.text("interface")? {
            "co-simulation" => InterfaceChoice::CoSimulation,
            "model-exchange" => InterfaceChoice::ModelExchange,
            _ => InterfaceChoice::Auto,
        },
        process: match table.text("process")? {
            "shared" => Process::Shared,
            _ => Process::Own,
        },
        // In the shared process a call can't be interrupted.
        time_limit_s: table.optional_si("time_limit").unwrap_or(f64::INFINITY),
        step_ns: sample_period_ns,
        tolerance: table.node("tolerance").map(|_| table.number("tolerance")).transpose()?,
        settings,
        map: mapped,
        modes: Vec::new(),
        at: Written { place: uri.place, path: uri.path },
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
                    at: Written { place: node.place.clone(), path },
                });
            }
            (Kind::Table(inner), Some(_)) => channels(&table.table(key.name)?, inner, all)?,
            _ => {}
        }
    }
    Ok(())
}

fn modes(table: &Reader<'_>) -> Vec<(Mode, Vec<Code>)> {
    let Some(modes) = table.optional_table("modes") else { return Vec::new() };
    let codes = |mode: Mode| {
        let codes = ports::codes(&modes.node(mode.name())?.value)?;
        Some((mode, codes))
    };
    Mode::ALL.into_iter().filter_map(codes).collect()
}
