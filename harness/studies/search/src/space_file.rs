//! The space of a search as a file.

use super::derived::written;
use crate::derived::{RunTimes, divided};
use crate::space::{Form, FormKey, KeyValues, NumberRange, ONSET, ScaledVector, Space};
use octant_base::names::suggestion;
use octant_faults::kinds;
use octant_scenario::quantity_of;
use std::path::Path;
use toml::{Table, Value};

/// Version of the file of a space.
pub const SPACE_SCHEMA: i64 = 1;
/// Significant digits of a value within a range.
const DIGITS: i32 = 3;
/// Those of an onset.
const ONSET_DIGITS: i32 = 6;

/// Reasons why a file gave no space.
#[derive(Debug, thiserror::Error)]
pub enum SpaceError {
    /// The file can't be read.
    #[error("{file}: {source}")]
    Read {
        /// The file.
        file: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// It isn't TOML.
    #[error("{file}: {source}")]
    Toml {
        /// The file.
        file: String,
        /// Place and problem.
        source: Box<toml::de::Error>,
    },
    /// A field isn't as it has to be.
    #[error("{file}: {field}: {problem}")]
    Field {
        /// The file.
        file: String,
        /// The field, such as `faults[2].amplitude`.
        field: String,
        /// What was found and what was expected.
        problem: String,
    },
}

/// A field and its problem.
type Wrong = (String, String);

/// Reads a space.
///
/// # Errors
/// If the file can't be read, isn't TOML, or has a field that isn't expected; the values of the keys are checked
/// against the scenario when the search begins.
pub fn read(path: &Path, times: RunTimes) -> Result<Space, SpaceError> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|source| SpaceError::Read { file: file.clone(), source })?;
    let table: Table = text
        .parse()
        .map_err(|source| SpaceError::Toml { file: file.clone(), source: Box::new(source) })?;
    space(&table, times).map_err(|(field, problem)| SpaceError::Field { file, field, problem })
}

fn space(table: &Table, times: RunTimes) -> Result<Space, Wrong> {
    let wrong = |field: &str, problem: String| (field.to_owned(), problem);
    match table.get("schema").and_then(Value::as_integer) {
        Some(SPACE_SCHEMA) => {}
        Some(newer) if newer > SPACE_SCHEMA => {
            let problem =
                format!("found {newer}, of a newer version: this program reads {SPACE_SCHEMA}");
            return Err(wrong("schema", problem));
        }
        _ => return Err(wrong("schema", format!("expected schema = {SPACE_SCHEMA}"))),
    }
    if let Some(key) =
        table.keys().find(|key| !["schema", "title", "faults"].contains(&key.as_str()))
    {
        let known = suggestion(key, ["schema", "title", "faults"].into_iter(), "keys");
        return Err(wrong(key, format!("unknown key, {known}")));
    }
    let faults = table.get("faults").and_then(Value::as_array).filter(|all| !all.is_empty());
    let faults =
        faults.ok_or_else(|| wrong("faults", "expected one [[faults]] or more".to_owned()))?;
    let forms = faults.iter().enumerate().map(|(place, fault)| form(place, fault, times));
    Ok(Space { forms: forms.collect::<Result<_, _>>()? })
}

fn form(place: usize, fault: &Value, times: RunTimes) -> Result<Form, Wrong> {
    let field = |key: &str| format!("faults[{}].{key}", place + 1);
    let table = fault.as_table().ok_or_else(|| (field(""), "expected a table".to_owned()))?;
    let name = table.get("kind").and_then(Value::as_str);
    let name = name.ok_or_else(|| (field("kind"), "expected the name of a kind".to_owned()))?;
    let kind = kinds::named(name).ok_or_else(|| {
        let names: Vec<&str> = kinds::all().map(|kind| kind.name).collect();
        let known = suggestion(name, names.iter().copied(), "kinds");
        (field("kind"), format!("found {name:?}, which is no kind, {known}"))
    })?;
    if table.contains_key("id") {
        return Err((field("id"), "found an id, which a search gives itself".to_owned()));
    }
    if table.contains_key(ONSET) == table.contains_key("trigger") {
        let problem = "expected either onset, a time or a range of times, or a trigger".to_owned();
        return Err((field(ONSET), problem));
    }
    let keys = table.iter().filter(|(key, _)| *key != "kind").map(|(key, value)| {
        values(key, value, times)
            .map(|values| FormKey { name: key.clone(), values })
            .map_err(|problem| (field(key), problem))
    });
    let mut keys: Vec<FormKey> = keys.collect::<Result<_, _>>()?;
    // In the order of the kind's parameters, so that the first range is the size of the fault.
    let order = |key: &FormKey| kind.parameters.iter().position(|p| p.name == key.name);
    keys.sort_by_key(|key| order(key).unwrap_or(usize::MAX));
    Ok(Form { kind, keys })
}

fn values(key: &str, value: &Value, times: RunTimes) -> Result<KeyValues, String> {
    let Some(table) = value.as_table() else { return Ok(KeyValues::Fixed(written(value))) };
    if key == "trigger" && !table.contains_key("one_of") {
        return Ok(KeyValues::Fixed(written(value)));
    }
    if let Some(all) = table.get("one_of") {
        return match all.as_array().map(Vec::as_slice) {
            Some(all @ [_, ..]) if table.len() == 1 => {
                Ok(KeyValues::OneOf(all.iter().map(written).collect()))
            }
            _ => Err("expected { one_of = [VALUE, ...] } and nothing else".to_owned()),
        };
    }
    if let Some(vector) = table.get("times") {
        let factor = range("times", table, &["times", "from", "to", "scale"])?;
        return scaled(vector, factor).map(KeyValues::Multiple);
    }
    let range = range(key, table, &["from", "to", "scale"])?;
    if key == ONSET && range.to * factor(&range.unit) > times.length_s {
        return Err(format!("found an onset after the end of the run, {} s", times.length_s));
    }
    Ok(KeyValues::Between(range))
}

/// A vector of numbers, with units where they are texts.
fn scaled(vector: &Value, factor: NumberRange) -> Result<ScaledVector, String> {
    let all = vector.as_array().filter(|all| !all.is_empty());
    let all = all.ok_or_else(|| "times: expected a vector".to_owned())?;
    if !factor.unit.is_empty() {
        return Err(format!("found a factor in {}, expected numbers", factor.unit));
    }
    let components = all.iter().map(number).collect::<Result<_, _>>()?;
    Ok(ScaledVector { components, factor: NumberRange { is_whole: false, ..factor } })
}

/// Reads `from`, `to` and `scale`.
fn range(key: &str, table: &Table, known: &[&str]) -> Result<NumberRange, String> {
    if let Some(other) = table.keys().find(|key| !known.contains(&key.as_str())) {
        let known = suggestion(other, known.iter().copied(), "keys");
        return Err(format!("unknown key {other:?}, {known}"));
    }
    let (Some(from), Some(to)) = (table.get("from"), table.get("to")) else {
        return Err("expected a value, { one_of = [...] } or { from = ..., to = ... }".to_owned());
    };
    let scale = table.get("scale");
    let is_whole = from.is_integer() && to.is_integer();
    let ((from, unit_from), (to, unit)) = (number(from)?, number(to)?);
    let same = unit_from.is_empty() == unit.is_empty()
        && (unit.is_empty() || one(&unit_from)?.same_dimension(one(&unit)?));
    if !same {
        return Err(format!("found {unit_from:?} and {unit:?}, expected one dimension"));
    }
    let from = if unit_from == unit { from } else { from * factor(&unit_from) / factor(&unit) };
    if !(from < to) {
        return Err(format!("found from {from} to {to} {unit}, expected a larger end"));
    }
    let both_above = from > 0.0;
    let is_logarithmic = match scale.map(Value::as_str) {
        None => both_above && key != ONSET,
        Some(Some("linear")) => false,
        Some(Some("log")) if both_above => true,
        Some(Some("log")) => {
            return Err(format!("found scale \"log\" from {from}, expected ends above zero"));
        }
        Some(_) => return Err("scale: expected \"linear\" or \"log\"".to_owned()),
    };
    let digits = if key == ONSET { ONSET_DIGITS } else { DIGITS };
    Ok(NumberRange { from, to, unit, is_logarithmic, is_whole, digits })
}

/// A number, with its unit where it is a text.
fn number(value: &Value) -> Result<(f64, String), String> {
    let plain = value.as_float().or(value.as_integer().map(|whole| whole as f64));
    if let Some(number) = plain.filter(|number| number.is_finite()) {
        return Ok((number, String::new()));
    }
    let text = value.as_str().unwrap_or_default();
    match divided(text) {
        Some((number, unit)) if number.is_finite() && one(unit).is_ok() => {
            Ok((number, unit.to_owned()))
        }
        _ => Err(format!("found {}, expected a number, or a number and a unit", written(value))),
    }
}

/// One of a unit.
fn one(unit: &str) -> Result<octant_scenario::Quantity, String> {
    quantity_of(&format!("1 {unit}")).map_err(|_| format!("found the unknown unit {unit:?}"))
}

/// Size of a unit, SI; 1 for a plain number.
fn factor(unit: &str) -> f64 {
    if unit.is_empty() { 1.0 } else { one(unit).map_or(1.0, |quantity| quantity.si) }
}

/// Writes a space as a file, which [`read`] reads.
#[must_use]
pub fn to_toml(space: &Space) -> String {
    let mut out = format!("schema = {SPACE_SCHEMA}\n");
    for form in &space.forms {
        out += &format!("\n[[faults]]\nkind = {:?}\n", form.kind.name);
        for key in &form.keys {
            let values = match &key.values {
                KeyValues::Fixed(text) => text.clone(),
                KeyValues::OneOf(texts) => format!("{{ one_of = [{}] }}", texts.join(", ")),
                KeyValues::Between(range) => format!("{{ {} }}", range_text(range)),
                KeyValues::Multiple(vector) => {
                    let one = |(number, unit): &(f64, String)| end(*number, unit, false);
                    let all: Vec<String> = vector.components.iter().map(one).collect();
                    format!("{{ times = [{}], {} }}", all.join(", "), range_text(&vector.factor))
                }
            };
            out += &format!("{} = {values}\n", key.name);
        }
    }
    out
}

fn range_text(range: &NumberRange) -> String {
    let scale = if range.is_logarithmic { "log" } else { "linear" };
    let end = |value| end(value, &range.unit, range.is_whole);
    format!("from = {}, to = {}, scale = {scale:?}", end(range.from), end(range.to))
}

fn end(value: f64, unit: &str, is_whole: bool) -> String {
    match (unit, is_whole) {
        ("", true) => format!("{value}"),
        ("", false) => format!("{value:?}"),
        (unit, _) => format!("\"{value} {unit}\""),
    }
}
