//! FMUs as source and as endpoint, as read from `[source.fmu]` and `[endpoint.fmu]`.
//!
//! What is said about variables is checked when the FMU is opened: a scenario is read without its
//! files.

use super::Reader;
use super::live::{self, Live};
use super::source::FileName;
use crate::channel::Channel;
use crate::document::{Node, Value};
use crate::error::Problem;
use crate::keys::{ENDPOINT_MAP, Kind, SOURCE_MAP, Section};
use crate::ports::{self, Code, Port, Setting, Written};
use octant_sample::Mode;

/// Where the core runs.
#[derive(Clone, Debug, PartialEq)]
pub enum Endpoint {
    /// In this process.
    InProcess,
    /// In an FMU.
    Fmu(Box<Fmu>),
    /// At the other end of a wire.
    Live(Box<Live>),
}

/// An FMU of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Fmu {
    /// The file.
    pub file: FileName,
    /// Which of its interfaces is used.
    pub interface: InterfaceChoice,
    /// Where it runs.
    pub process: Process,
    /// Wall time that a call may take in a process of its own, s.
    pub time_limit_s: f64,
    /// Communication step, ns; of an endpoint the sample period.
    pub step_ns: u64,
    /// Relative tolerance of the solver.
    pub tolerance: Option<f64>,
    /// What is set before it starts.
    pub settings: Vec<Setting>,
    /// Channels and what they are made of.
    pub map: Vec<Mapped>,
    /// Values of the mode's variable by mode; empty: the codes of [`Mode`].
    pub modes: Vec<(Mode, Vec<Code>)>,
    /// Where the FMU is named.
    pub at: Written,
}

/// Which interface of an FMU is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InterfaceChoice {
    /// Co-simulation where there is one, else model exchange.
    #[default]
    Auto,
    /// Co-simulation.
    CoSimulation,
    /// Model exchange.
    ModelExchange,
}

/// Where an FMU runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Process {
    /// In a process of its own.
    #[default]
    Own,
    /// In this one.
    Shared,
}

/// A channel and what it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapped {
    /// The channel.
    pub channel: &'static Channel,
    /// One port for all elements, or one for each.
    pub ports: Vec<Port>,
    /// Where it was written.
    pub at: Written,
}

impl Fmu {
    /// What a channel is made of, where the scenario says it.
    #[must_use]
    pub fn mapped(&self, channel: &Channel) -> Option<&Mapped> {
        self.map.iter().find(|mapped| mapped.channel.name == channel.name)
    }

    /// It gives the motion of the case, and the plant stands on it.
    #[must_use]
    pub fn is_motion(&self) -> bool {
        self.map.iter().any(|mapped| mapped.channel.name.starts_with("case."))
    }
}

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
        // In the shared process nothing can end a call.
        time_limit_s: table.optional_si("time_limit").unwrap_or(f64::INFINITY),
        step_ns: sample_period_ns,
        tolerance: table.node("tolerance").map(|_| table.number("tolerance")).transpose()?,
        settings,
        map: mapped,
        modes: Vec::new(),
        at: Written { place: uri.place, path: uri.path },
    })
}

/// The channels of a map's tables that are given.
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
