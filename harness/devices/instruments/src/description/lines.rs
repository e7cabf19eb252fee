//! Lines of text.

use super::fields::{Places, ReadField, fields};
use super::ranges::{Ranges, is_whole};
use super::table::{DescriptionProblem, Table};
use crate::described::{
    BEGINS_BYTES_MAX, LINE_BYTES_MAX, LineChecksum, LineDescription, LineField, LineForm,
    LineSeparator,
};
use std::format;
use std::string::ToString as _;
use std::vec::Vec;

const SEPARATORS: [(&str, LineSeparator); 4] = [
    ("comma", LineSeparator::Character(b',')),
    ("semicolon", LineSeparator::Character(b';')),
    ("tab", LineSeparator::Character(b'\t')),
    ("whitespace", LineSeparator::Blanks),
];

const CHECKSUMS: [(&str, LineChecksum); 3] = [
    ("none", LineChecksum::None),
    ("nmea", LineChecksum::Nmea),
    ("vectornav", LineChecksum::VectorNav),
];

/// A form with what it owns.
struct ReadForm<'a> {
    begins: &'a str,
    separator: LineSeparator,
    columns: Option<usize>,
    checksum: LineChecksum,
    fields: Vec<LineField>,
}

/// Reads `[[line]]`.
pub(super) fn lines(root: &Table<'_>) -> Result<LineDescription, DescriptionProblem> {
    let skip_lines = root.integer("skip_lines", 0..=1_000_000)?.unwrap_or(0).unsigned_abs();
    let tables = root.tables("line")?;
    let mut forms: Vec<ReadForm<'_>> = Vec::new();
    let mut ranges = Ranges::default();
    let mut has_reading = false;
    for table in &tables {
        let form = form(table, &mut ranges)?;
        let alike = |other: &&ReadForm<'_>| {
            other.begins.starts_with(form.begins) || form.begins.starts_with(other.begins)
        };
        if let Some(other) = forms.iter().find(alike) {
            let what = format!(
                "found {:?}, which can't be told from {:?} of a line before it",
                form.begins, other.begins
            );
            return Err(table.problem("begins", what));
        }
        has_reading |= is_whole(form.fields.iter().map(|field| &field.meaning));
        forms.push(form);
    }
    if !has_reading {
        let what = "found no line with gyros and accelerometers, expected one at least: a reading has both";
        return Err(root.problem("line", what));
    }
    let views: Vec<LineForm<'_>> = forms
        .iter()
        .map(|ReadForm { begins, separator, columns, checksum, fields }| LineForm {
            begins: begins.as_bytes(),
            separator: *separator,
            columns: *columns,
            checksum: *checksum,
            fields,
        })
        .collect();
    LineDescription::new(&views, skip_lines, ranges.counter(), ranges.stamp())
        .map_err(|error| root.problem("line", error.to_string()))
}

fn form<'a>(table: &Table<'a>, ranges: &mut Ranges) -> Result<ReadForm<'a>, DescriptionProblem> {
    table.only(&["name", "begins", "separator", "columns", "checksum", "field"])?;
    // For people alone, but a text all the same.
    table.text("name")?;
    let begins = table.text("begins")?.unwrap_or("");
    if begins.len() > BEGINS_BYTES_MAX || begins.trim() != begins {
        let what = format!(
            "found {begins:?}, expected up to {BEGINS_BYTES_MAX} characters without blanks at the ends"
        );
        return Err(table.problem("begins", what));
    }
    let separator =
        table.choice("separator", &SEPARATORS)?.unwrap_or(LineSeparator::Character(b','));
    let checksum = table.needed_choice("checksum", &CHECKSUMS)?;
    let most = LINE_BYTES_MAX as i64;
    let columns = table.integer("columns", 1..=most)?.and_then(|count| usize::try_from(count).ok());
    if columns.is_none() && checksum == LineChecksum::None {
        let what = "missing, expected the number of columns: without a checksum it shows a line that isn't whole";
        return Err(table.problem("columns", what));
    }
    let read = fields(table, Places::Columns)?;
    for field in &read {
        ranges.take(table, field)?;
    }
    let fields: Vec<LineField> = read.iter().filter_map(ReadField::of_line).collect();
    if let Some(beyond) = fields.iter().find(|field| columns.is_some_and(|all| field.column > all))
    {
        let what = format!(
            "found {}, expected more than the column {} of a field",
            columns.unwrap_or(0),
            beyond.column
        );
        return Err(table.problem("columns", what));
    }
    Ok(ReadForm { begins, separator, columns, checksum, fields })
}
