//! TOML as it was written: a tree of values with their places, and problems that name a place.

pub mod error;

use self::error::{Place, Problem};
use std::fmt::Write as _;
use toml::de::{DeTable, DeValue};

/// A value with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct DocumentNode {
    /// The value.
    pub value: DocumentValue,
    /// Place of the value.
    pub place: Place,
}

impl DocumentNode {
    /// Texts of an array.
    pub fn texts(&self) -> Vec<String> {
        let DocumentValue::Array(entries) = &self.value else { return Vec::new() };
        let text = |entry: &DocumentNode| match &entry.value {
            DocumentValue::Text(text) => Some(text.clone()),
            _ => None,
        };
        entries.iter().filter_map(text).collect()
    }
}

/// A value of one of the kinds of TOML.
#[derive(Clone, Debug, PartialEq)]
pub enum DocumentValue {
    /// A text.
    Text(String),
    /// A whole number.
    Integer(i64),
    /// A number with a fraction.
    Number(f64),
    /// True or false.
    Boolean(bool),
    /// A date or time, as written; no key accepts it.
    Date(String),
    /// An array.
    Array(Vec<DocumentNode>),
    /// A table.
    Table(DocumentTable),
}

impl DocumentValue {
    /// Describes the value, for "found …".
    pub fn describe(&self) -> String {
        match self {
            Self::Text(text) => format!("{text:?}"),
            Self::Integer(number) => format!("the bare number {number}"),
            Self::Number(number) => format!("the bare number {number}"),
            Self::Boolean(value) => format!("{value}"),
            Self::Date(text) => format!("the date {text}"),
            Self::Array(entries) => format!("an array of {}", entries.len()),
            Self::Table(_) => "a table".to_owned(),
        }
    }
}

/// A key of a table, with its place and value.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyEntry {
    /// The key.
    pub key: String,
    /// Place of the key.
    pub place: Place,
    /// The value.
    pub node: DocumentNode,
}

/// A table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DocumentTable {
    /// Keys in the order of writing.
    pub entries: Vec<KeyEntry>,
}

impl DocumentTable {
    /// Value of a key.
    pub fn get(&self, key: &str) -> Option<&DocumentNode> {
        self.entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node)
    }

    /// Mutable value of a key.
    pub fn get_mut(&mut self, key: &str) -> Option<&mut DocumentNode> {
        self.entries.iter_mut().find(|entry| entry.key == key).map(|entry| &mut entry.node)
    }

    /// Replaces or adds a value.
    pub fn set(&mut self, key: &str, node: DocumentNode) {
        match self.get_mut(key) {
            Some(present) => *present = node,
            None => {
                self.entries.push(KeyEntry { key: key.to_owned(), place: node.place.clone(), node })
            }
        }
    }

    /// Removes a key, if it exists.
    pub fn remove(&mut self, key: &str) {
        self.entries.retain(|entry| entry.key != key);
    }

    /// Value at a dotted path.
    pub fn at(&self, path: &str) -> Option<&DocumentNode> {
        let (first, rest) = path.split_once('.').map_or((path, None), |(a, b)| (a, Some(b)));
        match (self.get(first)?, rest) {
            (node, None) => Some(node),
            (DocumentNode { value: DocumentValue::Table(table), .. }, Some(rest)) => table.at(rest),
            _ => None,
        }
    }

    /// Removes the value at a dotted path, if there is one.
    pub fn remove_at(&mut self, path: &str) {
        match path.split_once('.') {
            None => self.remove(path),
            Some((first, rest)) => {
                if let Some(DocumentNode { value: DocumentValue::Table(table), .. }) =
                    self.get_mut(first)
                {
                    table.remove_at(rest);
                }
            }
        }
    }

    /// Sets the value at a dotted path and makes missing tables. A value in the way that is not a table
    /// is replaced by one.
    pub fn set_at(&mut self, path: &str, node: DocumentNode) {
        let Some((first, rest)) = path.split_once('.') else { return self.set(path, node) };
        if !matches!(self.get(first), Some(DocumentNode { value: DocumentValue::Table(_), .. })) {
            let place = node.place.clone();
            self.set(first, DocumentNode { value: DocumentValue::Table(Self::default()), place });
        }
        if let Some(DocumentNode { value: DocumentValue::Table(table), .. }) = self.get_mut(first) {
            table.set_at(rest, node);
        }
    }
}

/// Parses TOML text.
pub fn parse(text: &str) -> Result<DocumentTable, Vec<Problem>> {
    let lines = Lines::new(text);
    match DeTable::parse(text) {
        Ok(table) => {
            let table = lines.table(table.into_inner());
            let problems = controls(&table, "");
            if problems.is_empty() { Ok(table) } else { Err(problems) }
        }
        Err(error) => Err(vec![Problem {
            place: lines.place(error.span().map_or(text.len(), |span| span.start)),
            path: String::new(),
            message: format!("not TOML: {}", error.message().replace('\n', ", ")),
        }]),
    }
}

/// Keys whose texts are names, which have one line.
const NAMES: [&str; 6] = ["title", "id", "name", "label", "serial", "certificate"];

/// Finds control characters in texts and keys, which a terminal would execute and other file formats
/// can't hold. A text that isn't a name may have line breaks and tabs.
fn controls(table: &DocumentTable, path: &str) -> Vec<Problem> {
    let mut found = Vec::new();
    for entry in &table.entries {
        let path =
            if path.is_empty() { entry.key.clone() } else { format!("{path}.{}", entry.key) };
        if let Some(c) = control(&entry.key, true) {
            found.push(problem_of(c, &entry.place, path.escape_debug().to_string()));
        } else {
            controls_of(&entry.node, &path, NAMES.contains(&entry.key.as_str()), &mut found);
        }
    }
    found
}

fn controls_of(node: &DocumentNode, path: &str, is_name: bool, found: &mut Vec<Problem>) {
    match &node.value {
        DocumentValue::Text(text) => {
            let c = control(text, is_name);
            found.extend(c.map(|c| problem_of(c, &node.place, path.to_owned())));
        }
        DocumentValue::Array(entries) => {
            entries.iter().for_each(|entry| controls_of(entry, path, is_name, found));
        }
        DocumentValue::Table(table) => found.extend(controls(table, path)),
        _ => {}
    }
}

fn problem_of(c: char, place: &Place, path: String) -> Problem {
    let message = format!("found the control character {:?}, expected text that can be printed", c);
    Problem { place: place.clone(), path, message }
}

/// First control character of a text.
fn control(text: &str, is_name: bool) -> Option<char> {
    // Characters that reverse the direction of text can hide text around them.
    let turns = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_bad = |c: char| turns(c) || (c.is_control() && (is_name || !"\n\r\t".contains(c)));
    text.chars().find(|c| is_bad(*c))
}

/// First problem of a control character in the value of an argument.
pub fn controls_of_argument(path: &str, node: &DocumentNode) -> Option<Problem> {
    let mut found = Vec::new();
    let name = path.rsplit('.').next().unwrap_or(path);
    controls_of(node, &path.escape_debug().to_string(), NAMES.contains(&name), &mut found);
    found.into_iter().next()
}

/// Parses the value of a `--set KEY=VALUE`: TOML, or a text without quotes.
pub fn parse_argument(value: &str, argument: &str) -> DocumentNode {
    let place = Place::Argument(argument.to_owned());
    let value = value.trim();
    let node = match parse_value(value) {
        Some(node) => node,
        None => DocumentNode { value: DocumentValue::Text(value.to_owned()), place: place.clone() },
    };
    replace_places(node, &place)
}

/// Parses a default of the key table.
pub fn parse_default(value: &str) -> DocumentNode {
    let text = DocumentValue::Text(value.to_owned());
    let node = parse_value(value).unwrap_or(DocumentNode { value: text, place: Place::Default });
    replace_places(node, &Place::Default)
}

fn parse_value(value: &str) -> Option<DocumentNode> {
    // A line break would allow further keys.
    let table = (!value.contains('\n')).then(|| parse(&format!("x = {value}")).ok())??;
    table.entries.into_iter().next().map(|entry| entry.node)
}

fn replace_places(mut node: DocumentNode, place: &Place) -> DocumentNode {
    node.place = place.clone();
    node.value = match node.value {
        DocumentValue::Array(entries) => {
            DocumentValue::Array(entries.into_iter().map(|n| replace_places(n, place)).collect())
        }
        DocumentValue::Table(table) => DocumentValue::Table(DocumentTable {
            entries: table
                .entries
                .into_iter()
                .map(|entry| KeyEntry {
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

    fn table(&self, table: DeTable<'_>) -> DocumentTable {
        let mut entries: Vec<(usize, KeyEntry)> = table
            .into_iter()
            .map(|(key, value)| {
                let at = key.span().start;
                let entry = KeyEntry {
                    key: key.into_inner().into_owned(),
                    place: self.place(at),
                    node: self.node(value),
                };
                (at, entry)
            })
            .collect();
        // Sorted in the order of writing, so that problems are reported in that order.
        entries.sort_by_key(|(at, _)| *at);
        DocumentTable { entries: entries.into_iter().map(|(_, entry)| entry).collect() }
    }

    fn node(&self, value: toml::Spanned<DeValue<'_>>) -> DocumentNode {
        let place = self.place(value.span().start);
        let value = match value.into_inner() {
            DeValue::String(text) => DocumentValue::Text(text.into_owned()),
            DeValue::Integer(number) => {
                match i64::from_str_radix(number.as_str(), number.radix()) {
                    Ok(integer) => DocumentValue::Integer(integer),
                    // Beyond 64 bits the number becomes a float, which every key for integers refuses.
                    Err(_) => {
                        DocumentValue::Number(number.as_str().parse().unwrap_or(f64::INFINITY))
                    }
                }
            }
            // `nan`, `inf` and invalid numbers all become not finite, which every key refuses.
            DeValue::Float(number) => {
                DocumentValue::Number(number.as_str().parse().unwrap_or(f64::NAN))
            }
            DeValue::Boolean(value) => DocumentValue::Boolean(value),
            DeValue::Datetime(date) => DocumentValue::Date(date.to_string()),
            DeValue::Array(entries) => {
                DocumentValue::Array(entries.into_iter().map(|entry| self.node(entry)).collect())
            }
            DeValue::Table(table) => DocumentValue::Table(self.table(table)),
        };
        DocumentNode { value, place }
    }
}

/// Writes a value on one line.
pub fn write_value(value: &DocumentValue, out: &mut String) {
    match value {
        DocumentValue::Text(text) => write_quoted(text, out),
        DocumentValue::Integer(number) => _ = write!(out, "{number}"),
        DocumentValue::Number(number) => _ = write!(out, "{number:?}"),
        DocumentValue::Boolean(value) => _ = write!(out, "{value}"),
        DocumentValue::Date(text) => out.push_str(text),
        DocumentValue::Array(entries) => {
            out.push('[');
            for (index, entry) in entries.iter().enumerate() {
                if index > 0 {
                    out.push_str(", ");
                }
                write_value(&entry.value, out);
            }
            out.push(']');
        }
        DocumentValue::Table(table) => {
            out.push_str("{ ");
            for (index, entry) in table.entries.iter().enumerate() {
                if index > 0 {
                    out.push_str(", ");
                }
                write_key(&entry.key, out);
                out.push_str(" = ");
                write_value(&entry.node.value, out);
            }
            out.push_str(" }");
        }
    }
}

/// Quotes a text: JSON escapes everything that a basic string of TOML must escape, except DEL.
fn write_quoted(text: &str, out: &mut String) {
    let quoted = serde_json::Value::from(text).to_string();
    out.push_str(&quoted.replace('\u{7f}', "\\u007f"));
}

/// Writes a key, in quotes if necessary.
fn write_key(key: &str, out: &mut String) {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !key.is_empty() && key.chars().all(bare) {
        out.push_str(key)
    } else {
        write_quoted(key, out)
    }
}

/// Converts a value to JSON.
pub fn json(value: &DocumentValue) -> serde_json::Value {
    match value {
        DocumentValue::Text(text) | DocumentValue::Date(text) => {
            serde_json::Value::from(text.as_str())
        }
        DocumentValue::Integer(number) => serde_json::Value::from(*number),
        DocumentValue::Number(number) => serde_json::Value::from(*number),
        DocumentValue::Boolean(value) => serde_json::Value::from(*value),
        DocumentValue::Array(entries) => entries.iter().map(|entry| json(&entry.value)).collect(),
        DocumentValue::Table(table) => {
            table.entries.iter().map(|entry| (entry.key.clone(), json(&entry.node.value))).collect()
        }
    }
}

/// Value of a plain number, whole or not.
pub fn number(value: &DocumentValue) -> Option<f64> {
    match value {
        DocumentValue::Integer(number) => Some(*number as f64),
        DocumentValue::Number(number) => Some(*number),
        _ => None,
    }
}

/// Dotted path of a key.
pub fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
