//! Faults on connections, resolved in a system: which wires, in which unit, on which condition.

use super::convert::WireUnit;
use super::system::{NumberPath, Spot, System};
use super::values::{is_float, kind_name, limits};
use octant_base::names::nearest;
use octant_faults::catalogue::{FaultParameter, ParameterBounds, Takes};
use octant_faults::connection::kinds::Target;
use octant_faults::connection::{ConnectionFaultSpec, ConnectionStation};
use octant_faults::{FaultBuildError, Value, Values};
use octant_fmu_host::description::{Description, VariableType};
use octant_fmu_host::instance::whole;
use octant_scenario::{ConnectionFault, FileProblems, Given, Problem, quantity_of};

/// Faults of a run, ready to act.
#[derive(Debug)]
pub struct Faulting {
    /// The faults themselves; elements are the numbers of the wires.
    pub station: ConnectionStation,
    /// Condition of each fault that waits for a value of an output.
    pub conditions: Vec<Option<OutputCondition>>,
    /// Steps at which faults are triggered by hand, in order.
    pub fires: Vec<(u64, String)>,
}

/// A condition on an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputCondition {
    /// The output.
    pub spot: Spot,
    /// True if it waits for values above; else below.
    pub above: bool,
    /// The value, in the unit of the output.
    pub value: f64,
    /// Type of the output.
    pub kind: VariableType,
}

impl OutputCondition {
    /// Returns whether the condition holds for a value, as it is exchanged; `None` for NaN.
    #[must_use]
    pub fn holds(&self, value: f64) -> Option<bool> {
        let value = match whole::is_wide(self.kind) {
            true => whole::from_bits(self.kind, value) as f64,
            false => value,
        };
        let holds = if self.above { value > self.value } else { value < self.value };
        (!value.is_nan()).then_some(holds)
    }
}

/// Output that a condition observes: FMU and variable.
pub type Looked = (usize, String);

/// Condition as it is written.
struct Written<'a> {
    node: usize,
    variable: &'a str,
    above: bool,
    value: &'a str,
}

/// Lists the outputs that the conditions of some faults observe, by the names of the FMUs.
///
/// # Errors
/// If a condition isn't valid.
pub fn looked_at(
    faults: &[ConnectionFault],
    file: &str,
    names: &[&str],
) -> Result<Vec<Looked>, FileProblems> {
    let mut all = Vec::new();
    for fault in faults {
        if let Some(when) = &fault.when {
            let written = written(when, names)
                .map_err(|message| of_file(file, fault.problem("trigger", message)))?;
            all.push((written.node, written.variable.to_owned()));
        }
    }
    Ok(all)
}

fn of_file(file: &str, problem: Problem) -> FileProblems {
    FileProblems { file: file.to_owned(), problems: vec![problem] }
}

fn written<'a>(when: &'a str, names: &[&str]) -> Result<Written<'a>, String> {
    let split = [(" above ", true), (" below ", false)]
        .into_iter()
        .find_map(|(word, above)| when.split_once(word).map(|(a, b)| (a.trim(), above, b.trim())));
    let Some((name, above, value)) = split else {
        return Err(format!(
            "found {when:?}, expected an output, above or below, and a value, such as \
             \"plant.truth.gimbal.roll above 45 deg\""
        ));
    };
    // The longest match, because names of FMUs within systems contain dots.
    let node = (0..names.len())
        .filter(|node| name.strip_prefix(names[*node]).is_some_and(|rest| rest.starts_with('.')))
        .max_by_key(|node| names[*node].len());
    match node {
        Some(node) => Ok(Written { node, variable: &name[names[node].len() + 1..], above, value }),
        None => Err(format!(
            "found {when:?}: {name:?} is no output of an FMU; FMUs: {}",
            names.join(", ")
        )),
    }
}

impl Faulting {
    /// Finds the connections of faults in a system.
    ///
    /// # Errors
    /// If a connection isn't there, or can't carry the fault.
    pub fn new(
        faults: &[ConnectionFault],
        file: &str,
        system: &System,
        descriptions: &[&Description],
        seed: u64,
        step_s: f64,
    ) -> Result<Self, FileProblems> {
        let names: Vec<&str> = system.nodes.iter().map(|node| node.name.as_str()).collect();
        let mut specs = Vec::with_capacity(faults.len());
        let mut conditions = Vec::with_capacity(faults.len());
        let mut fires: Vec<(u64, String)> = Vec::new();
        for fault in faults {
            let failed = |problem: Problem| of_file(file, problem);
            specs.push(spec(fault, system).map_err(failed)?);
            conditions.push(match &fault.when {
                Some(when) => {
                    let found = condition(when, &names, system, descriptions);
                    Some(found.map_err(|message| failed(fault.problem("trigger", message)))?)
                }
                None => None,
            });
            fires.extend(fault.fires.iter().map(|at| (*at, fault.id.clone())));
        }
        fires.sort_unstable();
        let station = ConnectionStation::new(&specs, seed, step_s).map_err(|(id, error)| {
            let fault = faults.iter().find(|fault| fault.id == id);
            let (key, message) = match error {
                FaultBuildError::Value { parameter, problem } => (parameter, problem),
                other => ("id", other.to_string()),
            };
            let problem = fault.map(|fault| fault.problem(key, message.clone()));
            of_file(
                file,
                problem.unwrap_or(Problem {
                    place: octant_scenario::Place::Default,
                    path: "faults".to_owned(),
                    message,
                }),
            )
        })?;
        Ok(Self { station, conditions, fires })
    }
}

/// Builds a fault's specification: its wires, and its values in their unit.
fn spec(fault: &ConnectionFault, system: &System) -> Result<ConnectionFaultSpec, Problem> {
    let wires =
        wires(&fault.connection, system).map_err(|message| fault.problem("connection", message))?;
    let mut elements = Vec::with_capacity(wires.len());
    for number in &wires {
        let wire = &system.wires[*number];
        let target = target(wire.conversion.kind());
        let Some(target) = target.filter(|target| target.takes(fault.kind.on)) else {
            let message = format!(
                "{} can't act on {}, which is a {}",
                fault.kind.name,
                wire.target,
                kind_name(wire.conversion.kind())
            );
            return Err(fault.problem("kind", message));
        };
        elements.push((*number, target));
    }
    let mut values = fault.values.clone();
    // All elements are of one variable, or of scalars that were one: the first decides for all.
    if let Some(first) = wires.first().map(|number| &system.wires[*number]) {
        for (parameter, given) in &fault.given {
            let set = given_value(&mut values, parameter, given, first);
            set.map_err(|message| fault.problem(parameter.name, message))?;
        }
    }
    Ok(ConnectionFaultSpec {
        id: fault.id.clone(),
        kind: fault.kind,
        values,
        schedule: fault.schedule.clone(),
        elements,
    })
}

/// Returns the type of an input as a fault's target; `None` if no fault can alter it.
fn target(kind: VariableType) -> Option<Target> {
    Some(match kind {
        VariableType::Float64 => Target::Float64,
        VariableType::Float32 => Target::Float32,
        VariableType::Boolean => Target::Boolean,
        VariableType::Enumeration => Target::Enumeration,
        other => {
            let (from, to) = limits(other)?;
            Target::Integer(from, to)
        }
    })
}

/// Finds wires by the name of their input, or by both ends: `plant.y -> calibrator.u`. The name of
/// an array stands for all its elements.
fn wires(name: &str, system: &System) -> Result<Vec<usize>, String> {
    let (source, target) = match name.split_once("->") {
        Some((source, target)) => (Some(source.trim()), target.trim()),
        None => (None, name.trim()),
    };
    let is = |full: &str, name: &str| {
        full == name || full.strip_prefix(name).is_some_and(|rest| rest.starts_with('['))
    };
    let found: Vec<usize> = (0..system.wires.len())
        .filter(|number| {
            let wire = &system.wires[*number];
            is(&wire.target, target) && source.is_none_or(|source| is(&wire.source, source))
        })
        .collect();
    if !found.is_empty() {
        return Ok(found);
    }
    if system.texts.iter().any(|wire| wire.target == target) {
        return Err(format!("found {name:?}, which carries texts or bytes: faults act on numbers"));
    }
    let targets = system.wires.iter().map(|wire| wire.target.as_str());
    if let Some(source) = source
        && let Some(wire) = system.wires.iter().find(|wire| is(&wire.target, target))
    {
        let other = &wire.source;
        return Err(format!("found {source:?} -> {target:?}, which is connected with {other:?}"));
    }
    Err(match nearest(target, targets.clone()) {
        Some(near) => {
            format!("found {target:?}, which no connection leads to, did you mean {near:?}?")
        }
        None => {
            let some: Vec<&str> = targets.take(8).collect();
            format!(
                "found {target:?}, which no connection leads to; connections lead to {}, …",
                some.join(", ")
            )
        }
    })
}

fn given_value(
    values: &mut Values,
    parameter: &'static FaultParameter,
    given: &Given,
    wire: &NumberPath,
) -> Result<(), String> {
    if let (Takes::Value, Given::Text(text)) = (parameter.takes, given)
        && text == "last"
    {
        return Ok(());
    }
    let kind = wire.conversion.kind();
    let found = match given {
        Given::Number(number) => format!("the number {number}"),
        Given::Text(text) => format!("{text:?}"),
        Given::Flag(flag) => flag.to_string(),
    };
    let wrong = |expected: &str| {
        Err(format!(
            "found {found}, and {} is a {}: expected {expected}",
            wire.target,
            kind_name(kind)
        ))
    };
    let number = match (kind, given) {
        (VariableType::Boolean, Given::Flag(flag)) => f64::from(u8::from(*flag)),
        (VariableType::Boolean, _) => return wrong("true or false"),
        (_, Given::Flag(_)) => return wrong("a number"),
        (VariableType::Enumeration, Given::Text(text)) => {
            let item = wire.items.iter().find(|(_, name)| name == text);
            let names: Vec<&str> = wire.items.iter().map(|(_, name)| name.as_str()).collect();
            match item {
                Some((value, _)) => *value as f64,
                None => return wrong(&format!("one of {}", names.join(", "))),
            }
        }
        (_, Given::Number(number)) => *number,
        (_, Given::Text(text)) => in_unit_of(text, wire.unit.as_ref(), parameter.takes)
            .map_err(|message| format!("found {text:?}, {message}"))?,
    };
    if let Takes::Difference(bounds) = parameter.takes {
        let words = match bounds {
            ParameterBounds::NotZero if number == 0.0 => Some("a value other than 0"),
            ParameterBounds::Positive if !(number > 0.0) => Some("a value above 0"),
            _ => None,
        };
        if let Some(words) = words {
            return Err(format!("found {found}, expected {words}: with it nothing would happen"));
        }
    } else if !is_float(kind) && !super::values::fits(number, kind) {
        return wrong("a value of the type");
    }
    values.set(parameter.name, Value::Number(number));
    Ok(())
}

/// Converts a quantity into a unit.
pub(super) fn in_unit_of(text: &str, unit: Option<&WireUnit>, takes: Takes) -> Result<f64, String> {
    let Some(unit) = unit else {
        return Err("and the variable has no unit: expected a plain number".to_owned());
    };
    let expected = || format!("expected a quantity in {:?} or another unit of the same", unit.name);
    let quantity = quantity_of(text).map_err(|_| expected())?;
    let exponents = quantity.exponents().ok_or_else(expected)?;
    // Some descriptions leave the radian out of angular units.
    let base = unit.bases.iter().find(|base| base.exponents == exponents).or_else(|| {
        unit.bases
            .iter()
            .find(|base| base.exponents[..7] == exponents[..7] && base.exponents[7] == 0)
    });
    let base = base.ok_or_else(expected)?;
    let offset = if matches!(takes, Takes::Value) { base.offset } else { 0.0 };
    Ok((quantity.si - offset) / base.factor)
}

fn condition(
    when: &str,
    names: &[&str],
    system: &System,
    descriptions: &[&Description],
) -> Result<OutputCondition, String> {
    let written = written(when, names)?;
    let description = descriptions[written.node];
    let found = system.output(written.node, written.variable, description).ok_or_else(|| {
        format!("found {when:?}: {} is no number of one element", written.variable)
    })?;
    let (spot, variable) = found;
    let value = match written.value.parse::<f64>() {
        Ok(number) if number.is_finite() => number,
        _ => {
            let unit = WireUnit::of_variable(description, variable);
            in_unit_of(written.value, unit.as_ref(), Takes::Value)
                .map_err(|message| format!("found {when:?}: {:?}, {message}", written.value))?
        }
    };
    Ok(OutputCondition { spot, above: written.above, value, kind: variable.kind })
}
