//! Tables of a TOML file that know their place in it, and collect problems.

use crate::error::{RequirementsError, RequirementsProblem};
use crate::text::{control, normal};
use octant_base::names::suggestion;
use octant_toml_tree::error::Place;
use octant_toml_tree::{Entry, Node, Table, Value, number_as_written};
use std::cell::RefCell;

/// All problems of a file.
pub struct Problems<'a> {
    /// Text of the file.
    text: &'a str,
    /// The problems so far.
    pub all: RefCell<Vec<RequirementsProblem>>,
}

impl<'a> Problems<'a> {
    /// No problems of a text yet.
    pub fn new(text: &'a str) -> Self {
        Self { text, all: RefCell::default() }
    }

    /// Reads the text of the file as TOML.
    pub fn table(&self, file: &str) -> Result<Table, RequirementsError> {
        octant_toml_tree::read(self.text).map_err(|problem| {
            let at = position(&problem.place);
            RequirementsError::one(file, RequirementsProblem::new(at, "", problem.message))
        })
    }

    /// Describes a value, for "found …".
    pub fn describe(&self, node: &Node) -> String {
        match &node.value {
            Value::Integer(_) | Value::Number(_) => {
                format!("the bare number {}", number_as_written(self.text, &node.place))
            }
            other => other.describe(),
        }
    }
}

/// Line and column of a place in a file, from 1; columns are counted in characters.
pub fn position(place: &Place) -> (usize, usize) {
    match *place {
        Place::File { line, column } => (line, column),
        _ => (1, 1),
    }
}

/// A table of the file.
#[derive(Clone)]
pub struct Reader<'a> {
    table: &'a Table,
    /// Place of the table's beginning.
    at: Place,
    path: String,
    problems: &'a Problems<'a>,
}

impl<'a> Reader<'a> {
    /// Reads the table that a file is.
    pub fn root(table: &'a Table, problems: &'a Problems<'a>) -> Self {
        Self::new(table, &Place::File { line: 1, column: 1 }, "", problems)
    }

    /// Reads a table that begins at a place of the file.
    pub fn new(table: &'a Table, at: &Place, path: &str, problems: &'a Problems<'a>) -> Self {
        Self { table, at: at.clone(), path: path.to_owned(), problems }
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

    /// Reports a problem at a place of the file.
    fn problem_at(&self, place: &Place, key: &str, message: impl Into<String>) {
        self.problems.all.borrow_mut().push(RequirementsProblem::new(
            position(place),
            self.path_of(key),
            message,
        ));
    }

    /// Reports a problem with the value of a key, or with the table if the key is missing.
    pub fn problem(&self, key: &str, message: impl Into<String>) {
        let at = self.get(key).map_or(&self.at, |value| &value.place);
        self.problem_at(at, key, message);
    }

    /// Problems of the file.
    pub fn problems(&self) -> &'a Problems<'a> {
        self.problems
    }

    /// Describes a value, for "found …".
    pub fn describe(&self, node: &Node) -> String {
        self.problems.describe(node)
    }

    /// Line in which the table begins.
    pub fn line(&self) -> usize {
        position(&self.at).0
    }

    /// Value of a key.
    pub fn get(&self, key: &str) -> Option<&'a Node> {
        self.table.get(key)
    }

    /// True if the table has the key.
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// Keys and values in the order of writing.
    pub fn entries(&self) -> Vec<(&'a str, &'a Node)> {
        self.table.entries.iter().map(|entry| (entry.key.as_str(), &entry.node)).collect()
    }

    /// Refuses keys that are not among `known`.
    pub fn known(&self, known: &[&str]) {
        for Entry { key, place, .. } in &self.table.entries {
            if !known.contains(&key.as_str()) {
                let message =
                    format!("unknown key, {}", suggestion(key, known.iter().copied(), "known"));
                self.problem_at(place, key, message);
            }
        }
    }

    /// Text of a value; problems are reported for `key`.
    pub fn text_of(&self, key: &str, value: &Node) -> Option<String> {
        let Value::Text(text) = &value.value else {
            let found = self.describe(value);
            self.problem_at(&value.place, key, format!("found {found}, expected a text"));
            return None;
        };
        let text = normal(text);
        if text.is_empty() {
            self.problem_at(&value.place, key, "found an empty text");
            return None;
        }
        if let Some(c) = control(&text) {
            let message = format!("found the control character {c:?} in a text");
            self.problem_at(&value.place, key, message);
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
            self.problem_at(&self.at, key, format!("missing, expected {what}"));
        }
        self.optional(key)
    }

    /// Text, or array of texts.
    pub fn texts_of(&self, key: &str, value: &Node) -> Vec<String> {
        match &value.value {
            Value::Array(entries) => {
                entries.iter().filter_map(|entry| self.text_of(key, entry)).collect()
            }
            _ => self.text_of(key, value).into_iter().collect(),
        }
    }

    /// Tables of an array of tables, or of an array with inline tables.
    pub fn tables(&self, key: &str) -> Vec<Reader<'a>> {
        let Some(value) = self.get(key) else { return Vec::new() };
        let Value::Array(entries) = &value.value else {
            let found = self.describe(value);
            self.problem(key, format!("found {found}, expected tables [[{key}]]"));
            return Vec::new();
        };
        let mut tables = Vec::new();
        for (index, entry) in entries.iter().enumerate() {
            let at = &entry.place;
            match &entry.value {
                Value::Table(table) => {
                    let path = self.path_of(&format!("{key}[{index}]"));
                    tables.push(Self::new(table, at, &path, self.problems));
                }
                _ => {
                    let found = self.describe(entry);
                    self.problem_at(at, key, format!("found {found}, expected a table"));
                }
            }
        }
        tables
    }

    /// Table inside this one.
    pub fn table(&self, key: &str) -> Option<Reader<'a>> {
        let value = self.get(key)?;
        match &value.value {
            Value::Table(table) => {
                Some(Self::new(table, &value.place, &self.path_of(key), self.problems))
            }
            _ => {
                self.problem(key, format!("found {}, expected a table", self.describe(value)));
                None
            }
        }
    }
}

/// Checks the version of a file's schema.
pub fn schema(root: &Reader<'_>, expected: i64) -> bool {
    let version = match root.get("schema").map(|node| &node.value) {
        None => {
            root.problem("schema", format!("missing, expected {expected}"));
            return false;
        }
        Some(Value::Integer(version)) => Some(*version),
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
            let found = root.get("schema").map(|node| root.describe(node)).unwrap_or_default();
            root.problem("schema", format!("found {found}, expected {expected}"));
            false
        }
    }
}
