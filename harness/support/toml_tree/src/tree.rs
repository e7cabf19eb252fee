//! A tree of values, each with its place.

use crate::error::Place;

/// A value with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Place of the value.
    pub place: Place,
}

impl Node {
    /// Texts of an array.
    pub fn texts(&self) -> Vec<String> {
        let Value::Array(entries) = &self.value else { return Vec::new() };
        let text = |entry: &Node| match &entry.value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        };
        entries.iter().filter_map(text).collect()
    }
}

/// A value of one of the kinds of TOML.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
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
    Array(Vec<Node>),
    /// A table.
    Table(Table),
}

impl Value {
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
pub struct Entry {
    /// The key.
    pub key: String,
    /// Place of the key.
    pub place: Place,
    /// The value.
    pub node: Node,
}

/// A table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Keys in the order of writing.
    pub entries: Vec<Entry>,
}

impl Table {
    /// Value of a key.
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node)
    }

    /// Mutable value of a key.
    pub fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.entries.iter_mut().find(|entry| entry.key == key).map(|entry| &mut entry.node)
    }

    /// Replaces or adds a value.
    pub fn set(&mut self, key: &str, node: Node) {
        match self.get_mut(key) {
            Some(present) => *present = node,
            None => {
                self.entries.push(Entry { key: key.to_owned(), place: node.place.clone(), node })
            }
        }
    }

    /// Removes a key, if it exists.
    pub fn remove(&mut self, key: &str) {
        self.entries.retain(|entry| entry.key != key);
    }

    /// Value at a dotted path.
    pub fn at(&self, path: &str) -> Option<&Node> {
        let (first, rest) = path.split_once('.').map_or((path, None), |(a, b)| (a, Some(b)));
        match (self.get(first)?, rest) {
            (node, None) => Some(node),
            (Node { value: Value::Table(table), .. }, Some(rest)) => table.at(rest),
            _ => None,
        }
    }

    /// Removes the value at a dotted path, if there is one.
    pub fn remove_at(&mut self, path: &str) {
        match path.split_once('.') {
            None => self.remove(path),
            Some((first, rest)) => {
                if let Some(Node { value: Value::Table(table), .. }) = self.get_mut(first) {
                    table.remove_at(rest);
                }
            }
        }
    }

    /// Sets the value at a dotted path and makes missing tables. A value in the way that is not a table
    /// is replaced by one.
    pub fn set_at(&mut self, path: &str, node: Node) {
        let Some((first, rest)) = path.split_once('.') else { return self.set(path, node) };
        if !matches!(self.get(first), Some(Node { value: Value::Table(_), .. })) {
            let place = node.place.clone();
            self.set(first, Node { value: Value::Table(Self::default()), place });
        }
        if let Some(Node { value: Value::Table(table), .. }) = self.get_mut(first) {
            table.set_at(rest, node);
        }
    }
}

/// Value of a plain number, whole or not.
pub fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(number) => Some(*number as f64),
        Value::Number(number) => Some(*number),
        _ => None,
    }
}

/// Dotted path of a key.
pub fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
