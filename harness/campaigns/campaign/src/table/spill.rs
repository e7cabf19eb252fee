//! Rows of a table on their way into a file, in memory that doesn't grow with their number.
//!
//! Results come case by case, and a table is written column by column. So the values of each column are
//! collected, and every few of them go to a temporary file, compressed.

use crate::table::{ColumnKind, ColumnValue, ColumnValues, TableError};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of rows of a block.
const BLOCK: usize = 1024;
/// Level of compression: the fastest.
const LEVEL: i32 = 1;

/// Rows, with the columns that they need.
#[derive(Debug)]
pub(crate) struct SpilledRows {
    /// Folder of the temporary file.
    folder: PathBuf,
    /// Temporary file without a name, and its length; `None` as long as it isn't needed.
    file: Option<(File, u64)>,
    /// The first columns in their order, then others in the order in which they came.
    columns: Vec<SpilledColumn>,
    rows: usize,
}

#[derive(Debug)]
struct SpilledColumn {
    name: String,
    kind: ColumnKind,
    /// Place and length of each block.
    blocks: Vec<(u64, u32)>,
    /// Values after them.
    last: ColumnValues,
}

impl SpilledRows {
    /// Makes a table without rows, with these columns. Its temporary file will be in a folder.
    pub(crate) fn new(folder: &Path, first: &[(&str, ColumnKind)]) -> Self {
        let columns = first.iter().map(|(name, kind)| SpilledColumn::of(name, *kind)).collect();
        Self { folder: folder.to_owned(), file: None, columns, rows: 0 }
    }

    /// Returns the kinds of the columns.
    pub(crate) fn kinds(&self) -> BTreeMap<&str, ColumnKind> {
        self.columns.iter().map(|column| (column.name.as_str(), column.kind)).collect()
    }

    /// Appends a row.
    pub(crate) fn push(
        &mut self,
        mut row: BTreeMap<String, ColumnValue>,
    ) -> Result<(), TableError> {
        let wrong = self::wrong(&self.folder);
        for column in &mut self.columns {
            let value = row.remove(&column.name);
            column.push(value, &mut self.file, &self.folder).map_err(&wrong)?;
        }
        for (name, value) in row {
            let mut column = SpilledColumn::of(&name, value.kind());
            for _ in 0..self.rows {
                column.push(None, &mut self.file, &self.folder).map_err(&wrong)?;
            }
            column.push(Some(value), &mut self.file, &self.folder).map_err(&wrong)?;
            self.columns.push(column);
        }
        self.rows += 1;
        Ok(())
    }

    /// Appends a row that has a value, or none, for each of the columns in their order, and for no other.
    pub(crate) fn push_values<const COLUMNS: usize>(
        &mut self,
        values: [Option<ColumnValue>; COLUMNS],
    ) -> Result<(), TableError> {
        for (column, value) in self.columns.iter_mut().zip(values) {
            column.push(value, &mut self.file, &self.folder).map_err(wrong(&self.folder))?;
        }
        self.rows += 1;
        Ok(())
    }

    /// Returns the values of a column in the order of the rows; nulls if there is no such column.
    pub(crate) fn column(&self, name: &str) -> SpilledValues<'_> {
        let column = self.columns.iter().find(|column| column.name == name);
        SpilledValues { rows: self, column, block: 0, values: None, at: 0, given: 0 }
    }
}

fn wrong(folder: &Path) -> impl Fn(io::Error) -> TableError {
    |source| TableError::System {
        action: "keep rows of a table in a temporary file of",
        path: folder.to_owned(),
        source,
    }
}

impl SpilledColumn {
    fn of(name: &str, kind: ColumnKind) -> Self {
        Self { name: name.to_owned(), kind, blocks: Vec::new(), last: ColumnValues::new(kind) }
    }

    fn push(
        &mut self,
        value: Option<ColumnValue>,
        file: &mut Option<(File, u64)>,
        folder: &Path,
    ) -> io::Result<()> {
        self.last.push(value);
        if self.last.len() < BLOCK {
            return Ok(());
        }
        let block = std::mem::replace(&mut self.last, ColumnValues::new(self.kind));
        let bytes = zstd::bulk::compress(&encoded(&block), LEVEL)?;
        let (file, end) = match file {
            Some(file) => file,
            None => {
                std::fs::create_dir_all(folder)?;
                file.insert((tempfile::tempfile_in(folder)?, 0))
            }
        };
        file.write_all(&bytes)?;
        self.blocks.push((*end, u32::try_from(bytes.len()).map_err(io::Error::other)?));
        *end += bytes.len() as u64;
        Ok(())
    }
}

/// Values of a column, one after another.
#[derive(Debug)]
pub(crate) struct SpilledValues<'a> {
    rows: &'a SpilledRows,
    column: Option<&'a SpilledColumn>,
    /// Block that comes next.
    block: usize,
    /// Block that is given out; `None` for the values after the last block.
    values: Option<ColumnValues>,
    at: usize,
    given: usize,
}

impl SpilledValues<'_> {
    fn read(&self, (place, bytes): (u64, u32)) -> io::Result<ColumnValues> {
        let missing = || io::Error::from(io::ErrorKind::UnexpectedEof);
        let (file, _) = self.rows.file.as_ref().ok_or_else(missing)?;
        let kind = self.column.map_or(ColumnKind::Text, |column| column.kind);
        let mut block = vec![0; bytes as usize];
        let mut file: &File = file;
        file.seek(SeekFrom::Start(place))?;
        file.read_exact(&mut block)?;
        decoded(kind, &zstd::stream::decode_all(block.as_slice())?).ok_or_else(missing)
    }
}

impl Iterator for SpilledValues<'_> {
    type Item = Result<Option<ColumnValue>, TableError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.given == self.rows.rows {
            return None;
        }
        self.given += 1;
        let Some(column) = self.column else { return Some(Ok(None)) };
        if self.values.as_ref().is_none_or(|values| self.at == values.len())
            && let Some(place) = column.blocks.get(self.block)
        {
            match self.read(*place) {
                Ok(values) => (self.values, self.at) = (Some(values), 0),
                Err(error) => return Some(Err(wrong(&self.rows.folder)(error))),
            }
            self.block += 1;
        }
        let value = match &self.values {
            Some(values) if self.at < values.len() => values.at(self.at),
            _ => column.last.at(self.given - 1 - column.blocks.len() * BLOCK),
        };
        self.at += 1;
        Some(Ok(value))
    }
}

/// Bytes of a block: a byte for each row tells whether a value follows.
fn encoded(values: &ColumnValues) -> Vec<u8> {
    fn put<T>(all: &[Option<T>], mut each: impl FnMut(&mut Vec<u8>, &T)) -> Vec<u8> {
        let mut bytes: Vec<u8> = all.iter().map(|value| u8::from(value.is_some())).collect();
        all.iter().flatten().for_each(|value| each(&mut bytes, value));
        bytes
    }
    match values {
        ColumnValues::Text(all) => put(all, |bytes, text| {
            bytes.extend((text.len() as u64).to_le_bytes());
            bytes.extend(text.as_bytes());
        }),
        ColumnValues::Number(all) => put(all, |bytes, number| bytes.extend(number.to_le_bytes())),
        ColumnValues::Integer(all) => put(all, |bytes, number| bytes.extend(number.to_le_bytes())),
        ColumnValues::Boolean(all) => put(all, |bytes, value| bytes.push(u8::from(*value))),
    }
}

/// Values from the bytes of a block.
fn decoded(kind: ColumnKind, bytes: &[u8]) -> Option<ColumnValues> {
    fn eight(rest: &mut &[u8]) -> Option<[u8; 8]> {
        let (first, after) = rest.split_first_chunk()?;
        *rest = after;
        Some(*first)
    }
    let (there, mut rest) = bytes.split_at_checked(BLOCK)?;
    let mut values = ColumnValues::new(kind);
    for is_there in there {
        let value = match (is_there, kind) {
            (0, _) => None,
            (_, ColumnKind::Number) => {
                Some(ColumnValue::Number(f64::from_le_bytes(eight(&mut rest)?)))
            }
            (_, ColumnKind::Integer) => {
                Some(ColumnValue::Integer(i64::from_le_bytes(eight(&mut rest)?)))
            }
            (_, ColumnKind::Boolean) => {
                let (first, after) = rest.split_first()?;
                rest = after;
                Some(ColumnValue::Boolean(*first != 0))
            }
            (_, ColumnKind::Text) => {
                let length = usize::try_from(u64::from_le_bytes(eight(&mut rest)?)).ok()?;
                let (text, after) = rest.split_at_checked(length)?;
                rest = after;
                Some(ColumnValue::Text(Arc::from(std::str::from_utf8(text).ok()?)))
            }
        };
        values.push(value);
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More rows than a block, columns that come late, and nulls.
    #[test]
    fn what_is_pushed_comes_back_column_by_column() {
        let folder = tempfile::tempdir().unwrap();
        let mut rows = SpilledRows::new(folder.path(), &[("id", ColumnKind::Text)]);
        let count = 3 * BLOCK + 5;
        let of = |row: usize| -> BTreeMap<String, ColumnValue> {
            let mut all = BTreeMap::new();
            all.insert("id".to_owned(), ColumnValue::Text(format!("ü{}", row / 3).into()));
            if row % 3 != 1 {
                all.insert("number".to_owned(), ColumnValue::Number(row as f64 / 7.0));
                all.insert("whole".to_owned(), ColumnValue::Integer(-(row as i64)));
            }
            if row > 2 * BLOCK {
                all.insert("late".to_owned(), ColumnValue::Boolean(row.is_multiple_of(2)));
            }
            all
        };
        for row in 0..count {
            rows.push(of(row)).unwrap();
        }
        assert_eq!(rows.rows, count);
        assert_eq!(rows.kinds().len(), 4);
        for name in ["id", "number", "whole", "late", "none"] {
            let found: Vec<_> = rows.column(name).map(Result::unwrap).collect();
            let expected: Vec<_> = (0..count).map(|row| of(row).remove(name)).collect();
            assert!(found == expected, "{name}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "it has no name");
        let mut again = SpilledRows::new(
            folder.path(),
            &[("id", ColumnKind::Text), ("number", ColumnKind::Number)],
        );
        for row in 0..count {
            let mut row = of(row);
            again.push_values([row.remove("id"), row.remove("number")]).unwrap();
        }
        for name in ["id", "number"] {
            assert!(
                again.column(name).map(Result::unwrap).eq(rows.column(name).map(Result::unwrap))
            );
        }
    }
}
