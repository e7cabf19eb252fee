//! Tables of a description with the places of their keys.

use super::problem::DescriptionProblem;
use octant_base::names::suggestion;
use std::borrow::ToOwned as _;
use std::format;
use std::string::{String, ToString as _};
use std::vec::Vec;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A file and its text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Text<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
}

impl Text<'_> {
    /// Makes a problem at an offset of the text.
    pub(super) fn problem(&self, offset: usize, what: String) -> DescriptionProblem {
        let before = self.text.get(..offset).unwrap_or(self.text);
        let line = 1 + before.matches('\n').count();
        DescriptionProblem { place: format!("{}:{line}", self.file), what }
    }
}

type Value<'a> = Spanned<DeValue<'a>>;

/// Describes a value, for "found …".
fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("{:?}", text.as_ref()),
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(date) => format!("the date {date}"),
        DeValue::Array(entries) => format!("an array of {}", entries.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// A table.
#[derive(Clone, Debug)]
pub(super) struct Table<'a> {
    text: Text<'a>,
    table: &'a DeTable<'a>,
    /// Name in messages, with a point behind it; empty at the root.
    name: String,
    /// Offset of the table in the text.
    offset: usize,
}

impl<'a> Table<'a> {
    /// Makes the table of a whole file.
    pub(super) fn root(text: Text<'a>, table: &'a DeTable<'a>) -> Self {
        Self { text, table, name: String::new(), offset: 0 }
    }

    /// Value of a key.
    fn value(&self, key: &str) -> Option<&'a Value<'a>> {
        self.table.iter().find(|(found, _)| found.get_ref() == key).map(|(_, value)| value)
    }

    /// True if the key is given.
    pub(super) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// Makes a problem of a key, or of the table if the key is omitted.
    pub(super) fn problem(&self, key: &str, what: impl core::fmt::Display) -> DescriptionProblem {
        let offset = self.value(key).map_or(self.offset, |value| value.span().start);
        self.text.problem(offset, format!("{}{key}: {what}", self.name))
    }

    /// Makes a problem of the table as a whole.
    pub(super) fn problem_of_all(&self, what: impl core::fmt::Display) -> DescriptionProblem {
        let name = self.name.trim_end_matches('.');
        let colon = if name.is_empty() { "" } else { ": " };
        self.text.problem(self.offset, format!("{name}{colon}{what}"))
    }

    /// Checks that there are no other keys.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), DescriptionProblem> {
        let mut unknown: Vec<(usize, &str)> = (self.table.iter())
            .map(|(key, _)| (key.span().start, key.get_ref().as_ref()))
            .filter(|(_, key)| !known.contains(key))
            .collect();
        unknown.sort_unstable();
        match unknown.first() {
            None => Ok(()),
            Some((offset, key)) => {
                let known = suggestion(key, known.iter().copied(), "known keys");
                Err(self.text.problem(*offset, format!("{}{key}: unknown key; {known}", self.name)))
            }
        }
    }

    fn wrong(&self, key: &str, value: &Value<'_>, expected: &str) -> DescriptionProblem {
        self.problem(key, format!("found {}, expected {expected}", describe(value.get_ref())))
    }

    fn missing(&self, key: &str, expected: &str) -> DescriptionProblem {
        self.problem(key, format!("missing, expected {expected}"))
    }

    /// Text under a key, if it is given.
    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, DescriptionProblem> {
        match self.value(key).map(|value| (value, value.get_ref())) {
            None => Ok(None),
            Some((_, DeValue::String(text))) if !text.chars().any(char::is_control) => {
                Ok(Some(text.as_ref()))
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
        let number = match value.get_ref() {
            DeValue::Float(number) => number.as_str().parse().ok(),
            _ => integer(value).map(|number| number as f64),
        };
        match number.filter(|number: &f64| number.is_finite()) {
            Some(number) => Ok(Some(number)),
            None => Err(self.wrong(key, value, "a finite number")),
        }
    }

    /// Boolean, if the key is given.
    pub(super) fn boolean(&self, key: &str) -> Result<Option<bool>, DescriptionProblem> {
        match self.value(key).map(|value| (value, value.get_ref())) {
            None => Ok(None),
            Some((_, DeValue::Boolean(found))) => Ok(Some(*found)),
            Some((value, _)) => Err(self.wrong(key, value, "true or false")),
        }
    }

    /// Bytes.
    pub(super) fn bytes(&self, key: &str, most: usize) -> Result<Vec<u8>, DescriptionProblem> {
        let expected = format!("an array of 1 to {most} bytes, such as [0xFE, 0x81]");
        let Some(value) = self.value(key) else { return Err(self.missing(key, &expected)) };
        let wrong = || self.wrong(key, value, &expected);
        let DeValue::Array(entries) = value.get_ref() else { return Err(wrong()) };
        let byte = |entry: &Value<'_>| integer(entry).and_then(|byte| u8::try_from(byte).ok());
        let bytes: Option<Vec<u8>> = entries.iter().map(byte).collect();
        bytes.filter(|bytes| (1..=most).contains(&bytes.len())).ok_or_else(wrong)
    }

    /// Table under a key, if it is given.
    pub(super) fn table(&self, key: &str) -> Result<Option<Table<'a>>, DescriptionProblem> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Table(table) => Ok(Some(self.inner(table, key, value.span().start))),
            _ => Err(self.wrong(key, value, "a table")),
        }
    }

    /// Tables of an array; none if the key is omitted.
    pub(super) fn tables(&self, key: &str) -> Result<Vec<Table<'a>>, DescriptionProblem> {
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let DeValue::Array(entries) = value.get_ref() else {
            return Err(self.wrong(key, value, "an array of tables"));
        };
        let tables = entries.iter().enumerate().map(|(index, entry)| match entry.get_ref() {
            DeValue::Table(table) => {
                Ok(self.inner(table, &format!("{key}[{index}]"), entry.span().start))
            }
            _ => Err(self.wrong(key, entry, "a table")),
        });
        tables.collect()
    }

    fn inner(&self, table: &'a DeTable<'a>, key: &str, offset: usize) -> Table<'a> {
        Table { text: self.text, table, name: format!("{}{key}.", self.name), offset }
    }
}

/// Whole number, if a value is one of 64 bits.
fn integer(value: &Value<'_>) -> Option<i64> {
    match value.get_ref() {
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).ok(),
        _ => None,
    }
}
