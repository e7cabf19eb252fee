//! The space that the catalogue of faults gives: every kind, around the values of its example.

use crate::space::{Form, FormKey, KeyValues, NumberRange, ONSET, ScaledVector, Space};
use octant_faults::catalogue::{Acts, FaultKind, Lasts, ParameterBounds, Takes};
use octant_faults::kinds;
use octant_scenario::{fault_dimension, fault_example, quantity_of};
use octant_toml_tree::{Entry, Node, Value, number};

/// Ratio of the ends of a range to the value of the example.
const AROUND: f64 = 1000.0;
/// Largest whole number that is tried where a kind takes more.
const WHOLE_MAX: f64 = 10_000.0;
/// Significant digits of a time, of which a move is a short part.
const TIME_DIGITS: i32 = 5;
const DIGITS: i32 = 3;

/// Run in which the faults of a space set in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunTimes {
    /// Period of the samples, s.
    pub sample_s: f64,
    /// Length of the run, s.
    pub length_s: f64,
}

/// Kinds that a search can draw from: those that act on samples and on what makes them, not on a wire or on the
/// host, whose effects are not those of the seed alone.
pub fn searchable() -> impl Iterator<Item = &'static FaultKind> {
    kinds::all().filter(|kind| !matches!(kind.acts, Acts::Wire | Acts::Host | Acts::Power))
}

/// Makes the space of some kinds: sizes from a thousandth of the example's to a thousand times of it within the
/// bounds of the kind, durations from a sample to the whole run, onsets anywhere in it, each channel alone and
/// each triad.
#[must_use]
pub fn derived(kinds: &[&'static FaultKind], times: RunTimes) -> Space {
    let forms = kinds.iter().flat_map(|kind| forms_of(kind, times)).collect();
    Space { forms }
}

/// A form for each dimension that the parameters of a kind can have: gyros and accelerometers apart.
fn forms_of(kind: &'static FaultKind, times: RunTimes) -> Vec<Form> {
    let example = fault_example(kind.name).unwrap_or_default();
    let example = example.strip_prefix("[[faults]]\n").unwrap_or(&example);
    let Ok(example) = octant_toml_tree::read(example) else { return Vec::new() };
    let dimensions = |parameter: &octant_faults::catalogue::FaultParameter| match parameter.takes {
        Takes::Quantity(all, _) => all.len(),
        _ => 1,
    };
    let has_channels = kind.parameters.iter().any(|p| p.takes == Takes::Channels);
    let most = kind.parameters.iter().map(dimensions).max().unwrap_or(1);
    let triads = most.max(if has_channels { 2 } else { 1 });
    // A vector along one axis is tried along each.
    let has_axis = kind.parameters.iter().any(|p| {
        let vector = example.get(p.name).and_then(|node| vector(&node.value, 0));
        vector.is_some_and(|vector| non_zero(&vector) == 1)
    });
    let turns = if has_axis { 3 } else { 1 };
    (0..triads * turns)
        .map(|form| (form / turns, form % turns))
        .map(|(triad, turn)| {
            let given = |name: &str| example.get(name).map(|node| &node.value);
            let of = |p: &'static octant_faults::catalogue::FaultParameter| {
                values(p, [triad, turn], given(p.name), times)
                    .map(|values| FormKey { name: p.name.to_owned(), values })
            };
            let mut keys: Vec<FormKey> = kind.parameters.iter().filter_map(of).collect();
            keys.push(FormKey { name: ONSET.to_owned(), values: onset(times) });
            if kind.lasts != Lasts::Instant {
                keys.push(FormKey { name: "duration".to_owned(), values: duration(times) });
            }
            Form { kind, keys }
        })
        .collect()
}

fn onset(times: RunTimes) -> KeyValues {
    KeyValues::Between(seconds(0.0, times.length_s - times.sample_s, false))
}

fn duration(times: RunTimes) -> KeyValues {
    KeyValues::Between(seconds(times.sample_s, times.length_s, true))
}

fn seconds(from: f64, to: f64, is_logarithmic: bool) -> NumberRange {
    let unit = "s".to_owned();
    NumberRange { from, to, unit, is_logarithmic, is_whole: false, digits: TIME_DIGITS }
}

/// Values of a parameter; `None` leaves it at its default. `triad` is 0 for gyros, 1 for accelerometers;
/// a vector along one axis is turned by `turn` axes.
fn values(
    parameter: &'static octant_faults::catalogue::FaultParameter,
    [triad, turn]: [usize; 2],
    given: Option<&Value>,
    times: RunTimes,
) -> Option<KeyValues> {
    let fixed = || given.map(|value| KeyValues::Fixed(written(value)));
    match parameter.takes {
        Takes::Channels => {
            let of = ["gyro", "accelerometer"][triad.min(1)];
            let axes = ["x", "y", "z"].iter().map(|axis| format!("\"{of} {axis}\""));
            Some(KeyValues::OneOf(axes.chain([format!("\"{of}\"")]).collect()))
        }
        Takes::Choice(all) => {
            Some(KeyValues::OneOf(all.iter().map(|(name, _)| format!("{name:?}")).collect()))
        }
        Takes::Flag => Some(KeyValues::OneOf(vec!["false".to_owned(), "true".to_owned()])),
        Takes::Integer(from, to) => Some(KeyValues::Between(whole(from as f64, to as f64))),
        Takes::Number(bounds) => {
            let middle = given.and_then(number).or(bounds_middle(bounds))?;
            around(middle, bounds, "", times).map(KeyValues::Between)
        }
        Takes::Quantity(all, bounds) => {
            let dimension = fault_dimension(all.get(triad).or(all.first())?);
            let own = given
                .and_then(as_text)
                .filter(|text| quantity_of(text).is_ok_and(|quantity| quantity.is(dimension)));
            let text = own.unwrap_or(dimension.example);
            let (middle, unit) = divided(text)?;
            match around(middle, bounds, unit, times).filter(|range| range.from < range.to) {
                Some(range) => Some(KeyValues::Between(range)),
                None => fixed(),
            }
        }
        Takes::Vector(_) => given.map(|value| {
            vector(value, turn)
                .map_or_else(|| KeyValues::Fixed(written(value)), KeyValues::Multiple)
        }),
        Takes::Value | Takes::Difference(_) => fixed(),
    }
}

/// A vector that isn't zero, times a factor around 1.
fn vector(value: &Value, turn: usize) -> Option<ScaledVector> {
    let component = |node: &Node| match &node.value {
        Value::Text(text) => divided(text).map(|(number, unit)| (number, unit.to_owned())),
        value => Some((number(value)?, String::new())),
    };
    let Value::Array(all) = value else { return None };
    let all = all.iter().map(component).collect::<Option<Vec<_>>>()?;
    let factor = NumberRange {
        from: 1.0 / AROUND,
        to: AROUND,
        unit: String::new(),
        is_logarithmic: true,
        is_whole: false,
        digits: DIGITS,
    };
    let mut vector = ScaledVector { components: all, factor };
    if non_zero(&vector) == 1 {
        vector.components.rotate_right(turn);
    }
    (non_zero(&vector) > 0).then_some(vector)
}

fn non_zero(vector: &ScaledVector) -> usize {
    vector.components.iter().filter(|(number, _)| *number != 0.0).count()
}

fn bounds_middle(bounds: ParameterBounds) -> Option<f64> {
    match bounds {
        ParameterBounds::Within(from, to, _) => {
            Some((from * to).abs().sqrt().max(0.5 * (from + to)))
        }
        _ => None,
    }
}

/// Number and unit of a quantity as text.
pub(crate) fn divided(text: &str) -> Option<(f64, &str)> {
    let (number, unit) = text.split_once(' ')?;
    Some((number.parse().ok()?, unit.trim()))
}

fn whole(from: f64, to: f64) -> NumberRange {
    let to = to.min(WHOLE_MAX.max(from));
    let is_logarithmic = from > 0.0 && to > 100.0 * from;
    NumberRange { from, to, unit: String::new(), is_logarithmic, is_whole: true, digits: DIGITS }
}

/// Range around a value, within the bounds, whose limits are SI.
fn around(
    middle: f64,
    bounds: ParameterBounds,
    unit: &str,
    times: RunTimes,
) -> Option<NumberRange> {
    let si = |text: String| quantity_of(&text).map(|quantity| quantity.si).ok();
    let factor = if unit.is_empty() { 1.0 } else { si(format!("1 {unit}"))? };
    let size = middle.abs();
    if size == 0.0 && unit == "deg" {
        // An angle that may be any, such as a phase.
        let unit = unit.to_owned();
        let (is_logarithmic, is_whole) = (false, false);
        return Some(NumberRange {
            from: 0.0,
            to: 360.0,
            unit,
            is_logarithmic,
            is_whole,
            digits: DIGITS,
        });
    }
    let (mut from, mut to) = (size / AROUND, size * AROUND);
    if let ParameterBounds::Within(low, high, _) = bounds {
        from = from.max(low / factor);
        to = to.min(high / factor);
    }
    // A time is neither shorter than a sample nor longer than the run.
    if unit == "s" || unit == "ms" {
        from = from.max(times.sample_s / factor).min(to);
        to = to.min(times.length_s / factor).max(from);
    }
    if unit == "samples" {
        from = from.max(1.0);
    }
    let is_whole = unit == "samples";
    let unit = unit.to_owned();
    Some(NumberRange { from, to, unit, is_logarithmic: from > 0.0, is_whole, digits: DIGITS })
}

/// A value that is a text.
pub(crate) fn as_text(value: &Value) -> Option<&str> {
    match value {
        Value::Text(text) => Some(text),
        _ => None,
    }
}

/// Writes a value on one line, the keys of a table in the order of their names: journals have spaces so.
pub(crate) fn written(value: &Value) -> String {
    match value {
        Value::Text(text) => format!("{text:?}"),
        Value::Integer(number) => number.to_string(),
        Value::Number(number) => format!("{number:?}"),
        Value::Boolean(flag) => flag.to_string(),
        Value::Date(text) => text.clone(),
        Value::Array(all) => {
            let all: Vec<String> = all.iter().map(|node| written(&node.value)).collect();
            format!("[{}]", all.join(", "))
        }
        Value::Table(table) => {
            let mut entries: Vec<_> = table.entries.iter().collect();
            entries.sort_by_key(|entry| &entry.key);
            let pair = |entry: &&Entry| format!("{:?} = {}", entry.key, written(&entry.node.value));
            format!("{{ {} }}", entries.iter().map(pair).collect::<Vec<_>>().join(", "))
        }
    }
}
