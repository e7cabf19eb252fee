//! Reads a column of a table some rows at a time.

use super::layout::{ROWS_AT_A_TIME, TableError};
use super::values::{ColumnKind, ColumnValue, ColumnValues};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Values of a column, read some rows at a time.
pub(crate) struct ColumnCursor {
    path: PathBuf,
    kind: ColumnKind,
    reader: Option<ColumnReader>,
    /// Rows that weren't read yet.
    left: usize,
    /// Rows that were read, and the one that comes next.
    some: ColumnValues,
    at: usize,
}

impl ColumnCursor {
    /// Makes a cursor on the first of `rows` rows; a table without rows has no reader.
    pub(super) fn of(
        path: &Path,
        kind: ColumnKind,
        reader: Option<ColumnReader>,
        rows: usize,
    ) -> Self {
        let some = ColumnValues::new(kind);
        Self { path: path.to_owned(), kind, reader, left: rows, some, at: 0 }
    }

    /// Returns the kind of the column.
    pub(super) fn kind(&self) -> ColumnKind {
        self.kind
    }

    /// Returns the value of the next row; null after the last one.
    pub(crate) fn next(&mut self) -> Result<Option<ColumnValue>, TableError> {
        if self.at == self.some.len() && self.left > 0 {
            self.read()?;
        }
        self.at += 1;
        Ok(self.some.at(self.at - 1))
    }

    /// Passes over rows.
    pub(crate) fn skip(&mut self, mut rows: usize) -> Result<(), TableError> {
        while rows > 0 {
            let here = self.some.len().saturating_sub(self.at).min(rows);
            self.at += here;
            rows -= here;
            if rows > 0 {
                if self.left == 0 {
                    return Ok(());
                }
                self.read()?;
            }
        }
        Ok(())
    }

    fn read(&mut self) -> Result<(), TableError> {
        let wanted = self.left.min(ROWS_AT_A_TIME);
        // A text of one batch is shared with the first of the next one, if they are equal.
        let before = match &self.some {
            ColumnValues::Text(texts) => texts.last().cloned().flatten(),
            _ => None,
        };
        let read = match &mut self.reader {
            Some(ColumnReader::DoubleColumnReader(reader)) => {
                batch(reader, wanted, |v| v).map(ColumnValues::Number)
            }
            Some(ColumnReader::Int64ColumnReader(reader)) => {
                batch(reader, wanted, |v| v).map(ColumnValues::Integer)
            }
            Some(ColumnReader::BoolColumnReader(reader)) => {
                batch(reader, wanted, |v| v).map(ColumnValues::Boolean)
            }
            Some(ColumnReader::ByteArrayColumnReader(reader)) => {
                let mut last = before;
                let shared = |bytes: ByteArray| {
                    let text = String::from_utf8_lossy(bytes.data());
                    match &last {
                        Some(last) if **last == *text => Arc::clone(last),
                        _ => Arc::clone(last.insert(text.into())),
                    }
                };
                batch(reader, wanted, shared).map(ColumnValues::Text)
            }
            _ => Err(ParquetError::General("a column has another type".to_owned())),
        };
        let form = |error: ParquetError| TableError::Form {
            path: self.path.clone(),
            reason: error.to_string(),
        };
        let some = read.map_err(form)?;
        if some.is_empty() {
            let reason = format!("{} rows are missing", self.left);
            return Err(TableError::Form { path: self.path.clone(), reason });
        }
        self.left -= some.len();
        (self.some, self.at) = (some, 0);
        Ok(())
    }
}

/// Reads the next rows of a column, at most so many.
fn batch<D: DataType, T>(
    reader: &mut ColumnReaderImpl<D>,
    wanted: usize,
    mut from: impl FnMut(D::T) -> T,
) -> Result<Vec<Option<T>>, ParquetError> {
    let (mut levels, mut there) = (Vec::new(), Vec::new());
    reader.read_records(wanted, Some(&mut levels), None, &mut there)?;
    let mut there = there.into_iter();
    Ok(levels
        .into_iter()
        .map(|level| if level > 0 { there.next().map(&mut from) } else { None })
        .collect())
}
