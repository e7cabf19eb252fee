//! Tables of a TOML file that know their place in it, and collect problems.

use crate::error::{RequirementsError, RequirementsProblem, suggestion};
use std::cell::RefCell;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Converts byte offsets to lines and columns, from 1; columns are counted in characters.
pub(crate) struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1);
        Self { text, starts: std::iter::once(0).chain(breaks).collect() }
    }

    pub(crate) fn place(&self, offset: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line - 1];
        (line, self.text.get(start..offset).unwrap_or_default().chars().count() + 1)
    }
}

/// Normalizes a text: without surrounding space, and with plain line breaks.
pub(crate) fn normal(text: &str) -> String {
    text.replace("\r\n", "\n").replace('\r', "\n").trim().to_owned()
}

/// First character that other formats can't hold.
pub(crate) fn control(text: &str) -> Option<char> {
    let legal = |c: char| matches!(c, '\n' | '\t') || !c.is_control();
    text.chars().find(|c| !legal(*c) || matches!(c, '\u{fffe}' | '\u{ffff}'))
}

/// Describes a value, for "found …".
pub(crate) fn describe(value: &DeValue<'_>) -> String {
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
pub(crate) struct Problems<'a> {
    pub(crate) lines: Lines<'a>,
    pub(crate) all: RefCell<Vec<RequirementsProblem>>,
}

impl Problems<'_> {
    /// Reads the text of the file as TOML.
    pub(crate) fn table<'t>(
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
pub(crate) struct Reader<'a> {
    table: &'a DeTable<'a>,
    /// Offset of the table's beginning.
    at: usize,
    path: String,
    problems: &'a Problems<'a>,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(
        table: &'a DeTable<'a>,
        at: usize,
        path: &str,
        problems: &'a Problems<'a>,
    ) -> Self {
        Self { table, at, path: path.to_owned(), problems }
    }

    pub(crate) fn with_path(mut self, path: String) -> Self {
        self.path = path;
        self
    }

    pub(crate) fn path_of(&self, key: &str) -> String {
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
    pub(crate) fn problem(&self, key: &str, message: impl Into<String>) {
        let at = self.get(key).map_or(self.at, |value| value.span().start);
        self.problem_at(at, key, message);
    }

    pub(crate) fn problems(&self) -> &'a Problems<'a> {
        self.problems
    }

    pub(crate) fn place(&self, offset: usize) -> (usize, usize) {
        self.problems.lines.place(offset)
    }

    pub(crate) fn line(&self) -> usize {
        self.problems.lines.place(self.at).0
    }

    pub(crate) fn get(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table.iter().find(|(k, _)| k.get_ref() == key).map(|(_, value)| value)
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// Keys and values in the order of writing.
    pub(crate) fn entries(&self) -> Vec<(&'a str, &'a Spanned<DeValue<'a>>)> {
        let mut entries: Vec<_> =
            self.table.iter().map(|(k, v)| (k.span().start, k.get_ref().as_ref(), v)).collect();
        entries.sort_by_key(|(at, ..)| *at);
        entries.into_iter().map(|(_, key, value)| (key, value)).collect()
    }

    /// Refuses keys that are not among `known`.
    pub(crate) fn known(&self, known: &[&str]) {
        for (key, _) in self.table.iter() {
            if !known.contains(&key.get_ref().as_ref()) {
                let message = format!("unknown key, {}", suggestion(key.get_ref(), known));
                self.problem_at(key.span().start, key.get_ref(), message);
            }
        }
    }

    /// Text of a value; problems are reported for `key`.
    pub(crate) fn text_of(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Option<String> {
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
    pub(crate) fn optional(&self, key: &str) -> Option<String> {
        self.text_of(key, self.get(key)?)
    }

    /// Optional text on one line. A tab, which names in other formats can't hold, becomes a space.
    pub(crate) fn line_of(&self, key: &str) -> Option<String> {
        let text = self.optional(key)?;
        if text.contains('\n') {
            self.problem(key, "found several lines, expected one");
            return None;
        }
        Some(text.replace('\t', " "))
    }

    /// Required text.
    pub(crate) fn required(&self, key: &str, what: &str) -> Option<String> {
        if !self.has(key) {
            self.problem_at(self.at, key, format!("missing, expected {what}"));
        }
        self.optional(key)
    }

    /// Text, or array of texts.
    pub(crate) fn texts_of(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Vec<String> {
        match value.get_ref() {
            DeValue::Array(entries) => {
                entries.iter().filter_map(|entry| self.text_of(key, entry)).collect()
            }
            _ => self.text_of(key, value).into_iter().collect(),
        }
    }

    /// Tables of an array of tables, or of an array with inline tables.
    pub(crate) fn tables(&self, key: &str) -> Vec<Reader<'a>> {
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
    pub(crate) fn table(&self, key: &str) -> Option<Reader<'a>> {
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
pub(crate) fn schema(root: &Reader<'_>, expected: i64) -> bool {
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

/// Decodes the bytes of a text file: UTF-8 or UTF-16, or another encoding that an XML declaration names.
pub(crate) fn decode(bytes: &[u8], file: &str) -> Result<String, RequirementsError> {
    let wrong = |line: usize, message: String| {
        RequirementsError::one(file, RequirementsProblem::new((line, 1), "", message))
    };
    let wide = match bytes {
        [0xff, 0xfe, ..] => Some(false),
        [0xfe, 0xff, ..] => Some(true),
        // A UTF-16 file without a mark begins with `<` and a zero.
        [0x3c, 0x00, ..] => Some(false),
        [0x00, 0x3c, ..] => Some(true),
        _ => None,
    };
    if let Some(big) = wide {
        let (pairs, rest) = bytes.as_chunks::<2>();
        let units =
            pairs.iter().map(|p| if big { u16::from_be_bytes(*p) } else { u16::from_le_bytes(*p) });
        let text: Result<String, _> = char::decode_utf16(units).collect();
        return match text {
            Ok(text) if rest.is_empty() => Ok(text.trim_start_matches('\u{feff}').to_owned()),
            _ => Err(wrong(1, "the text is no valid UTF-16".to_owned())),
        };
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let error = match std::str::from_utf8(bytes) {
        Ok(text) => return Ok(text.to_owned()),
        Err(error) => error,
    };
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
    let declared = head.split_once("encoding=").and_then(|(_, rest)| {
        let mut parts = rest.splitn(3, ['"', '\'']);
        parts.nth(1)
    });
    if matches!(declared, Some("iso-8859-1" | "latin1" | "windows-1252" | "cp1252")) {
        return Ok(octant_base::encoding::windows_1252(bytes));
    }
    let line = bytes[..error.valid_up_to()].iter().filter(|b| **b == b'\n').count() + 1;
    let found = bytes[error.valid_up_to()];
    let declared = declared.map_or_else(String::new, |name| format!(", and declares {name:?}"));
    Err(wrong(
        line,
        format!(
            "the text is not UTF-8: found the byte 0x{found:02x}{declared}; expected UTF-8 or UTF-16"
        ),
    ))
}
