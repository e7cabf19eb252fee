//! Reads rows of a delimited text file and keeps the position for error messages.

use super::SourceError;
use csv::StringRecord;
use octant_base::decimal::decimal_ns;
use octant_base::number::counted;
use octant_base::utc;
use octant_scenario::recorded::{Delimiter, RecordedColumn, TimeUnit};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Maximum length of a line: a file of another kind may have no line ends and must not fill the
/// memory.
const LINE_BYTES_MAX: u64 = 64 * 1024;

/// Reads row by row; skips empty lines and comments.
pub(super) struct Rows {
    path: String,
    file: BufReader<File>,
    delimiter: Delimiter,
    comment: String,
    text: String,
    line: u64,
    fields: StringRecord,
    header: Option<StringRecord>,
}

impl Rows {
    /// Opens a file and skips its first `skip_lines` lines. With `header` the next row names the
    /// columns.
    pub(super) fn open(
        path: &Path,
        delimiter: Delimiter,
        comment: &str,
        skip_lines: usize,
        header: bool,
    ) -> Result<Self, SourceError> {
        let name = path.display().to_string();
        let file = File::open(path)
            .map_err(|error| SourceError::Read { path: name.clone(), reason: error.to_string() })?;
        let mut rows = Self {
            path: name,
            file: BufReader::with_capacity(1 << 16, file),
            delimiter,
            comment: comment.into(),
            text: String::new(),
            line: 0,
            fields: StringRecord::new(),
            header: None,
        };
        for _ in 0..skip_lines {
            if !rows.read_line()? {
                let lines = counted(skip_lines, "line", "lines");
                return Err(rows.error(format!("the file ends within the {lines} to skip")));
            }
        }
        if header {
            if !rows.advance()? {
                return Err(rows
                    .error("the file ends, expected a line with the names of the columns".into()));
            }
            // A first row of data would be taken for names, and be lost.
            if rows.fields.iter().all(|field| field.parse::<f64>().is_ok()) {
                return Err(rows.error(
                    "found a row of numbers, expected the names of the columns: header = false has a file without them"
                        .into(),
                ));
            }
            rows.header = Some(rows.fields.clone());
        }
        Ok(rows)
    }

    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// Number of the current line, from 1.
    pub(super) fn line(&self) -> u64 {
        self.line
    }

    /// Advances to the next row; `false` at the end of the file.
    pub(super) fn advance(&mut self) -> Result<bool, SourceError> {
        loop {
            if !self.read_line()? {
                return Ok(false);
            }
            let line = match self.delimiter {
                Delimiter::Blanks => self.text.trim(),
                // Only line ends are trimmed: a tab may be the delimiter, and the first field may
                // be empty.
                Delimiter::Character(_) => self.text.trim_end_matches(['\r', '\n']),
            };
            if line.is_empty() || (!self.comment.is_empty() && line.starts_with(&self.comment)) {
                continue;
            }
            self.fields.clear();
            match self.delimiter {
                Delimiter::Blanks => self.fields.extend(line.split_ascii_whitespace()),
                Delimiter::Character(delimiter) if !line.contains('"') => {
                    self.fields.extend(line.split(char::from(delimiter)).map(str::trim));
                }
                Delimiter::Character(delimiter) => {
                    // Quotes are rare in data; the csv crate implements their rules.
                    let read = csv::ReaderBuilder::new()
                        .delimiter(delimiter)
                        .has_headers(false)
                        .flexible(true)
                        .trim(csv::Trim::All)
                        .from_reader(line.as_bytes())
                        .read_record(&mut self.fields);
                    if let Err(error) = read {
                        return Err(self.error(error.to_string()));
                    }
                }
            }
            return self.check_width().map(|()| true);
        }
    }

    /// Checks that a row has no more fields than the header has names: a comma in a number makes two of one. One empty field
    /// more is the delimiter at the end of a line.
    fn check_width(&self) -> Result<(), SourceError> {
        let Some(names) = self.header.as_ref().map(StringRecord::len) else { return Ok(()) };
        let fields = self.fields.len();
        let is_end = |fields: &StringRecord| fields.len() == names + 1 && fields[names].is_empty();
        if fields <= names || is_end(&self.fields) {
            return Ok(());
        }
        Err(self.error(format!(
            "found {}, expected {names} as in the header",
            counted(fields, "column", "columns")
        )))
    }

    /// Returns the index of a column, from 0.
    pub(super) fn column(&self, column: &RecordedColumn) -> Result<usize, SourceError> {
        match column {
            RecordedColumn::Number(0) => {
                Err(self.error("found column 0, expected a number from 1".into()))
            }
            RecordedColumn::Number(number) => Ok(number - 1),
            RecordedColumn::Name(name) => {
                let names: Vec<&str> = self.header.iter().flatten().collect();
                let mut found = (0..names.len()).filter(|index| names[*index] == name);
                match (found.next(), found.next()) {
                    (Some(index), None) => Ok(index),
                    (Some(one), Some(other)) => Err(self.error(format!(
                        "found two columns {name:?}, {} and {}, expected one: say which by its number",
                        one + 1,
                        other + 1
                    ))),
                    (None, _) => {
                        let hint = self.other_delimiter(&names).unwrap_or_default();
                        let names = names.join(", ");
                        Err(self.error(format!("no column {name:?}, found {names}{hint}")))
                    }
                }
            }
        }
    }

    /// Hint for a header of which one name has another delimiter in it, and the names beside it aren't columns of
    /// their own.
    fn other_delimiter(&self, names: &[&str]) -> Option<String> {
        const OTHERS: [(char, &str); 4] =
            [(',', "comma"), (';', "semicolon"), ('\t', "tab"), (' ', "whitespace")];
        let used = |other: char| match self.delimiter {
            Delimiter::Blanks => other.is_ascii_whitespace(),
            Delimiter::Character(delimiter) => char::from(delimiter) == other,
        };
        let found = OTHERS.into_iter().find(|(other, _)| {
            !used(*other) && names.iter().any(|name| name.trim().contains(*other))
        })?;
        let parts =
            names.iter().flat_map(|name| name.split(found.0)).filter(|part| !part.is_empty());
        let columns = counted(parts.count(), "column", "columns");
        let name = found.1;
        Some(format!("; with delimiter = {name:?} the line has {columns}"))
    }

    /// Returns the text of a field of this row.
    pub(super) fn field(&self, index: usize) -> Result<&str, SourceError> {
        self.fields.get(index).ok_or_else(|| {
            self.error(format!(
                "found {}, expected {} or more",
                counted(self.fields.len(), "column", "columns"),
                index + 1
            ))
        })
    }

    /// Returns a field as a finite number.
    pub(super) fn number(&self, index: usize) -> Result<f64, SourceError> {
        let text = self.field(index)?;
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.column_error(index, format!("found {text:?}, expected a finite number"))),
        }
    }

    /// Returns a field as a time, ns: a number, or a date with a time of day, whose two parts may be two fields.
    pub(super) fn time_ns(&self, index: usize, unit: TimeUnit) -> Result<u64, SourceError> {
        let text = self.field(index)?;
        if let Some(time) = utc::written(text, self.fields.get(index + 1)) {
            let found = u64::try_from(time.since_1970_ns).ok();
            return found.ok_or_else(|| {
                self.column_error(index, format!("found {text:?}, expected a time from 1970 on"))
            });
        }
        decimal_ns(text, unit.nanosecond_exponent()).ok_or_else(|| {
            let reason = format!("found {text:?}, expected a time from 0 to 2^64 ns, a number or such as 2027-03-31T08:00:00.5Z");
            self.column_error(index, reason)
        })
    }

    pub(super) fn column_error(&self, index: usize, reason: String) -> SourceError {
        self.error(format!("column {}: {reason}", index + 1))
    }

    pub(super) fn error(&self, reason: String) -> SourceError {
        self.error_at(self.line, &reason)
    }

    /// Adds the place of a line that was read before to a reason.
    pub(super) fn error_at(&self, line: u64, reason: &str) -> SourceError {
        SourceError::Read { path: self.path.clone(), reason: format!("line {line}: {reason}") }
    }

    fn read_line(&mut self) -> Result<bool, SourceError> {
        self.text.clear();
        let read = (&mut self.file).take(LINE_BYTES_MAX).read_line(&mut self.text);
        match read {
            Ok(0) => Ok(false),
            Ok(n) => {
                self.line += 1;
                if n as u64 == LINE_BYTES_MAX && !self.text.ends_with('\n') {
                    return Err(self.error(format!("longer than {LINE_BYTES_MAX} bytes")));
                }
                if self.line == 1 {
                    // A byte order mark is not part of the first field.
                    if let Some(rest) = self.text.strip_prefix('\u{feff}') {
                        self.text = rest.to_owned();
                    }
                }
                Ok(true)
            }
            Err(error) => {
                self.line += 1;
                Err(self.error(error.to_string()))
            }
        }
    }
}
