//! Tables of a TOML file that know their place in it, and collect problems.

use crate::error::{RequirementsError, RequirementsProblem};
use crate::text::{control, normal};
use octant_base::names::suggestion;
use std::cell::RefCell;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Converts byte offsets to lines and columns, from 1; columns are counted in characters.
pub struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    /// Finds the lines of a text.
    pub fn new(text: &'a str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1);
        Self { text, starts: std::iter::once(0).chain(breaks).collect() }
    }

    /// Line and column of a byte.
    pub fn place(&self, offset: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line - 1];
        (line, self.text.get(start..offset).unwrap_or_default().chars().count() + 1)
    }
}

/// Describes a value, for "found …".
pub fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("{text:?}"),
        DeValue::Integer(number) => format!("the bare number {number}"),
        DeValue::Float(number) => format!("the bare number {number}"),
        DeValue::Boolean(value) => format!("{value}"),
        DeValue::Datetime(date) => format!("the date {date}"),
        DeValue::Array(entries) => format!("an array of {}", entries.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// All problems of a file.
pub struct Problems<'a> {
    /// Lines of the file.
    pub lines: Lines<'a>,
    /// The problems so far.
    pub all: RefCell<Vec<RequirementsProblem>>,
}

impl Problems<'_> {
    /// Reads the text of the file as TOML.
    pub fn table<'t>(
        &self,
        text: &'t str,
        file: &str,
    ) -> Result<Spanned<DeTable<'t>>, RequirementsError> {
        DeTable::parse(text).map_err(|error| {
            let at = self.lines.place(error.span().map_or(text.len(), |span| span.start));
            let message = format!("not TOML: {}", error.message().replace('\n', ", "));
            RequirementsError::one(file, RequirementsProblem::new(at, "", message))
        })
    }
}

/// A table of the file.
#[derive(Clone)]
pub struct Reader<'a> {
    table: &'a DeTable<'a>,
    /// Offset of the table's beginning.
    at: usize,
    path: String,
    problems: &'a Problems<'a>,
}

impl<'a> Reader<'a> {
    /// Reads a table that begins at an offset of the file.
    pub fn new(table: &'a DeTable<'a>, at: usize, path: &str, problems: &'a Problems<'a>) -> Self {
        Self { table, at, path: path.to_owned(), problems }
    }

    /// Gives the table another path in messages.
    pub fn with_path(mut self, path: String) -> Self {
        self.path = path;
        self
    }

    /// Path of a key of the table.
    pub fn path_of(&self, key: &str) -> String {
        match (self.path.as_str(), key) {
            ("", key) => key.to_owned(),
            (path, "") => path.to_owned(),
            (path, key) => format!("{path}.{key}"),
        }
    }

    /// Reports a problem at an offset of the file.
    fn problem_at(&self, offset: usize, key: &str, message: impl Into<String>) {
        let place = self.problems.lines.place(offset);
        self.problems.all.borrow_mut().push(RequirementsProblem::new(
            place,
            self.path_of(key),
            message,
        ));
    }

    /// Reports a problem with the value of a key, or with the table if the key is missing.
    pub fn problem(&self, key: &str, message: impl Into<String>) {
        let at = self.get(key).map_or(self.at, |value| value.span().start);
        self.problem_at(at, key, message);
    }

    /// Problems of the file.
    pub fn problems(&self) -> &'a Problems<'a> {
        self.problems
    }

    /// Line and column of a byte of the file.
    pub fn place(&self, offset: usize) -> (usize, usize) {
        self.problems.lines.place(offset)
    }

    /// Line in which the table begins.
    pub fn line(&self) -> usize {
        self.problems.lines.place(self.at).0
    }

    /// Value of a key.
    pub fn get(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table.iter().find(|(k, _)| k.get_ref() == key).map(|(_, value)| value)
    }

    /// True if the table has the key.
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// Keys and values in the order of writing.
    pub fn entries(&self) -> Vec<(&'a str, &'a Spanned<DeValue<'a>>)> {
        let mut entries: Vec<_> =
            self.table.iter().map(|(k, v)| (k.span().start, k.get_ref().as_ref(), v)).collect();
        entries.sort_by_key(|(at, ..)| *at);
        entries.into_iter().map(|(_, key, value)| (key, value)).collect()
    }

    /// Refuses keys that are not among `known`.
    pub fn known(&self, known: &[&str]) {
        for (key, _) in self.table.iter() {
            if !known.contains(&key.get_ref().as_ref()) {
                let message = format!(
                    "unknown key, {}",
                    suggestion(key.get_ref(), known.iter().copied(), "known")
                );
                self.problem_at(key.span().start, key.get_ref(), message);
            }
        }
    }

    /// Text of a value; problems are reported for `key`.
    pub fn text_of(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Option<String> {
        let DeValue::String(text) = value.get_ref() else {
            let found = describe(value.get_ref());
            self.problem_at(value.span().start, key, format!("found {found}, expected a text"));
            return None;
        };
        let text = normal(text);
        if text.is_empty() {
            self.problem_at(value.span().start, key, "found an empty text");
            return None;
        }
        if let Some(c) = control(&text) {
            let message = format!("found the control character {c:?} in a text");
            self.problem_at(value.span().start, key, message);
            return None;
        }
        Some(text)
    }

    /// Optional text; not empty.
    pub fn optional(&self, key: &str) -> Option<String> {
        self.text_of(key, self.get(key)?)
    }

    /// Optional text on one line. A tab, which names in other formats can't hold, becomes a space.
    pub fn line_of(&self, key: &str) -> Option<String> {
        let text = self.optional(key)?;
        if text.contains('\n') {
            self.problem(key, "found several lines, expected one");
            return None;
        }
        Some(text.replace('\t', " "))
    }

    /// Required text.
    pub fn required(&self, key: &str, what: &str) -> Option<String> {
        if !self.has(key) {
            self.problem_at(self.at, key, format!("missing, expected {what}"));
        }
        self.optional(key)
    }

    /// Text, or array of texts.
    pub fn texts_of(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Vec<String> {
        match value.get_ref() {
            DeValue::Array(entries) => {
                entries.iter().filter_map(|entry| self.text_of(key, entry)).collect()
            }
            _ => self.text_of(key, value).into_iter().collect(),
        }
    }

    /// Tables of an array of tables, or of an array with inline tables.
    pub fn tables(&self, key: &str) -> Vec<Reader<'a>> {
        let Some(value) = self.get(key) else { return Vec::new() };
        let DeValue::Array(entries) = value.get_ref() else {
            let found = describe(value.get_ref());
            self.problem(key, format!("found {found}, expected tables [[{key}]]"));
            return Vec::new();
        };
        let mut tables = Vec::new();
        for (index, entry) in entries.iter().enumerate() {
            let at = entry.span().start;
            match entry.get_ref() {
                DeValue::Table(table) => {
                    let path = self.path_of(&format!("{key}[{index}]"));
                    tables.push(Self::new(table, at, &path, self.problems));
                }
                other => {
                    let found = describe(other);
                    self.problem_at(at, key, format!("found {found}, expected a table"));
                }
            }
        }
        tables
    }

    /// Table inside this one.
    pub fn table(&self, key: &str) -> Option<Reader<'a>> {
        let value = self.get(key)?;
        match value.get_ref() {
            DeValue::Table(table) => {
                Some(Self::new(table, value.span().start, &self.path_of(key), self.problems))
            }
            other => {
                self.problem(key, format!("found {}, expected a table", describe(other)));
                None
            }
        }
    }
}

/// Checks the version of a file's schema.
pub fn schema(root: &Reader<'_>, expected: i64) -> bool {
    let version = match root.get("schema").map(|v| v.get_ref()) {
        None => {
            root.problem("schema", format!("missing, expected {expected}"));
            return false;
        }
        Some(DeValue::Integer(n)) => i64::from_str_radix(n.as_str(), n.radix()).ok(),
        Some(_) => None,
    };
    match version {
        Some(version) if version == expected => true,
        Some(newer) if newer > expected => {
            root.problem(
                "schema",
                format!(
                    "the file is of version {newer}, and this Octant reads version {expected}: it takes \
                     a newer Octant"
                ),
            );
            false
        }
        Some(other) => {
            root.problem("schema", format!("found version {other}, expected {expected}"));
            false
        }
        None => {
            let found = root.get("schema").map(|v| describe(v.get_ref())).unwrap_or_default();
            root.problem("schema", format!("found {found}, expected {expected}"));
            false
        }
    }
}
