//! TOML text as a tree.

use crate::controls::controls;
use crate::error::{Place, Problem};
use crate::tree::{Entry, Node, Table, Value};
use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

/// Reads TOML text.
///
/// # Errors
/// If it is no TOML: the place and the reason.
pub fn read(text: &str) -> Result<Table, Problem> {
    let lines = Lines::new(text);
    match DeTable::parse(text) {
        Ok(table) => Ok(lines.table(table.into_inner())),
        Err(error) => Err(Problem {
            place: lines.place(error.span().map_or(text.len(), |span| span.start)),
            path: String::new(),
            message: format!("not TOML: {}", error.message().replace('\n', ", ")),
        }),
    }
}

/// Reads TOML text without control characters.
///
/// # Errors
/// If it is no TOML, or texts and keys have control characters: one problem for each.
pub fn parse(text: &str) -> Result<Table, Vec<Problem>> {
    let table = read(text).map_err(|problem| vec![problem])?;
    let problems = controls(&table, "");
    if problems.is_empty() { Ok(table) } else { Err(problems) }
}

/// Reads TOML text into a type of its own.
///
/// # Errors
/// If it is no TOML, or doesn't fit the type: the place, which is [`Place::Unread`] where there is none, and the reason.
pub fn read_as<T: DeserializeOwned>(text: &str) -> Result<T, Problem> {
    toml::from_str(text).map_err(|error| Problem {
        place: error.span().map_or(Place::Unread, |span| Lines::new(text).place(span.start)),
        path: String::new(),
        message: error.message().to_owned(),
    })
}

/// A number of a text as it is written there, without underscores.
pub fn number_as_written(text: &str, place: &Place) -> String {
    let Place::File { line, column } = *place else { return String::new() };
    let from = text.split('\n').nth(line - 1).unwrap_or_default().chars().skip(column - 1);
    let number = from.take_while(|c| c.is_ascii_alphanumeric() || "+-._".contains(*c));
    number.filter(|c| *c != '_').collect()
}

/// Parses the value of an argument of a command line: TOML, or a text without quotes. `argument` is the whole of it,
/// behind its option, for problems.
pub fn parse_argument(value: &str, argument: &str) -> Node {
    let place = Place::Argument(argument.to_owned());
    let value = value.trim();
    let node = match parse_value(value) {
        Some(node) => node,
        None => Node { value: Value::Text(value.to_owned()), place: place.clone() },
    };
    replace_places(node, &place)
}

/// Parses a default of the key table.
pub fn parse_default(value: &str) -> Node {
    let text = Value::Text(value.to_owned());
    let node = parse_value(value).unwrap_or(Node { value: text, place: Place::Default });
    replace_places(node, &Place::Default)
}

fn parse_value(value: &str) -> Option<Node> {
    // A line break would allow further keys.
    let table = (!value.contains('\n')).then(|| parse(&format!("x = {value}")).ok())??;
    table.entries.into_iter().next().map(|entry| entry.node)
}

fn replace_places(mut node: Node, place: &Place) -> Node {
    node.place = place.clone();
    node.value = match node.value {
        Value::Array(entries) => {
            Value::Array(entries.into_iter().map(|n| replace_places(n, place)).collect())
        }
        Value::Table(table) => Value::Table(Table {
            entries: table
                .entries
                .into_iter()
                .map(|entry| Entry {
                    key: entry.key,
                    place: place.clone(),
                    node: replace_places(entry.node, place),
                })
                .collect(),
        }),
        plain => plain,
    };
    node
}

/// Converts byte offsets to lines and columns.
struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        let starts = std::iter::once(0)
            .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1))
            .collect();
        Self { text, starts }
    }

    fn place(&self, offset: usize) -> Place {
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line - 1];
        let before = self.text.get(start..offset).unwrap_or_default();
        Place::File { line, column: before.chars().count() + 1 }
    }

    fn table(&self, table: DeTable<'_>) -> Table {
        let mut entries: Vec<(usize, Entry)> = table
            .into_iter()
            .map(|(key, value)| {
                let at = key.span().start;
                let entry = Entry {
                    key: key.into_inner().into_owned(),
                    place: self.place(at),
                    node: self.node(value),
                };
                (at, entry)
            })
            .collect();
        // Sorted in the order of writing, so that problems are reported in that order.
        entries.sort_by_key(|(at, _)| *at);
        Table { entries: entries.into_iter().map(|(_, entry)| entry).collect() }
    }

    fn node(&self, value: toml::Spanned<DeValue<'_>>) -> Node {
        let place = self.place(value.span().start);
        let value = match value.into_inner() {
            DeValue::String(text) => Value::Text(text.into_owned()),
            DeValue::Integer(number) => {
                match i64::from_str_radix(number.as_str(), number.radix()) {
                    Ok(integer) => Value::Integer(integer),
                    // Beyond 64 bits the number becomes a float, which every key for integers refuses.
                    Err(_) => Value::Number(number.as_str().parse().unwrap_or(f64::INFINITY)),
                }
            }
            // `nan`, `inf` and invalid numbers all become not finite, which every key refuses.
            DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(value) => Value::Boolean(value),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(entries) => {
                Value::Array(entries.into_iter().map(|entry| self.node(entry)).collect())
            }
            DeValue::Table(table) => Value::Table(self.table(table)),
        };
        Node { value, place }
    }
}
