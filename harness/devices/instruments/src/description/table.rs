//! Tables of a description with the places of their keys, and the problems that name them.

use octant_base::names::suggestion;
use octant_toml_tree::error::Place;
use octant_toml_tree::{Node, Value, number_as_written};
use std::format;
use std::string::String;
use std::vec::Vec;

/// A file and its text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Text<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
}

impl Text<'_> {
    /// Makes a problem at a place of the text.
    pub(super) fn problem(&self, place: &Place, what: String) -> DescriptionProblem {
        let line = if let Place::File { line, .. } = place { *line } else { 1 };
        DescriptionProblem { place: format!("{}:{line}", self.file), what }
    }

    /// Describes a value, for "found …".
    fn describe(&self, node: &Node) -> String {
        match &node.value {
            Value::Integer(_) | Value::Number(_) => number_as_written(self.text, &node.place),
            other => other.describe(),
        }
    }
}

/// A table.
#[derive(Clone, Debug)]
pub(super) struct Table<'a> {
    text: Text<'a>,
    table: &'a octant_toml_tree::Table,
    /// Name in messages, with a point behind it; empty at the root.
    name: String,
    /// Place of the table in the text.
    place: Place,
}

impl<'a> Table<'a> {
    /// Makes the table of a whole file.
    pub(super) fn root(text: Text<'a>, table: &'a octant_toml_tree::Table) -> Self {
        Self { text, table, name: String::new(), place: Place::File { line: 1, column: 1 } }
    }

    /// Value of a key.
    fn value(&self, key: &str) -> Option<&'a Node> {
        self.table.get(key)
    }

    /// True if the key is given.
    pub(super) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// Makes a problem of a key, or of the table if the key is omitted.
    pub(super) fn problem(&self, key: &str, what: impl core::fmt::Display) -> DescriptionProblem {
        let place = self.value(key).map_or(&self.place, |value| &value.place);
        self.text.problem(place, format!("{}{key}: {what}", self.name))
    }

    /// Makes a problem of the table as a whole.
    pub(super) fn problem_of_all(&self, what: impl core::fmt::Display) -> DescriptionProblem {
        let name = self.name.trim_end_matches('.');
        let colon = if name.is_empty() { "" } else { ": " };
        self.text.problem(&self.place, format!("{name}{colon}{what}"))
    }

    /// Checks that there are no other keys.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), DescriptionProblem> {
        match self.table.entries.iter().find(|entry| !known.contains(&entry.key.as_str())) {
            None => Ok(()),
            Some(octant_toml_tree::Entry { key, place, .. }) => {
                let known = suggestion(key, known.iter().copied(), "known keys");
                Err(self.text.problem(place, format!("{}{key}: unknown key; {known}", self.name)))
            }
        }
    }

    fn wrong(&self, key: &str, value: &Node, expected: &str) -> DescriptionProblem {
        self.problem(key, format!("found {}, expected {expected}", self.text.describe(value)))
    }

    fn missing(&self, key: &str, expected: &str) -> DescriptionProblem {
        self.problem(key, format!("missing, expected {expected}"))
    }

    /// Text under a key, if it is given.
    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, DescriptionProblem> {
        match self.value(key).map(|value| (value, &value.value)) {
            None => Ok(None),
            Some((_, Value::Text(text))) if !text.chars().any(char::is_control) => {
                Ok(Some(text.as_str()))
            }
            Some((value, _)) => Err(self.wrong(key, value, "a text of one line")),
        }
    }

    /// One of several named values, if the key is given.
    pub(super) fn choice<T: Copy>(
        &self,
        key: &str,
        choices: &[(&str, T)],
    ) -> Result<Option<T>, DescriptionProblem> {
        let Some(found) = self.text(key)? else { return Ok(None) };
        match choices.iter().find(|(name, _)| *name == found) {
            Some((_, value)) => Ok(Some(*value)),
            None => {
                let names = choices.iter().map(|(name, _)| *name);
                let known = suggestion(found, names, "expected one of");
                Err(self.problem(key, format!("found {found:?}; {known}")))
            }
        }
    }

    /// One of several named values.
    pub(super) fn needed_choice<T: Copy>(
        &self,
        key: &str,
        choices: &[(&str, T)],
    ) -> Result<T, DescriptionProblem> {
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        let missing = || self.missing(key, &format!("one of {}", names.join(", ")));
        self.choice(key, choices)?.ok_or_else(missing)
    }

    /// Whole number in a range, if the key is given.
    pub(super) fn integer(
        &self,
        key: &str,
        range: core::ops::RangeInclusive<i64>,
    ) -> Result<Option<i64>, DescriptionProblem> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match integer(value).filter(|number| range.contains(number)) {
            Some(number) => Ok(Some(number)),
            None => {
                let (least, most) = (range.start(), range.end());
                let expected = format!("a whole number from {least} to {most}");
                Err(self.wrong(key, value, &expected))
            }
        }
    }

    /// Finite number, if the key is given.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, DescriptionProblem> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match octant_toml_tree::number(&value.value).filter(|number: &f64| number.is_finite()) {
            Some(number) => Ok(Some(number)),
            None => Err(self.wrong(key, value, "a finite number")),
        }
    }

    /// Boolean, if the key is given.
    pub(super) fn boolean(&self, key: &str) -> Result<Option<bool>, DescriptionProblem> {
        match self.value(key).map(|value| (value, &value.value)) {
            None => Ok(None),
            Some((_, Value::Boolean(found))) => Ok(Some(*found)),
            Some((value, _)) => Err(self.wrong(key, value, "true or false")),
        }
    }

    /// Bytes.
    pub(super) fn bytes(&self, key: &str, most: usize) -> Result<Vec<u8>, DescriptionProblem> {
        let expected = format!("an array of 1 to {most} bytes, such as [0xFE, 0x81]");
        let Some(value) = self.value(key) else { return Err(self.missing(key, &expected)) };
        let wrong = || self.wrong(key, value, &expected);
        let Value::Array(entries) = &value.value else { return Err(wrong()) };
        let byte = |entry: &Node| integer(entry).and_then(|byte| u8::try_from(byte).ok());
        let bytes: Option<Vec<u8>> = entries.iter().map(byte).collect();
        bytes.filter(|bytes| (1..=most).contains(&bytes.len())).ok_or_else(wrong)
    }

    /// Table under a key, if it is given.
    pub(super) fn table(&self, key: &str) -> Result<Option<Table<'a>>, DescriptionProblem> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match &value.value {
            Value::Table(table) => Ok(Some(self.inner(table, key, &value.place))),
            _ => Err(self.wrong(key, value, "a table")),
        }
    }

    /// Tables of an array; none if the key is omitted.
    pub(super) fn tables(&self, key: &str) -> Result<Vec<Table<'a>>, DescriptionProblem> {
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let Value::Array(entries) = &value.value else {
            return Err(self.wrong(key, value, "an array of tables"));
        };
        let tables = entries.iter().enumerate().map(|(index, entry)| match &entry.value {
            Value::Table(table) => Ok(self.inner(table, &format!("{key}[{index}]"), &entry.place)),
            _ => Err(self.wrong(key, entry, "a table")),
        });
        tables.collect()
    }

    fn inner(&self, table: &'a octant_toml_tree::Table, key: &str, place: &Place) -> Table<'a> {
        let name = format!("{}{key}.", self.name);
        Table { text: self.text, table, name, place: place.clone() }
    }
}

/// Whole number, if a value is one of 64 bits.
fn integer(node: &Node) -> Option<i64> {
    match node.value {
        Value::Integer(number) => Some(number),
        _ => None,
    }
}

/// Version of the format of descriptions.
pub const VERSION: i64 = 2;

/// Error of a description.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct DescriptionProblem {
    /// File with line.
    pub place: String,
    /// Key, what was found, what was expected.
    pub what: String,
}
