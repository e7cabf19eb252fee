//! Faults on connections of FMUs: reading of everything that needs no system.

use super::grid::{Grid, Waiting, check_chains};
use super::named;
use super::value::value;
use crate::arguments::fire;
use crate::error::{FileProblems, Place, Problem};
use crate::keys::{ConnectionFaultKeys, ConnectionsKeys, FromTable, Keys, Raw, TriggerKeys};
use crate::read::reader::Reader;
use octant_faults::Values;
use octant_faults::catalogue::{FaultParameter, Takes};
use octant_faults::connection::kinds::{self, ConnectionFaultKind};
use octant_faults::trigger::{Schedule, Trigger};
use octant_toml_tree::{Node, Table, Value as Written, join, number};
use std::path::Path;

/// A fault on a connection, as far as it is known without the system.
#[derive(Clone, Debug)]
pub struct ConnectionFault {
    /// Id.
    pub id: String,
    /// Input that it acts on.
    pub connection: String,
    /// Kind.
    pub kind: &'static ConnectionFaultKind,
    /// Values with the same meaning on every connection.
    pub values: Values,
    /// Values in the unit of the connection.
    pub given: Vec<(&'static FaultParameter, Given)>,
    /// Schedule; with a condition, the part that follows it.
    pub schedule: Schedule,
    /// Condition that it waits for.
    pub when: Option<String>,
    /// Steps at which it is fired by hand, in order.
    pub fires: Vec<u64>,
    /// Places of the fault and its keys.
    places: Vec<(String, Place)>,
    path: String,
}

/// A value in the unit of a connection.
#[derive(Clone, Debug, PartialEq)]
pub enum Given {
    /// A plain number.
    Number(f64),
    /// A quantity, or the name of an item.
    Text(String),
    /// True or false.
    Flag(bool),
}

impl ConnectionFault {
    /// Makes a problem of one of its keys.
    #[must_use]
    pub fn problem(&self, key: &str, message: impl Into<String>) -> Problem {
        let at = |key: &str| self.places.iter().find(|(known, _)| known == key);
        let place = at(key).or_else(|| at("")).map_or(Place::Default, |(_, place)| place.clone());
        Problem { place, path: join(&self.path, key), message: message.into() }
    }

    /// True if its trigger is manual and nobody fires it.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.schedule.trigger == Trigger::Manual && self.fires.is_empty()
    }
}

/// Reads a list of faults on connections for a run of a number of steps of equal length, with `--fire`
/// arguments `ID=TIME` applied. `file` names it in errors.
///
/// # Errors
/// If it isn't TOML or not such a list: every problem with its place.
pub fn connection_faults(
    text: &str,
    file: &str,
    step_s: f64,
    steps: u64,
    fires: &[String],
) -> Result<Vec<ConnectionFault>, FileProblems> {
    let fire_all = |table: &mut Table, problems: &mut Vec<Problem>| {
        problems.extend(fires.iter().filter_map(|argument| fire(table, argument).err()));
    };
    let grid = Grid { period_ns: step_s * 1e9, step: "step" };
    ConnectionsKeys::parse(text, file, fire_all, |keys| read(keys, &grid, steps))
}

fn read(keys: ConnectionsKeys, grid: &Grid, steps: u64) -> Result<Vec<ConnectionFault>, Problem> {
    let tables: Vec<Reader<'_>> = keys.faults.iter().flatten().map(Raw::reader).collect();
    let mut all: Vec<ConnectionFault> = Vec::with_capacity(tables.len());
    for table in &tables {
        let fault = fault(table, grid)?;
        if all.iter().any(|other| other.id == fault.id) {
            let id = &fault.id;
            return Err(
                table.problem("id", format!("found {id:?} a second time, expected unique ids"))
            );
        }
        all.push(fault);
    }
    let waiting: Vec<Waiting<'_>> = all
        .iter()
        .map(|fault| Waiting { id: &fault.id, schedule: &fault.schedule, lasts: fault.kind.lasts })
        .collect();
    check_chains(&tables, &waiting)?;
    for (index, table) in tables.iter().enumerate() {
        let trigger = table.table("trigger")?;
        let late = earliest(&all, index, all.len()).filter(|earliest| *earliest > steps);
        let late = late.or_else(|| all[index].fires.iter().copied().find(|fire| *fire > steps));
        if let Some(late) = late {
            let message = format!(
                "it can't fire: it would set in at {} at the earliest, and the run ends at {}",
                grid.words(late.saturating_sub(1)),
                grid.words(steps)
            );
            return Err(trigger.problem(trigger.first_key(), message));
        }
    }
    Ok(all)
}

fn fault(table: &Reader<'_>, grid: &Grid) -> Result<ConnectionFault, Problem> {
    let ConnectionFaultKeys { id, kind: name, connection, trigger } =
        ConnectionFaultKeys::of(table)?;
    let id = named(&id)?;
    let kind = kinds::named(&name)
        .ok_or_else(|| name.problem(format!("found {:?}, which is no kind", *name)))?;
    let mut places = vec![(String::new(), table.place.clone())];
    let mut values = Values::default();
    let mut given = Vec::new();
    for parameter in kind.parameters {
        let key = parameter.name;
        if let Some(node) = table.node(key).filter(|node| node.place != Place::Default) {
            places.push((key.to_owned(), node.place.clone()));
        }
        match parameter.takes {
            Takes::Value | Takes::Difference(_) => {
                given.push((parameter, self::given(table, key)?))
            }
            _ => values.set(key, value(table, parameter)?),
        }
    }
    for key in ["id", "kind", "connection", "trigger"] {
        if let Some(node) = table.node(key) {
            places.push((key.to_owned(), node.place.clone()));
        }
    }
    let (when, read, fires) = match (&*trigger, grid.trigger(&trigger)?) {
        (_, Some((read, fires))) => (None, read, fires),
        (TriggerKeys::When(keys), None) => {
            let delay = grid.epochs(keys.after);
            (Some(keys.when.value.clone()), Trigger::Outside { delay }, Vec::new())
        }
        (_, None) => return Err(trigger.problem("missing")),
    };
    Ok(ConnectionFault {
        id,
        connection,
        kind,
        values,
        given,
        schedule: grid.schedule(table, kind.lasts, &trigger, (read, &fires))?,
        when,
        fires,
        places,
        path: table.path.clone(),
    })
}

fn given(table: &Reader<'_>, key: &str) -> Result<Given, Problem> {
    match table.node(key) {
        Some(Node { value: Written::Text(text), .. }) => Ok(Given::Text(text.clone())),
        Some(Node { value: Written::Boolean(value), .. }) => Ok(Given::Flag(*value)),
        Some(node) => match number(&node.value) {
            Some(value) => Ok(Given::Number(value)),
            None => Err(table.problem(key, format!("found {}", node.value.describe()))),
        },
        None => Err(table.problem(key, "missing")),
    }
}

/// First step at which a fault can begin, if that is known. `depth` bounds the walk along faults that
/// wait for each other.
fn earliest(all: &[ConnectionFault], index: usize, depth: usize) -> Option<u64> {
    let fault = all.get(index)?;
    match &fault.schedule.trigger {
        Trigger::After { fault: id, delay } => {
            let other = all.iter().position(|other| other.id == *id)?;
            let start = earliest(all, other, depth.checked_sub(1)?)?;
            let schedule = &all[other].schedule;
            let length = schedule.duration.unwrap_or(1).saturating_add(schedule.recovery);
            Some(start.saturating_add(length).saturating_add(*delay))
        }
        Trigger::Outside { delay } => Some(delay.saturating_add(1)),
        Trigger::Manual => fault.fires.first().copied(),
        other => other.earliest(),
    }
}

/// Reads the text of a file of faults.
///
/// # Errors
/// If the file can't be read.
pub fn text_of(path: &Path) -> Result<String, FileProblems> {
    std::fs::read_to_string(path).map_err(|error| FileProblems {
        file: path.display().to_string(),
        problems: vec![Problem {
            place: Place::Unread,
            path: String::new(),
            message: error.to_string(),
        }],
    })
}
