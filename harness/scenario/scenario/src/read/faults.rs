//! Reads faults: conversion of checked keys to specifications for the station, and checks before the run that
//! they can act.

pub mod connection;
mod grid;
mod schedule;
mod value;

use super::power;
use super::reader::Reader;
use crate::error::Problem;
use crate::keys::{At, FaultKeys, FromTable, OperatorKeys, Raw};
use crate::model::{EndpointSpec, Fault, Scenario, SourceSpec};
use grid::{Waiting, check_chains};
use octant_faults::catalogue::{Acts, FaultKind};
use octant_faults::kinds::host::{FULL, STARVED};
use octant_faults::kinds::wire::happens_on;
use octant_faults::station::FaultSpec;
use octant_faults::{FaultBuildError, Setup, Station, Values, kinds};
use octant_operator::step::runs_on;
use octant_operator::{OperatorStep, StepParts};
use schedule::Timing;
use value::value;

/// Reads the faults of a scenario whose other fields were already read.
pub(super) fn read(
    faults: &At<Option<Vec<Raw>>>,
    scenario: &Scenario,
) -> Result<Vec<Fault>, Problem> {
    let tables: Vec<Reader<'_>> = faults.iter().flatten().map(Raw::reader).collect();
    let timing = Timing::of(scenario);
    let mut all: Vec<Fault> = Vec::with_capacity(tables.len());
    for table in &tables {
        let fault = fault(table, scenario, &timing)?;
        if all.iter().any(|other| other.spec.id == fault.spec.id) {
            let id = &fault.spec.id;
            return Err(
                table.problem("id", format!("found {id:?} a second time, expected unique ids"))
            );
        }
        all.push(fault);
    }
    let waiting: Vec<Waiting<'_>> = all
        .iter()
        .map(|fault| Waiting {
            id: &fault.spec.id,
            schedule: &fault.spec.schedule,
            lasts: fault.spec.kind.lasts,
        })
        .collect();
    check_chains(&tables, &waiting)?;
    for (index, table) in tables.iter().enumerate() {
        timing.check(table, &all, index)?;
    }
    // Each fault is built separately first, so that a problem has its place.
    for (table, fault) in tables.iter().zip(&all) {
        let setup = Setup { id: fault.spec.id.clone(), ..scenario.fault_setup(scenario.seed) };
        (fault.spec.kind.build)(&fault.spec.values, &setup).map_err(|e| build(table, &e))?;
    }
    let specs: Vec<FaultSpec> = all.iter().map(|fault| fault.spec.clone()).collect();
    match Station::new(&specs, &scenario.fault_setup(scenario.seed)) {
        Ok(_) => Ok(all),
        Err((id, error)) => {
            let at = all.iter().position(|fault| fault.spec.id == id).unwrap_or_default();
            Err(tables
                .get(at)
                .map_or_else(|| faults.problem(error.to_string()), |table| build(table, &error)))
        }
    }
}

/// Reads the steps of a person, whose triggers are those of faults.
pub(super) fn steps(
    tables: &At<Option<Vec<Raw>>>,
    scenario: &Scenario,
) -> Result<Vec<OperatorStep>, Problem> {
    let runs_on = runs_on(scenario.source.instrument().is_some(), scenario.realtime.by_clock);
    let (timing, mut all) = (Timing::of(scenario), Vec::<OperatorStep>::new());
    // Between the run-ups of a unit that sends a solution, time goes on.
    let line_s = scenario.line_s().filter(|_| matches!(scenario.source, SourceSpec::Solution(_)));
    let of_line = line_s.map(|s| ((s * 1e9).round() as u64) / scenario.sample_period_ns);
    let last = of_line.or_else(|| scenario.samples());
    for table in tables.iter().flatten().map(Raw::reader) {
        let keys = OperatorKeys::of(&table)?;
        let parts = StepParts {
            trigger: keys.trigger.as_ref().map(|keys| timing.once(&table, keys)).transpose()?,
            id: keys.id,
            ask: keys.ask,
            kind: keys.answer,
            unit: keys.unit,
            bounds: [keys.least, keys.most],
            choices: keys.choices,
            on_no: keys.on_no,
            timeout_s: keys.timeout,
            on_timeout: keys.on_timeout,
            named: keys.who,
            holds: keys.hold,
        };
        let step = OperatorStep::new(parts, &all, runs_on, last);
        all.push(step.map_err(|(key, message)| table.problem(key, message))?);
    }
    Ok(all)
}

/// Problem of a kind's refusal, at the parameter that it names.
fn build(table: &Reader<'_>, error: &FaultBuildError) -> Problem {
    match error {
        FaultBuildError::Value { parameter, problem } => table.problem(parameter, problem.clone()),
        other => table.problem("id", other.to_string()),
    }
}

fn fault(table: &Reader<'_>, scenario: &Scenario, timing: &Timing) -> Result<Fault, Problem> {
    let FaultKeys { id, kind: name, trigger } = FaultKeys::of(table)?;
    let (id, name) = (named(&id)?, name.as_str());
    let kind = kinds::named(name)
        .ok_or_else(|| table.problem("kind", format!("found {name:?}, which is no kind")))?;
    if let Some(why) = impossible(kind, &scenario.source) {
        return Err(table.problem("kind", format!("{name} {why}")));
    }
    if kind.acts == Acts::Command
        && scenario.source.instrument().is_some()
        && scenario.drive.is_none()
    {
        let message = format!(
            "{name} acts on set points on their way to a turntable, and this program turns none: the \
             source is a real instrument, and there is no turntable.drive"
        );
        return Err(table.problem("kind", message));
    }
    if let Some(why) = without_wire(kind, &scenario.endpoint) {
        return Err(table.problem("kind", format!("{name} {why}")));
    }
    if let Some((key, why)) = on_this_host(kind, scenario, table) {
        return Err(table.problem(key, format!("{name} {why}")));
    }
    if let Some((key, why)) = power::without_power(kind, scenario, table) {
        return Err(table.problem(key, format!("{name} {why}")));
    }
    let mut values = Values::default();
    for parameter in kind.parameters {
        values.set(parameter.name, value(table, parameter)?);
    }
    let (schedule, fires) = timing.schedule(table, kind, &trigger)?;
    Ok(Fault { spec: FaultSpec { id, kind, values, schedule }, fires, place: table.place.clone() })
}

/// Id of a fault, which isn't empty.
fn named(id: &At<String>) -> Result<String, Problem> {
    if id.trim().is_empty() {
        return Err(id.problem("found an empty text, expected a name"));
    }
    Ok(id.value.clone())
}

/// Reason why a kind can't act on a source.
fn impossible(kind: &FaultKind, source: &SourceSpec) -> Option<&'static str> {
    match kind.acts {
        Acts::Plant if source.has_plant() => None,
        Acts::Plant if source.fmu().is_some() => Some(
            "acts inside the simulated instrument, and the source is an FMU, into which it doesn't \
             reach",
        ),
        Acts::Plant if source.instrument().is_some() => {
            Some("acts inside the simulated instrument, and the source is a real one")
        }
        Acts::Plant => Some(
            "acts inside the simulated instrument, and the source is a recording: what it holds has \
             happened",
        ),
        Acts::Command if source.is_recorded() => Some(
            "acts on the set points of the simulated turntable, and the source is a recording: what \
             it holds has happened",
        ),
        _ => None,
    }
}

/// Reason why a kind can't act on the way to an endpoint.
fn without_wire(kind: &FaultKind, endpoint: &EndpointSpec) -> Option<String> {
    if kind.acts != Acts::Wire {
        return None;
    }
    let Some(live) = endpoint.device() else {
        return Some(
            "acts on the wire to a device, and there is none: endpoint.uri names no port"
                .to_owned(),
        );
    };
    let medium = live.uri.medium();
    (!happens_on(kind, medium))
        .then(|| format!("doesn't happen on {}, which endpoint.uri names", medium.name()))
}

/// Reason why a kind that acts on the host would have no effect, with its key.
fn on_this_host(
    kind: &FaultKind,
    scenario: &Scenario,
    table: &Reader<'_>,
) -> Option<(&'static str, &'static str)> {
    if kind.name == STARVED.name && !scenario.realtime.by_clock {
        return Some((
            "kind",
            "makes samples late that leave by the clock, and these don't: expected realtime.pace = \
             \"clock\", or `octant run --realtime`",
        ));
    }
    if kind.name == FULL.name && table.node("repeat").is_some() {
        return Some(("repeat", "ends the run: the disk stays full, expected no repetition"));
    }
    None
}
