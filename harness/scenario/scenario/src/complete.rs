//! Checks a document against the table of keys and writes the defaults into it.
//!
//! Every problem of a single value is found here, so that all are reported at once; problems of several
//! values together are found when the scenario is read.

use octant_toml_tree::join;

use super::condition;
use super::error::{Place, Problem};
use super::keys::{Bounds, Default, Key, Kind, Section, Variants};
use super::ports;
use super::quantity::{self, UnitDimension, explain};
use octant_base::names::suggestion;
use octant_faults::Channels;
use octant_toml_tree::{Node, Table, Value, number, parse_default};

/// Checks a table and adds its defaults; problems are added to `problems`.
pub(crate) fn complete(
    table: &mut Table,
    section: &'static Section,
    path: &str,
    place: &Place,
    problems: &mut Vec<Problem>,
) {
    let mut report = |place: &Place, path: String, message: String| {
        problems.push(Problem { place: place.clone(), path, message });
    };
    for entry in &table.entries {
        if section.key(&entry.key).is_none() {
            let known = suggestion(&entry.key, section.names(), "known here");
            report(&entry.place, join(path, &entry.key), format!("unknown key, {known}"));
        }
    }
    if section.one_of && table.entries.len() != 1 {
        let names = section.names().collect::<Vec<_>>().join(", ");
        let message =
            format!("found {} keys, expected exactly one of {names}", table.entries.len());
        return report(place, path.to_owned(), message);
    }
    for key in section.keys {
        let path = join(path, key.name);
        if table.get(key.name).is_none() {
            match key.default {
                Default::Value(text) => table.set(key.name, parse_default(text)),
                Default::Section => table.set(
                    key.name,
                    Node { value: Value::Table(Table::default()), place: Place::Default },
                ),
                Default::Required => {
                    let expected = expected(&key.kind);
                    let message = format!("missing, expected {expected}: {}", key.doc);
                    problems.push(Problem { place: place.clone(), path, message });
                    continue;
                }
                Default::Derived(_) | Default::ByCase(_) | Default::Absent(_) => continue,
            }
        }
        if let Some(node) = table.get_mut(key.name) {
            check(node, key, &key.kind, &path, problems);
        }
    }
}

/// Checks one value against the kind of its key.
pub(crate) fn check(
    node: &mut Node,
    key: &'static Key,
    kind: &'static Kind,
    path: &str,
    problems: &mut Vec<Problem>,
) {
    let place = node.place.clone();
    let mut report = |message: String| {
        problems.push(Problem { place: place.clone(), path: path.to_owned(), message });
    };
    let found = node.value.describe();
    match (kind, &mut node.value) {
        (Kind::Refused(reason), _) => report((*reason).to_owned()),
        (Kind::Either(kinds), value) => match kinds.iter().find(|kind| takes(kind, value)) {
            Some(kind) => check(node, key, kind, path, problems),
            None => report(format!("found {found}, expected {}", expected(kind))),
        },
        (Kind::Text, Value::Text(_)) | (Kind::Boolean, Value::Boolean(_)) => {}
        (Kind::Uri(schemes), Value::Text(text)) => {
            let scheme = text.split(':').next().unwrap_or_default();
            if !schemes.iter().any(|(known, _)| *known == scheme) {
                let known = suggestion(scheme, schemes.iter().map(|(name, _)| *name), "possible");
                report(format!("found {found}, {known}"));
            }
        }
        (Kind::Choice(choices), Value::Text(text)) => {
            if !choices.iter().any(|(known, _)| known == text) {
                let known = suggestion(text, choices.iter().map(|(name, _)| *name), "possible");
                report(format!("found {found}, {known}"));
            }
        }
        (Kind::Choices(choices), Value::Array(entries)) => {
            for entry in entries.iter() {
                let known = |text: &String| choices.contains(&text.as_str());
                if !matches!(&entry.value, Value::Text(text) if known(text)) {
                    let found = entry.value.describe();
                    let text = if let Value::Text(text) = &entry.value { text } else { "" };
                    let known = suggestion(text, choices.iter().copied(), "possible");
                    problems.push(Problem {
                        place: entry.place.clone(),
                        path: path.to_owned(),
                        message: format!("found {found}, {known}"),
                    });
                }
            }
        }
        (Kind::Integer(from, to), Value::Integer(number)) => {
            if !(*from..=*to).contains(number) {
                let kind = expected(kind);
                report(match (key.name, *number > *to) {
                    ("schema", true) => format!(
                        "found version {number}, this program reads version {to}: a newer Octant wrote it"
                    ),
                    ("schema", false) => format!("found version {number}, expected {to}"),
                    _ => format!("found {number}, expected {kind}"),
                });
            }
        }
        (Kind::Number(bounds), value @ (Value::Integer(_) | Value::Number(_))) => {
            if !number(value).is_some_and(|value| bounds.contain(value)) {
                report(format!("found {found}, expected a number {}", bounds.words()));
            }
        }
        (Kind::Numbers(count), Value::Array(entries)) => {
            let finite = |entry: &Node| number(&entry.value).is_some_and(f64::is_finite);
            if entries.len() != *count || !entries.iter().all(finite) {
                report(format!("found {found}, expected {count} numbers"));
            }
        }
        (Kind::Quantity(dimensions, bounds), value) => {
            if let Err(message) = check_quantity(value, dimensions, *bounds) {
                report(message);
            }
        }
        (Kind::Quantities(dimension, count), Value::Array(entries)) => {
            if entries.len() != *count {
                report(format!(
                    "found {} entries, expected {count}, each {}",
                    entries.len(),
                    dimension.name
                ));
            }
            for (index, entry) in entries.iter().enumerate() {
                if let Err(message) = check_quantity(&entry.value, &[*dimension], Bounds::Any) {
                    problems.push(Problem {
                        place: entry.place.clone(),
                        path: format!("{path}[{index}]"),
                        message,
                    });
                }
            }
        }
        (Kind::Vector(dimensions), Value::Array(entries)) => {
            check_vector(entries, dimensions, path, &place, problems);
        }
        (Kind::Times, Value::Array(entries)) => {
            for (index, entry) in entries.iter().enumerate() {
                let checked =
                    check_quantity(&entry.value, &[UnitDimension::TIME], Bounds::NotNegative);
                if let Err(message) = checked {
                    let path = format!("{path}[{index}]");
                    problems.push(Problem { place: entry.place.clone(), path, message });
                }
            }
        }
        (Kind::Condition, Value::Text(text)) => {
            if let Err(message) = condition::parse(text) {
                report(format!("found {found}, {message}"));
            }
        }
        (Kind::Channels, Value::Text(_) | Value::Array(_)) => {
            let entries = match &node.value {
                Value::Array(entries) => entries.as_slice(),
                _ => std::slice::from_ref(&*node),
            };
            if entries.is_empty() {
                report(format!("found {found}, expected {}", expected(kind)));
            }
            let names = Channels::NAMES.iter().map(|(name, _)| *name);
            for entry in entries {
                let text = if let Value::Text(text) = &entry.value { text } else { "" };
                if Channels::named(text).is_none() {
                    let known = suggestion(text, names.clone(), "possible");
                    let message = format!("found {}, {known}", entry.value.describe());
                    let (place, path) = (entry.place.clone(), path.to_owned());
                    problems.push(Problem { place, path, message });
                }
            }
        }
        (Kind::Limit, Value::Integer(_)) => {}
        (Kind::Limit, Value::Number(value)) if value.is_finite() => {}
        (Kind::Limit, Value::Text(text)) => {
            if let Err(error) = quantity::parse(text) {
                report(format!(
                    "found {found}, {}; expected a quantity or a number",
                    explain(&error)
                ));
            }
        }
        (Kind::Column, Value::Integer(1..=10_000) | Value::Text(_)) => {}
        (Kind::Port(channel), _) => problems.extend(ports::ports(node, channel, path).err()),
        (Kind::Settings, Value::Table(table)) => {
            problems.extend(ports::settings(table, path).err())
        }
        (Kind::Values, Value::Array(entries)) if !entries.is_empty() => {}
        (Kind::Names, Value::Array(entries))
            if entries.iter().all(|entry| matches!(entry.value, Value::Text(_))) => {}
        (Kind::Lists, Value::Array(entries)) if !entries.is_empty() => {
            for entry in entries.iter().filter(|entry| !is_names(entry)) {
                let found = entry.value.describe();
                problems.push(Problem {
                    place: entry.place.clone(),
                    path: path.to_owned(),
                    message: format!("found {found}, expected a list of names, which may be empty"),
                });
            }
        }
        (Kind::Codes, value) if ports::codes(value).is_some_and(|codes| !codes.is_empty()) => {}
        (Kind::Table(section), Value::Table(table)) => {
            complete(table, section, path, &place, problems);
        }
        (Kind::Variants(variants), Value::Table(table)) => {
            complete_variant(table, variants, path, &place, problems);
        }
        (Kind::VariantTables(variants, at_most), Value::Array(entries)) => {
            if entries.len() > *at_most {
                report(format!("found {} entries, expected at most {at_most}", entries.len()));
            }
            for (index, entry) in entries.iter_mut().enumerate() {
                let (path, place) = (format!("{path}[{index}]"), entry.place.clone());
                if let Value::Table(table) = &mut entry.value {
                    complete_variant(table, variants, &path, &place, problems);
                } else {
                    let message = format!("found {}, expected a table", entry.value.describe());
                    problems.push(Problem { place, path, message });
                }
            }
        }
        (Kind::Tables(section, at_least, at_most), Value::Array(entries)) => {
            if !(*at_least..=*at_most).contains(&entries.len()) {
                let count = entries.len();
                report(format!("found {count} entries, expected {at_least} to {at_most}"));
            }
            for (index, entry) in entries.iter_mut().enumerate() {
                let path = format!("{path}[{index}]");
                let place = entry.place.clone();
                match &mut entry.value {
                    Value::Table(table) => complete(table, section, &path, &place, problems),
                    other => problems.push(Problem {
                        place,
                        path,
                        message: format!(
                            "found {}, expected a table with {}",
                            other.describe(),
                            section.names().collect::<Vec<_>>().join(", ")
                        ),
                    }),
                }
            }
        }
        (kind, _) => report(format!("found {found}, expected {}", expected(kind))),
    }
}

/// Checks a table against the keys of its form.
fn complete_variant(
    table: &mut Table,
    variants: &'static Variants,
    path: &str,
    place: &Place,
    problems: &mut Vec<Problem>,
) {
    match variants.section(table) {
        Some(section) => complete(table, section, path, place, problems),
        None => problems.push(variants.problem(table, path, place)),
    }
}

/// Checks x, y, z of a vector: each a quantity, all of the same dimension.
fn check_vector(
    entries: &[Node],
    dimensions: &[UnitDimension],
    path: &str,
    place: &Place,
    problems: &mut Vec<Problem>,
) {
    let mut report = |place: &Place, path: String, message: String| {
        problems.push(Problem { place: place.clone(), path, message });
    };
    if entries.len() != 3 {
        let expected = quantity_words(dimensions);
        let message =
            format!("found {} entries, expected 3 (x, y, z), each {expected}", entries.len());
        return report(place, path.to_owned(), message);
    }
    let mut of: Option<UnitDimension> = None;
    for (index, entry) in entries.iter().enumerate() {
        let path = format!("{path}[{index}]");
        if let Err(message) = check_quantity(&entry.value, dimensions, Bounds::Any) {
            report(&entry.place, path, message);
            continue;
        }
        let Value::Text(text) = &entry.value else { continue };
        let Ok(quantity) = quantity::parse(text) else { continue };
        let found = dimensions.iter().find(|dimension| quantity.is(**dimension)).copied();
        match (of, found) {
            (None, _) => of = found,
            (Some(first), Some(other)) if first != other => {
                let message = format!(
                    "found {text:?}, {}, beside {}: expected all three alike",
                    other.name, first.name
                );
                report(&entry.place, path, message);
            }
            _ => {}
        }
    }
}

fn check_quantity(
    value: &Value,
    dimensions: &[UnitDimension],
    bounds: Bounds,
) -> Result<(), String> {
    let expected = quantity_words(dimensions);
    let Value::Text(text) = value else {
        return Err(format!("found {}, expected {expected}", value.describe()));
    };
    let quantity = quantity::parse(text)
        .map_err(|error| format!("found {text:?}, {}; expected {expected}", explain(&error)))?;
    if !dimensions.iter().any(|dimension| quantity.is(*dimension)) {
        let is =
            UnitDimension::of(quantity).map_or("another dimension", |dimension| dimension.name);
        return Err(format!("found {text:?}, {is}; expected {expected}"));
    }
    if quantity.is(UnitDimension::SAMPLES) && quantity.si.fract() != 0.0 {
        return Err(format!("found {text:?}, expected a whole number of samples"));
    }
    if bounds.contain(quantity.si) {
        Ok(())
    } else {
        Err(format!("found {text:?}, expected a value {}", bounds.words()))
    }
}

fn quantity_words(dimensions: &[UnitDimension]) -> String {
    let each = |d: &UnitDimension| format!("{} such as \"{}\"", d.name, d.example);
    dimensions.iter().map(each).collect::<Vec<_>>().join(" or ")
}

fn is_names(node: &Node) -> bool {
    let Value::Array(entries) = &node.value else { return false };
    entries.iter().all(|entry| matches!(entry.value, Value::Text(_)))
}

/// True if a TOML value of this type is meant for this kind.
fn takes(kind: &Kind, value: &Value) -> bool {
    matches!(
        (kind, value),
        (Kind::Choice(_) | Kind::Text, Value::Text(_))
            | (Kind::Boolean, Value::Boolean(_))
            | (Kind::Integer(..) | Kind::Number(_), Value::Integer(_))
            | (Kind::Number(_), Value::Number(_))
            | (Kind::Table(_), Value::Table(_))
            | (Kind::Tables(..), Value::Array(_))
            | (Kind::Variants(_), Value::Table(_))
    )
}

/// Description of the values of a kind.
pub(crate) fn expected(kind: &Kind) -> String {
    let names = |choices: &[(&str, &str)]| {
        choices.iter().map(|(name, _)| format!("{name:?}")).collect::<Vec<_>>().join(", ")
    };
    match kind {
        Kind::Text => "a text in quotes".to_owned(),
        Kind::Uri(choices) | Kind::Choice(choices) if choices.len() == 1 => names(choices),
        Kind::Uri(choices) | Kind::Choice(choices) => format!("one of {}", names(choices)),
        Kind::Choices(choices) => format!("a list of some of {}", choices.join(", ")),
        Kind::Boolean => "true or false".to_owned(),
        Kind::Integer(from, to) if from == to => format!("{from}"),
        Kind::Integer(from, to) if *to == i64::MAX => format!("a whole number of {from} or more"),
        Kind::Integer(from, to) => format!("a whole number from {from} to {to}"),
        Kind::Number(bounds) => format!("a number {}", bounds.words()),
        Kind::Numbers(count) => format!("{count} numbers"),
        Kind::Quantity(dimensions, _) => quantity_words(dimensions),
        Kind::Quantities(dimension, count) => {
            format!("an array of {count}, each {}", quantity_words(&[*dimension]))
        }
        Kind::Vector(dimensions) => {
            format!("an array of 3 (x, y, z), each {}", quantity_words(dimensions))
        }
        Kind::Times => format!("an array, each {}", quantity_words(&[UnitDimension::TIME])),
        Kind::Condition => format!("a text such as {:?}", condition::EXAMPLE),
        Kind::Channels => {
            let all = Channels::NAMES.iter().map(|(name, _)| format!("{name:?}"));
            format!("a channel or an array of them: {}", all.collect::<Vec<_>>().join(", "))
        }
        Kind::Limit => "a quantity or a number".to_owned(),
        Kind::Column => "a column number from 1, or a column's name".to_owned(),
        Kind::Port(channel) => ports::expected_port(channel),
        Kind::Settings => "a table of names and values".to_owned(),
        Kind::Values => "a list of at least one value".to_owned(),
        Kind::Names => "a list of names".to_owned(),
        Kind::Lists => "a list of lists of names".to_owned(),
        Kind::Codes => {
            "a whole number or the name of an enumeration's item, or an array of them".to_owned()
        }
        Kind::Table(section) if section.one_of => {
            format!("a table with one of {}", section.names().collect::<Vec<_>>().join(", "))
        }
        Kind::Table(section) => {
            format!("a table with {}", section.names().collect::<Vec<_>>().join(", "))
        }
        Kind::Tables(section, ..) => {
            format!("an array of tables with {}", section.names().collect::<Vec<_>>().join(", "))
        }
        Kind::Variants(variants) => {
            format!("a table with one of {}", variants.names().collect::<Vec<_>>().join(", "))
        }
        Kind::VariantTables(..) => "an array of tables".to_owned(),
        Kind::Either(kinds) => kinds.iter().map(expected).collect::<Vec<_>>().join(", or "),
        Kind::Refused(reason) => (*reason).to_owned(),
    }
}
