//! Reads tables: what a file is, and its columns.

use super::cursor::ColumnCursor;
use super::layout::{PLAN_KEY, SCHEMA, SCHEMA_WITH_UNITS, TableError, UNITS_KEY, VERSION_KEY};
use super::values::{ColumnKind, ColumnValues};
use parquet::basic::{Compression, Type as Physical};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Name of a compression as other programs write it, without its level.
fn compression_name(compression: Compression) -> String {
    let text = format!("{compression:?}").to_lowercase();
    text.split('(').next().unwrap_or_default().to_owned()
}

/// Existing table.
pub struct ExistingTable {
    path: PathBuf,
    reader: SerializedFileReader<File>,
    /// Id of its plan.
    pub plan: String,
    /// Names and kinds of the columns.
    pub columns: Vec<(String, ColumnKind)>,
    /// Units of columns, by name.
    pub units: BTreeMap<String, String>,
    /// Number of rows.
    pub rows: usize,
}

impl std::fmt::Debug for ExistingTable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Table").field("path", &self.path).field("rows", &self.rows).finish()
    }
}

impl ExistingTable {
    /// Opens a table.
    ///
    /// # Errors
    /// If it can't be read, isn't an octant table, or a newer version wrote it.
    pub fn open(path: &Path) -> Result<Self, TableError> {
        let form = |reason: String| TableError::Form { path: path.to_owned(), reason };
        let file = File::open(path).map_err(|source| TableError::System {
            action: "read",
            path: path.to_owned(),
            source,
        })?;
        let reader = SerializedFileReader::new(file).map_err(|error| form(error.to_string()))?;
        let metadata = reader.metadata();
        let pairs = metadata.file_metadata().key_value_metadata();
        let value = |key: &str| {
            let pair = pairs.into_iter().flatten().find(|pair| pair.key == key)?;
            pair.value.clone()
        };
        let Some(version) = value(VERSION_KEY) else {
            return Err(form(format!("it has no {VERSION_KEY}: expected a table of a campaign")));
        };
        if ![SCHEMA, SCHEMA_WITH_UNITS].contains(&version.as_str()) {
            return Err(form(format!(
                "found version {version}, this program reads {SCHEMA} and {SCHEMA_WITH_UNITS}"
            )));
        }
        let units = match value(UNITS_KEY) {
            None => BTreeMap::new(),
            Some(text) => serde_json::from_str(&text).map_err(|error| {
                form(format!("its {UNITS_KEY} isn't an object of texts: {error}"))
            })?,
        };
        let plan = value(PLAN_KEY).ok_or_else(|| form(format!("it has no {PLAN_KEY}")))?;
        let rows: i64 = metadata.file_metadata().num_rows();
        if metadata.num_row_groups() > 1 {
            return Err(form(format!(
                "found {} row groups, expected one",
                metadata.num_row_groups()
            )));
        }
        let stored = metadata.row_groups().iter().flat_map(|group| group.columns());
        for column in stored {
            match column.compression() {
                Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_) => {}
                other => {
                    return Err(form(format!(
                        "column {} is compressed with {}, expected zstd, snappy or none: write the table with \
                         compression=\"zstd\", as pandas' to_parquet and pyarrow's write_table take it",
                        column.column_descr().name(),
                        compression_name(other)
                    )));
                }
            }
        }
        let columns = metadata.file_metadata().schema_descr().columns();
        let columns = columns.iter().map(|column| {
            let kind = match column.physical_type() {
                Physical::DOUBLE => ColumnKind::Number,
                Physical::INT64 => ColumnKind::Integer,
                Physical::BOOLEAN => ColumnKind::Boolean,
                Physical::BYTE_ARRAY => ColumnKind::Text,
                other => return Err(form(format!("column {} has type {other}", column.name()))),
            };
            Ok((column.name().to_owned(), kind))
        });
        let columns = columns.collect::<Result<Vec<_>, _>>()?;
        let rows = usize::try_from(rows).map_err(|_| form(format!("it has {rows} rows")))?;
        Ok(Self { path: path.to_owned(), reader, plan, columns, units, rows })
    }

    /// Returns the values of a column; `None` if there is no such column.
    ///
    /// # Errors
    /// If the file is damaged.
    pub fn column(&self, name: &str) -> Result<Option<ColumnValues>, TableError> {
        let Some(mut cursor) = self.cursor(name)? else { return Ok(None) };
        let mut all = ColumnValues::new(cursor.kind());
        for _ in 0..self.rows {
            all.push(cursor.next()?);
        }
        Ok(Some(all))
    }

    /// Returns a cursor on the first row of a column; `None` if there is no such column.
    ///
    /// # Errors
    /// If the file is damaged.
    pub(crate) fn cursor(&self, name: &str) -> Result<Option<ColumnCursor>, TableError> {
        let Some(index) = self.columns.iter().position(|(other, _)| other == name) else {
            return Ok(None);
        };
        let kind = self.columns[index].1;
        let form = |error: ParquetError| TableError::Form {
            path: self.path.clone(),
            reason: error.to_string(),
        };
        let reader = if self.rows == 0 {
            None
        } else {
            let group = self.reader.get_row_group(0).map_err(form)?;
            Some(group.get_column_reader(index).map_err(form)?)
        };
        Ok(Some(ColumnCursor::of(&self.path, kind, reader, self.rows)))
    }
}
