//! The space of a search as a file.

use crate::derived::{RunTimes, as_text, divided, written};
use crate::space::{Form, FormKey, KeyValues, NumberRange, ONSET, ScaledVector, Space};
use octant_base::names::suggestion;
use octant_faults::kinds;
use octant_scenario::quantity_of;
use octant_toml_tree::error::{FileProblems, Place, Problem};
use octant_toml_tree::{Entry, Node, Table, Value, number as plain};
use std::path::Path;

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
    /// It isn't TOML, or a field isn't as it has to be.
    #[error("{0}")]
    Content(FileProblems),
}

/// Reads a space.
///
/// # Errors
/// If the file can't be read, isn't TOML, or has a field that isn't expected; the values of the keys are checked
/// against the scenario when the search begins.
pub fn read(path: &Path, times: RunTimes) -> Result<Space, SpaceError> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|source| SpaceError::Read { file: file.clone(), source })?;
    let problems = match octant_toml_tree::parse(&text).map(|table| space(&table, times)) {
        Ok(Ok(space)) => return Ok(space),
        Ok(Err(problem)) => vec![problem],
        Err(problems) => problems,
    };
    Err(SpaceError::Content(FileProblems { file, problems }))
}

fn space(table: &Table, times: RunTimes) -> Result<Space, Problem> {
    // Where a key is missing, the place is the beginning of the file.
    let place = |key: &str| {
        let node = table.get(key).map(|node| node.place.clone());
        node.unwrap_or(Place::File { line: 1, column: 1 })
    };
    let wrong =
        |key: &str, message: String| Problem { place: place(key), path: key.to_owned(), message };
    match table.get("schema").map(|node| &node.value) {
        Some(Value::Integer(SPACE_SCHEMA)) => {}
        Some(Value::Integer(newer)) if *newer > SPACE_SCHEMA => {
            let problem =
                format!("found {newer}, of a newer version: this program reads {SPACE_SCHEMA}");
            return Err(wrong("schema", problem));
        }
        _ => return Err(wrong("schema", format!("expected schema = {SPACE_SCHEMA}"))),
    }
    let known = ["schema", "title", "faults"];
    if let Some(Entry { key, place, .. }) =
        table.entries.iter().find(|entry| !known.contains(&entry.key.as_str()))
    {
        let message = format!("unknown key, {}", suggestion(key, known.into_iter(), "keys"));
        return Err(Problem { place: place.clone(), path: key.clone(), message });
    }
    let faults = match table.get("faults").map(|node| &node.value) {
        Some(Value::Array(all)) if !all.is_empty() => all,
        _ => return Err(wrong("faults", "expected one [[faults]] or more".to_owned())),
    };
    let forms = faults.iter().enumerate().map(|(number, fault)| form(number, fault, times));
    Ok(Space { forms: forms.collect::<Result<_, _>>()? })
}

fn form(number: usize, fault: &Node, times: RunTimes) -> Result<Form, Problem> {
    let wrong = |place: &Place, key: &str, message: String| Problem {
        place: place.clone(),
        path: format!("faults[{}].{key}", number + 1),
        message,
    };
    let Value::Table(table) = &fault.value else {
        return Err(wrong(&fault.place, "", "expected a table".to_owned()));
    };
    let place = |key: &str| table.get(key).map_or(&fault.place, |node| &node.place);
    let name = table.get("kind").and_then(|node| as_text(&node.value));
    let name =
        name.ok_or_else(|| wrong(place("kind"), "kind", "expected the name of a kind".to_owned()))?;
    let kind = kinds::named(name).ok_or_else(|| {
        let names: Vec<&str> = kinds::all().map(|kind| kind.name).collect();
        let known = suggestion(name, names.iter().copied(), "kinds");
        wrong(place("kind"), "kind", format!("found {name:?}, which is no kind, {known}"))
    })?;
    if table.get("id").is_some() {
        return Err(wrong(
            place("id"),
            "id",
            "found an id, which a search gives itself".to_owned(),
        ));
    }
    if table.get(ONSET).is_some() == table.get("trigger").is_some() {
        let message = "expected either onset, a time or a range of times, or a trigger".to_owned();
        return Err(wrong(place(ONSET), ONSET, message));
    }
    let keys = table.entries.iter().filter(|entry| entry.key != "kind").map(|entry| {
        values(&entry.key, &entry.node.value, times)
            .map(|values| FormKey { name: entry.key.clone(), values })
            .map_err(|message| wrong(&entry.node.place, &entry.key, message))
    });
    let mut keys: Vec<FormKey> = keys.collect::<Result<_, _>>()?;
    // In the order of the kind's parameters, so that the first range is the size of the fault; others by their names.
    keys.sort_by(|a, b| a.name.cmp(&b.name));
    let order = |key: &FormKey| kind.parameters.iter().position(|p| p.name == key.name);
    keys.sort_by_key(|key| order(key).unwrap_or(usize::MAX));
    Ok(Form { kind, keys })
}

fn values(key: &str, value: &Value, times: RunTimes) -> Result<KeyValues, String> {
    let Value::Table(table) = value else { return Ok(KeyValues::Fixed(written(value))) };
    if key == "trigger" && table.get("one_of").is_none() {
        return Ok(KeyValues::Fixed(written(value)));
    }
    if let Some(all) = table.get("one_of") {
        return match &all.value {
            Value::Array(all) if !all.is_empty() && table.entries.len() == 1 => {
                Ok(KeyValues::OneOf(all.iter().map(|node| written(&node.value)).collect()))
            }
            _ => Err("expected { one_of = [VALUE, ...] } and nothing else".to_owned()),
        };
    }
    if let Some(vector) = table.get("times") {
        let factor = range("times", table, &["times", "from", "to", "scale"])?;
        return scaled(&vector.value, factor).map(KeyValues::Multiple);
    }
    let range = range(key, table, &["from", "to", "scale"])?;
    if key == ONSET && range.to * factor(&range.unit) > times.length_s {
        return Err(format!("found an onset after the end of the run, {} s", times.length_s));
    }
    Ok(KeyValues::Between(range))
}

/// A vector of numbers, with units where they are texts.
fn scaled(vector: &Value, factor: NumberRange) -> Result<ScaledVector, String> {
    let all = match vector {
        Value::Array(all) if !all.is_empty() => all,
        _ => return Err("times: expected a vector".to_owned()),
    };
    if !factor.unit.is_empty() {
        return Err(format!("found a factor in {}, expected numbers", factor.unit));
    }
    let components = all.iter().map(|node| number(&node.value)).collect::<Result<_, _>>()?;
    Ok(ScaledVector { components, factor: NumberRange { is_whole: false, ..factor } })
}

/// Reads `from`, `to` and `scale`.
fn range(key: &str, table: &Table, known: &[&str]) -> Result<NumberRange, String> {
    if let Some(Entry { key: other, .. }) =
        table.entries.iter().find(|entry| !known.contains(&entry.key.as_str()))
    {
        let known = suggestion(other, known.iter().copied(), "keys");
        return Err(format!("unknown key {other:?}, {known}"));
    }
    let value = |key: &str| table.get(key).map(|node| &node.value);
    let (Some(from), Some(to)) = (value("from"), value("to")) else {
        return Err("expected a value, { one_of = [...] } or { from = ..., to = ... }".to_owned());
    };
    let is_whole = matches!((from, to), (Value::Integer(_), Value::Integer(_)));
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
    let is_logarithmic = match value("scale").map(as_text) {
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
    if let Some(number) = plain(value).filter(|number| number.is_finite()) {
        return Ok((number, String::new()));
    }
    match divided(as_text(value).unwrap_or_default()) {
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
