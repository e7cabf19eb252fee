//! Faults: from checked keys to what the station is built with, and what can be known before the
//! run about whether they can act at all.

pub mod connection;
mod grid;
mod schedule;

use super::Reader;
use super::source::Source;
use crate::document::{Node, Value as Written};
use crate::error::{Place, Problem};
use crate::{Endpoint, Method, Scenario, keys, quantity};
use grid::{Waiting, check_chains};
use octant_faults::catalogue::{Acts, Kind, Parameter, Takes};
use octant_faults::kinds::host::{FULL, STARVED};
use octant_faults::kinds::wire::happens_on;
use octant_faults::station::Spec;
use octant_faults::wire::Medium;
use octant_faults::{BuildError, Channels, Setup, Station, Value, Values, kinds};
use octant_link::Uri;
use schedule::Timing;

/// A fault of a scenario.
#[derive(Clone, Debug)]
pub struct Fault {
    /// What the station is built with.
    pub spec: Spec,
    /// Epochs at which it is fired by hand, in order. Empty where its trigger isn't manual, or
    /// where nobody fires it.
    pub fires: Vec<u64>,
    /// Where it was written.
    pub place: Place,
}

impl Scenario {
    /// What faults have to know of a run of one of the methods.
    #[must_use]
    pub fn fault_setup(&self, seed: u64) -> Setup {
        Setup {
            seed,
            sample_period_ns: self.sample_period_ns,
            calibration_samples: self.calibration_samples(),
            angle_random_walk: self.imu.angle_random_walk,
            velocity_random_walk: self.imu.velocity_random_walk,
            turntable_rate_radps: self.turntable.rate_radps,
            id: String::new(),
        }
    }

    /// The station of a run with a seed; `None` without faults.
    ///
    /// # Errors
    /// If a fault can't be built; a scenario that was read has only faults that can.
    pub fn station(&self, seed: u64) -> Result<Option<Station>, (String, BuildError)> {
        if self.faults.is_empty() {
            return Ok(None);
        }
        let specs: Vec<Spec> = self.faults.iter().map(|fault| fault.spec.clone()).collect();
        Station::new(&specs, &self.fault_setup(seed)).map(Some)
    }

    /// What is worth telling before a run, though it is no error.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        use octant_faults::trigger::Trigger;
        let idle = |fault: &&Fault| {
            fault.spec.schedule.trigger == Trigger::Manual && fault.fires.is_empty()
        };
        let text = |fault: &Fault| {
            let id = &fault.spec.id;
            format!("fault {id:?} is fired by hand, and no --fire {id}=TIME does: it won't fire")
        };
        self.faults.iter().filter(idle).map(text).collect()
    }
}

/// Reads the faults of a scenario whose other fields are read already.
pub(super) fn read(root: &Reader<'_>, scenario: &Scenario) -> Result<Vec<Fault>, Problem> {
    let tables = root.tables("faults");
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
    // One by one first: the problem then has its place.
    for (table, fault) in tables.iter().zip(&all) {
        let setup = Setup { id: fault.spec.id.clone(), ..scenario.fault_setup(scenario.seed) };
        (fault.spec.kind.build)(&fault.spec.values, &setup).map_err(|e| build(table, &e))?;
    }
    let specs: Vec<Spec> = all.iter().map(|fault| fault.spec.clone()).collect();
    match Station::new(&specs, &scenario.fault_setup(scenario.seed)) {
        Ok(_) => Ok(all),
        Err((id, error)) => {
            let at = all.iter().position(|fault| fault.spec.id == id).unwrap_or_default();
            Err(tables.get(at).map_or_else(
                || root.problem("faults", error.to_string()),
                |table| build(table, &error),
            ))
        }
    }
}

/// A kind's own refusal, at the parameter that it names.
fn build(table: &Reader<'_>, error: &BuildError) -> Problem {
    match error {
        BuildError::Value { parameter, problem } => table.problem(parameter, problem.clone()),
        other => table.problem("id", other.to_string()),
    }
}

fn fault(table: &Reader<'_>, scenario: &Scenario, timing: &Timing) -> Result<Fault, Problem> {
    let id = table.text("id")?;
    if id.trim().is_empty() {
        return Err(table.problem("id", "found an empty text, expected a name"));
    }
    let name = table.text("kind")?;
    let kind = kinds::named(name)
        .ok_or_else(|| table.problem("kind", format!("found {name:?}, which is no kind")))?;
    if let Some(why) = impossible(kind, &scenario.source) {
        return Err(table.problem("kind", format!("{name} {why}")));
    }
    if kind.acts == Acts::Command
        && matches!(scenario.source, Source::Live(_))
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
    let mut values = Values::default();
    for parameter in kind.parameters {
        values.set(parameter.name, value(table, parameter)?);
    }
    let (schedule, fires) = timing.schedule(table, kind)?;
    Ok(Fault {
        spec: Spec { id: id.to_owned(), kind, values, schedule },
        fires,
        place: table.place.clone(),
    })
}

/// Why a kind can't act on a source.
fn impossible(kind: &Kind, source: &Source) -> Option<&'static str> {
    match (kind.acts, source) {
        (Acts::Plant, _) if source.has_plant() => None,
        (Acts::Plant, Source::Fmu(_)) => Some(
            "acts inside the simulated instrument, and the source is an FMU, into which it doesn't \
             reach",
        ),
        (Acts::Plant, Source::Live(_)) => {
            Some("acts inside the simulated instrument, and the source is a real one")
        }
        (Acts::Plant, _) => Some(
            "acts inside the simulated instrument, and the source is a recording: what it holds has \
             happened",
        ),
        (Acts::Command, _) if source.is_recorded() => Some(
            "acts on the set points of the simulated turntable, and the source is a recording: what \
             it holds has happened",
        ),
        _ => None,
    }
}

/// Why a kind can't act on the way to an endpoint.
fn without_wire(kind: &Kind, endpoint: &Endpoint) -> Option<String> {
    if kind.acts != Acts::Wire {
        return None;
    }
    let Endpoint::Live(live) = endpoint else {
        return Some(
            "acts on the wire to a device, and there is none: endpoint.uri names no port"
                .to_owned(),
        );
    };
    let medium = match live.uri {
        Uri::Serial(_) | Uri::Pty { .. } => Medium::Line,
        Uri::Udp(_) => Medium::Datagrams,
        Uri::Can(_) | Uri::Slcan(_) => Medium::Bus,
    };
    (!happens_on(kind, medium))
        .then(|| format!("doesn't happen on {}, which endpoint.uri names", medium.name()))
}

/// Why nothing would come of a kind of the host, and the key that says so.
fn on_this_host(
    kind: &Kind,
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

/// The value of a parameter. What the check has passed is there.
fn value(table: &Reader<'_>, parameter: &'static Parameter) -> Result<Value, Problem> {
    let key = parameter.name;
    let missing = || table.problem(key, "missing");
    Ok(match parameter.takes {
        Takes::Quantity(dimensions, _) => {
            let quantity = quantity::parse(table.text(key)?).map_err(|_| missing())?;
            let fits = |of: &&_| quantity.is(keys::dimension(of));
            let dimension = dimensions.iter().find(fits).ok_or_else(missing)?;
            Value::Quantity(quantity.si, *dimension)
        }
        Takes::Vector(dimensions) => {
            let texts = table.texts(key);
            let all: Option<Vec<_>> = texts.iter().map(|text| quantity::parse(text).ok()).collect();
            let all = all.filter(|all| all.len() == 3).ok_or_else(missing)?;
            let fits = |of: &&_| all.iter().all(|quantity| quantity.is(keys::dimension(of)));
            let dimension = dimensions.iter().find(fits).ok_or_else(missing)?;
            Value::Vector(std::array::from_fn(|axis| all[axis].si), *dimension)
        }
        Takes::Integer(..) => Value::Integer(table.integer(key)?),
        Takes::Flag => Value::Flag(table.boolean(key)?),
        Takes::Choice(choices) => {
            let text = table.text(key)?;
            let found = choices.iter().find(|(name, _)| *name == text).ok_or_else(missing)?;
            Value::Choice(found.0)
        }
        Takes::Channels => {
            let names = match table.node(key) {
                Some(Node { value: Written::Array(_), .. }) => table.texts(key),
                _ => vec![table.text(key)?],
            };
            let sets: Option<Vec<_>> = names.into_iter().map(Channels::named).collect();
            let set = sets.and_then(|sets| sets.into_iter().reduce(Channels::union));
            Value::Channels(set.ok_or_else(missing)?)
        }
        Takes::Number(_) => Value::Number(table.number(key)?),
        Takes::Value | Takes::Difference(_) => {
            return Err(table.problem(key, "only connections of FMUs have such values"));
        }
    })
}

/// The stops of a method, in the words of messages.
fn method_name(method: Method) -> &'static str {
    match method {
        Method::Primary => "the calibration",
        Method::Baseline => "the calibration of the baseline",
    }
}
