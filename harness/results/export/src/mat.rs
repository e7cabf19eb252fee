//! MAT-file of level 5, uncompressed: one structure a table, its fields are the columns.
//!
//! Source: "MAT-File Format", The MathWorks, chapter 1, level 5. Sizes are known from the survey, so that every
//! column has its place before the first row is read; rows are written through a small buffer for each column.
//!
//! | column | in the file |
//! |---|---|
//! | number, integer | double, NaN without a value |
//! | boolean | logical; double if some rows have no value |
//! | text | cell array of char |

use super::error::ExportFailure;
use super::job::{EXPORT_VERSION, Job, NewFile};
use super::survey::{SurveyedColumn, SurveyedTable};
use super::table::{Cell, CellKind};
use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Types of data elements (table 1-1).
mod element {
    pub(super) const INT8: u32 = 1;
    pub(super) const UINT8: u32 = 2;
    pub(super) const INT32: u32 = 5;
    pub(super) const UINT32: u32 = 6;
    pub(super) const DOUBLE: u32 = 9;
    pub(super) const MATRIX: u32 = 14;
    pub(super) const UTF16: u32 = 17;
}

/// Classes of arrays (table 1-3), and the flag of logical ones.
mod class {
    pub(super) const CELL: u32 = 1;
    pub(super) const STRUCT: u32 = 2;
    pub(super) const CHAR: u32 = 4;
    pub(super) const DOUBLE: u32 = 6;
    pub(super) const LOGICAL_UINT8: u32 = 9 | 0x0200;
}

/// Bytes of a field's name, with the zero at its end.
const FIELD_NAME_BYTES: usize = 64;
/// Largest variable that readers of level 5 take, bytes.
const VARIABLE_BYTES_MAX: u64 = (1 << 31) - 1;
/// Bytes of an array before its data, without a name: tags, flags, dimensions, name, tag of the data.
const HEAD_BYTES: u64 = 8 + 16 + 16 + 8 + 8;
/// Bytes of a column that are kept before they are written.
const BUFFER_BYTES: usize = 32 * 1024;

/// Writes the file.
pub(crate) fn write(job: &Job<'_>) -> Result<Vec<PathBuf>, ExportFailure> {
    let new = NewFile::create(job.out, job.force)?;
    let mut file = new.file()?;
    let mut head = head();
    head.extend(about(job));
    head.extend(units(job));
    file.write_all(&head).map_err(|error| new.system(error))?;
    let mut at = head.len() as u64;
    let mut tables = Vec::new();
    for table in &job.survey.tables {
        let mut placed = Placed::new(job.out, table, at)?;
        at = placed.begin(&mut file).map_err(|error| new.system(error))?;
        tables.push(placed);
    }
    job.rows(&mut |index, cells| {
        tables[index].row(&mut file, cells).map_err(|error| new.system(error))
    })?;
    for table in &mut tables {
        table.finish(&mut file).map_err(|error| new.system(error))?;
    }
    drop(file);
    Ok(vec![new.finish()?])
}

/// Header of the file: text, version 1.0, byte order.
fn head() -> Vec<u8> {
    let text = format!("MATLAB 5.0 MAT-file, octant {}", env!("CARGO_PKG_VERSION"));
    let mut bytes = text.into_bytes();
    bytes.resize(116, b' ');
    // No data of subsystems.
    bytes.resize(124, 0);
    bytes.extend_from_slice(&0x0100u16.to_le_bytes());
    // The two letters, read as a number of the writer's byte order.
    bytes.extend_from_slice(b"IM");
    bytes
}

/// The variable `octant_export`: version, and the description of the export as JSON.
fn about(job: &Job<'_>) -> Vec<u8> {
    let fields = vec![
        ("version".to_owned(), number(f64::from(EXPORT_VERSION))),
        ("about".to_owned(), text(&job.about().to_string())),
    ];
    structure("octant_export", &fields)
}

/// The variable `units`: for every table a structure with the unit of each column.
fn units(job: &Job<'_>) -> Vec<u8> {
    let tables = job.survey.tables.iter().map(|table| {
        let columns = table.columns.iter();
        let fields: Vec<_> =
            columns.map(|found| (found.column.name.clone(), text(found.column.unit))).collect();
        (table.table.name().to_owned(), structure("", &fields))
    });
    structure("units", &tables.collect::<Vec<_>>())
}

fn tag(kind: u32, bytes: u32) -> [u8; 8] {
    let mut tag = [0; 8];
    tag[..4].copy_from_slice(&kind.to_le_bytes());
    tag[4..].copy_from_slice(&bytes.to_le_bytes());
    tag
}

/// Appends an element, padded to eight bytes.
fn element(to: &mut Vec<u8>, kind: u32, data: &[u8]) {
    to.extend_from_slice(&tag(kind, data.len() as u32));
    to.extend_from_slice(data);
    to.resize(to.len().next_multiple_of(8), 0);
}

/// First elements of an array: flags with its class, dimensions, name.
fn array_head(class: u32, dimensions: [u32; 2], name: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    element(&mut bytes, element::UINT32, &flags);
    element(&mut bytes, element::INT32, &dimensions.map(u32::to_le_bytes).concat());
    element(&mut bytes, element::INT8, name.as_bytes());
    bytes
}

/// Array as an element of a file or of another array.
fn matrix(body: &[u8]) -> Vec<u8> {
    let mut bytes = tag(element::MATRIX, body.len() as u32).to_vec();
    bytes.extend_from_slice(body);
    bytes
}

fn number(value: f64) -> Vec<u8> {
    let mut body = array_head(class::DOUBLE, [1, 1], "");
    element(&mut body, element::DOUBLE, &value.to_le_bytes());
    matrix(&body)
}

fn text(words: &str) -> Vec<u8> {
    let units: Vec<u8> = words.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let mut body = array_head(class::CHAR, [1, (units.len() / 2) as u32], "");
    element(&mut body, element::UTF16, &units);
    matrix(&body)
}

/// First elements of a structure: head, length of the names, names of the fields.
fn structure_head<'a>(name: &str, fields: impl Iterator<Item = &'a str>) -> Vec<u8> {
    let mut body = array_head(class::STRUCT, [1, 1], name);
    // In the short form: the number of bytes stands beside the type.
    body.extend_from_slice(&(element::INT32 | (4 << 16)).to_le_bytes());
    body.extend_from_slice(&(FIELD_NAME_BYTES as u32).to_le_bytes());
    let mut names = Vec::new();
    for field in fields {
        let from = names.len();
        names.extend(field.bytes().take(FIELD_NAME_BYTES - 1));
        names.resize(from + FIELD_NAME_BYTES, 0);
    }
    element(&mut body, element::INT8, &names);
    body
}

fn structure(name: &str, fields: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut body = structure_head(name, fields.iter().map(|(name, _)| name.as_str()));
    fields.iter().for_each(|(_, value)| body.extend_from_slice(value));
    matrix(&body)
}

/// Kind of array that a column becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Double,
    Logical,
    Cells,
}

/// Column with its place in the file.
struct PlacedColumn<'a> {
    found: &'a SurveyedColumn,
    form: Form,
    /// Place of the next value.
    at: u64,
    buffer: Vec<u8>,
}

/// Table with its place in the file.
struct Placed<'a> {
    table: &'a SurveyedTable,
    start: u64,
    head: Vec<u8>,
    columns: Vec<PlacedColumn<'a>>,
}

impl<'a> Placed<'a> {
    fn new(path: &Path, table: &'a SurveyedTable, start: u64) -> Result<Self, ExportFailure> {
        let names = table.columns.iter().map(|found| found.column.name.as_str());
        let columns = table.columns.iter().map(|found| PlacedColumn {
            found,
            form: form(found, table.rows),
            at: 0,
            buffer: Vec::new(),
        });
        let head = structure_head(table.table.name(), names);
        let placed = Self { table, start, head, columns: columns.collect() };
        let bytes = placed.bytes();
        if bytes > VARIABLE_BYTES_MAX {
            return Err(ExportFailure::TooLarge {
                path: path.to_owned(),
                what: table.table.name().to_owned(),
                bytes,
                max: VARIABLE_BYTES_MAX,
            });
        }
        Ok(placed)
    }

    /// Bytes of the variable behind its tag.
    fn bytes(&self) -> u64 {
        let columns = self.columns.iter().map(|column| 8 + column.bytes(self.table.rows));
        self.head.len() as u64 + columns.sum::<u64>()
    }

    /// Writes all heads, and leaves room for the values; returns the end.
    fn begin(&mut self, file: &mut File) -> std::io::Result<u64> {
        let rows = self.table.rows;
        file.seek(SeekFrom::Start(self.start))?;
        file.write_all(&tag(element::MATRIX, self.bytes() as u32))?;
        file.write_all(&self.head)?;
        let mut at = self.start + 8 + self.head.len() as u64;
        for column in &mut self.columns {
            file.seek(SeekFrom::Start(at))?;
            file.write_all(&tag(element::MATRIX, column.bytes(rows) as u32))?;
            let (class, data) = match column.form {
                Form::Double => (class::DOUBLE, Some((element::DOUBLE, 8 * rows))),
                Form::Logical => (class::LOGICAL_UINT8, Some((element::UINT8, rows))),
                Form::Cells => (class::CELL, None),
            };
            let mut head = array_head(class, [rows as u32, 1], "");
            if let Some((kind, bytes)) = data {
                head.extend_from_slice(&tag(kind, bytes as u32));
            }
            file.write_all(&head)?;
            column.at = at + 8 + head.len() as u64;
            at += 8 + column.bytes(rows);
        }
        // The file has its whole length, also where values are fewer than their padding.
        file.set_len(at)?;
        Ok(at)
    }

    fn row(&mut self, file: &mut File, cells: &[Cell]) -> std::io::Result<()> {
        for column in &mut self.columns {
            column.push(&cells[column.found.place]);
            if column.buffer.len() >= BUFFER_BYTES {
                column.flush(file)?;
            }
        }
        Ok(())
    }

    fn finish(&mut self, file: &mut File) -> std::io::Result<()> {
        self.columns.iter_mut().try_for_each(|column| column.flush(file))
    }
}

fn form(found: &SurveyedColumn, rows: u64) -> Form {
    match found.column.kind {
        CellKind::Text => Form::Cells,
        CellKind::Boolean if found.filled == rows => Form::Logical,
        _ => Form::Double,
    }
}

impl PlacedColumn<'_> {
    /// Bytes of the array behind its tag.
    fn bytes(&self, rows: u64) -> u64 {
        match self.form {
            Form::Double => HEAD_BYTES - 8 + 8 * rows,
            Form::Logical => HEAD_BYTES - 8 + rows.next_multiple_of(8),
            // Without a tag of data: the cells are arrays themselves.
            Form::Cells => HEAD_BYTES - 16 + rows * HEAD_BYTES + 2 * self.found.text_units,
        }
    }

    fn push(&mut self, cell: &Cell) {
        match self.form {
            Form::Double => self.buffer.extend_from_slice(&cell.as_f64().to_le_bytes()),
            Form::Logical => self.buffer.push(u8::from(*cell == Cell::Boolean(true))),
            Form::Cells => {
                let words = if let Cell::Text(words) = cell { words.as_str() } else { "" };
                self.buffer.extend(text(words));
            }
        }
    }

    fn flush(&mut self, file: &mut File) -> std::io::Result<()> {
        file.seek(SeekFrom::Start(self.at))?;
        file.write_all(&self.buffer)?;
        self.at += self.buffer.len() as u64;
        self.buffer.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_has_128_bytes_and_the_order_of_the_writer() {
        let head = head();
        assert_eq!(head.len(), 128);
        assert_eq!(&head[124..], [0x00, 0x01, b'I', b'M']);
    }

    #[test]
    fn a_text_has_the_size_that_places_count_with() {
        for words in ["", "a", "abcd", "abcde", "µσ", "𝛿"] {
            let units = (words.encode_utf16().count() as u64).next_multiple_of(4);
            assert_eq!(text(words).len() as u64, HEAD_BYTES + 2 * units, "{words}");
        }
        // Tag, flags 16, dimensions 16, no name 8, tag and value 16.
        assert_eq!(number(1.0).len(), 8 + 16 + 16 + 8 + 16);
        assert_eq!(number(1.0).len() as u64, HEAD_BYTES + 8);
    }
}
