//! Tables as Parquet files: written and read one column at a time, and a column some rows at a time.
//!
//! A file has one row group, every column may be null, and it contains nothing of host or clock:
//! the same table gives the same bytes.

use octant_base::arrow::{ARROW_SCHEMA_KEY, ArrowField, ArrowKind, arrow_schema};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Version of the tables' layout.
pub const SCHEMA: &str = "1";
/// Version of tables in which columns have units.
pub const SCHEMA_WITH_UNITS: &str = "2";
/// Metadata key of the version.
const VERSION_KEY: &str = "octant.schema";
/// Metadata key of the plan's id.
const PLAN_KEY: &str = "octant.plan";
/// Metadata key of the units: a JSON object from names of columns to units.
const UNITS_KEY: &str = "octant.units";

/// Values of a column, by row.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues {
    /// Texts; equal neighbours share one allocation.
    Text(Vec<Option<Arc<str>>>),
    /// Numbers.
    Number(Vec<Option<f64>>),
    /// Whole numbers.
    Integer(Vec<Option<i64>>),
    /// Booleans.
    Boolean(Vec<Option<bool>>),
}

/// Kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ColumnKind {
    /// Texts.
    Text,
    /// Numbers.
    Number,
    /// Whole numbers.
    Integer,
    /// Booleans.
    Boolean,
}

/// One value.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValue {
    /// A text.
    Text(Arc<str>),
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// Boolean.
    Boolean(bool),
}

impl ColumnKind {
    /// Returns a value as a column of this kind holds it: of another kind as text in a text column, and
    /// null in any other.
    #[must_use]
    pub fn converted(self, value: Option<ColumnValue>) -> Option<ColumnValue> {
        match (self, value?) {
            (Self::Text, ColumnValue::Text(text)) => Some(ColumnValue::Text(text)),
            (Self::Text, ColumnValue::Number(number)) => {
                Some(ColumnValue::Text(number.to_string().into()))
            }
            (Self::Text, ColumnValue::Integer(number)) => {
                Some(ColumnValue::Text(number.to_string().into()))
            }
            (Self::Text, ColumnValue::Boolean(value)) => {
                Some(ColumnValue::Text(value.to_string().into()))
            }
            (Self::Number, ColumnValue::Integer(number)) => {
                Some(ColumnValue::Number(number as f64))
            }
            (kind, value) => (kind == value.kind()).then_some(value),
        }
    }
}

impl ColumnValue {
    /// Returns the kind of column that holds it.
    #[must_use]
    pub const fn kind(&self) -> ColumnKind {
        match self {
            Self::Text(_) => ColumnKind::Text,
            Self::Number(_) => ColumnKind::Number,
            Self::Integer(_) => ColumnKind::Integer,
            Self::Boolean(_) => ColumnKind::Boolean,
        }
    }
}

impl ColumnValues {
    /// Creates an empty column of a kind.
    #[must_use]
    pub const fn new(kind: ColumnKind) -> Self {
        match kind {
            ColumnKind::Text => Self::Text(Vec::new()),
            ColumnKind::Number => Self::Number(Vec::new()),
            ColumnKind::Integer => Self::Integer(Vec::new()),
            ColumnKind::Boolean => Self::Boolean(Vec::new()),
        }
    }

    /// Returns the kind.
    #[must_use]
    pub const fn kind(&self) -> ColumnKind {
        match self {
            Self::Text(_) => ColumnKind::Text,
            Self::Number(_) => ColumnKind::Number,
            Self::Integer(_) => ColumnKind::Integer,
            Self::Boolean(_) => ColumnKind::Boolean,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Text(all) => all.len(),
            Self::Number(all) => all.len(),
            Self::Integer(all) => all.len(),
            Self::Boolean(all) => all.len(),
        }
    }

    /// Returns whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends a value, or null; a value of another kind becomes text in a text column, and null in
    /// any other.
    pub fn push(&mut self, value: Option<ColumnValue>) {
        let value = self.kind().converted(value);
        match (self, value) {
            (Self::Text(all), Some(ColumnValue::Text(text))) => push_text(all, Some(text)),
            (Self::Number(all), Some(ColumnValue::Number(number))) => all.push(Some(number)),
            (Self::Integer(all), Some(ColumnValue::Integer(number))) => all.push(Some(number)),
            (Self::Boolean(all), Some(ColumnValue::Boolean(value))) => all.push(Some(value)),
            (Self::Text(all), _) => all.push(None),
            (Self::Number(all), _) => all.push(None),
            (Self::Integer(all), _) => all.push(None),
            (Self::Boolean(all), _) => all.push(None),
        }
    }

    /// Returns the value of a row.
    #[must_use]
    pub fn at(&self, row: usize) -> Option<ColumnValue> {
        match self {
            Self::Text(all) => all.get(row)?.clone().map(ColumnValue::Text),
            Self::Number(all) => (*all.get(row)?).map(ColumnValue::Number),
            Self::Integer(all) => (*all.get(row)?).map(ColumnValue::Integer),
            Self::Boolean(all) => (*all.get(row)?).map(ColumnValue::Boolean),
        }
    }
}

/// Appends a text, sharing it with the last one if they are equal.
fn push_text(all: &mut Vec<Option<Arc<str>>>, text: Option<Arc<str>>) {
    let text = text.map(|text| match all.last() {
        Some(Some(last)) if *last == text => Arc::clone(last),
        _ => text,
    });
    all.push(text);
}

/// Reasons why a table could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The operating system refused.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// Path that the action concerned.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file isn't an octant table, or isn't complete.
    #[error("read {path}: {reason}")]
    Form {
        /// The file.
        path: PathBuf,
        /// Problem found.
        reason: String,
    },
    /// The table could not be written.
    #[error("write {path}: {reason}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
}

/// Writes a table whose columns are built one after another, in the given order of names.
///
/// # Errors
/// If the operating system refuses; an earlier file then stays unchanged.
pub fn write<'a>(
    path: &Path,
    plan: &str,
    columns: &[(String, ColumnKind)],
    values: impl FnMut(usize) -> Result<std::borrow::Cow<'a, ColumnValues>, TableError>,
) -> Result<(), TableError> {
    write_with_units(path, plan, columns, &BTreeMap::new(), values)
}

/// Writes a table as [`write()`] does, with units of columns in their metadata.
///
/// # Errors
/// As [`write()`].
pub fn write_with_units<'a>(
    path: &Path,
    plan: &str,
    columns: &[(String, ColumnKind)],
    units: &BTreeMap<String, String>,
    mut values: impl FnMut(usize) -> Result<std::borrow::Cow<'a, ColumnValues>, TableError>,
) -> Result<(), TableError> {
    write_streamed(path, plan, columns, units, |index| {
        let values = values(index)?;
        Ok((0..values.len()).map(move |row| Ok(values.at(row))))
    })
}

/// Writes a table as [`write_with_units`] does, from the values of each column one after another. No more
/// than some thousands of them are in memory.
///
/// # Errors
/// As [`write()`], or those of the values.
pub(super) fn write_streamed<V>(
    path: &Path,
    plan: &str,
    columns: &[(String, ColumnKind)],
    units: &BTreeMap<String, String>,
    mut values: impl FnMut(usize) -> Result<V, TableError>,
) -> Result<(), TableError>
where
    V: Iterator<Item = Result<Option<ColumnValue>, TableError>>,
{
    let folder = path.parent().unwrap_or(Path::new("."));
    let system = |source| TableError::System { action: "write", path: path.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(system)?;
    super::clean(folder);
    let new = super::new_file(folder).map_err(system)?;
    let wrong = |error: ParquetError| TableError::Write {
        path: path.to_owned(),
        reason: error.to_string(),
    };
    let fields = columns.iter().map(|(name, kind)| field(name, *kind)).collect::<Result<_, _>>();
    let root = Type::group_type_builder("octant").with_fields(fields.map_err(wrong)?).build();
    let pair = |key: &str, value: &str| KeyValue::new(key.to_owned(), value.to_owned());
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(3).map_err(wrong)?))
        .set_key_value_metadata(Some(match units.is_empty() {
            true => vec![pair(VERSION_KEY, SCHEMA), pair(PLAN_KEY, plan)],
            false => vec![
                pair(VERSION_KEY, SCHEMA_WITH_UNITS),
                pair(PLAN_KEY, plan),
                pair(UNITS_KEY, &serde_json::json!(units).to_string()),
                pair(ARROW_SCHEMA_KEY, &arrow_schema(&arrow_fields(columns, units))),
            ],
        }))
        .build();
    let file = new.as_file().try_clone().map_err(system)?;
    let schema = Arc::new(root.map_err(wrong)?);
    let mut writer =
        SerializedFileWriter::new(file, schema, Arc::new(properties)).map_err(wrong)?;
    let mut group = writer.next_row_group().map_err(wrong)?;
    let mut index = 0;
    while let Some(mut column) = group.next_column().map_err(wrong)? {
        let mut all = values(index)?;
        let kind = columns.get(index).map_or(ColumnKind::Text, |(_, kind)| *kind);
        loop {
            let mut some = ColumnValues::new(kind);
            for value in all.by_ref().take(ROWS_AT_A_TIME) {
                some.push(value?);
            }
            if some.is_empty() {
                break;
            }
            match &some {
                ColumnValues::Text(all) => {
                    let bytes = |text: &Arc<str>| ByteArray::from(&**text);
                    put(&mut column, all, bytes, |c| c.typed::<ByteArrayType>())
                }
                ColumnValues::Number(all) => {
                    put(&mut column, all, |v| *v, |c| c.typed::<DoubleType>())
                }
                ColumnValues::Integer(all) => {
                    put(&mut column, all, |v| *v, |c| c.typed::<Int64Type>())
                }
                ColumnValues::Boolean(all) => {
                    put(&mut column, all, |v| *v, |c| c.typed::<BoolType>())
                }
            }
            .map_err(wrong)?;
        }
        column.close().map_err(wrong)?;
        index += 1;
    }
    group.close().map_err(wrong)?;
    writer.close().map_err(wrong)?;
    new.as_file().sync_data().map_err(system)?;
    new.persist(path).map_err(|error| system(error.error))?;
    Ok(())
}

/// Fields for readers of Arrow, which show metadata of columns.
fn arrow_fields(
    columns: &[(String, ColumnKind)],
    units: &BTreeMap<String, String>,
) -> Vec<ArrowField> {
    let field = |(name, kind): &(String, ColumnKind)| ArrowField {
        name: name.clone(),
        kind: match kind {
            ColumnKind::Text => ArrowKind::Utf8,
            ColumnKind::Number => ArrowKind::Double,
            ColumnKind::Integer => ArrowKind::Int64,
            ColumnKind::Boolean => ArrowKind::Boolean,
        },
        metadata: units
            .get(name)
            .map(|unit| ("unit".to_owned(), unit.clone()))
            .into_iter()
            .collect(),
    };
    columns.iter().map(field).collect()
}

/// Number of rows passed to the library, or taken from it, at a time: it needs values in types of
/// its own.
const ROWS_AT_A_TIME: usize = 16 * 1024;

fn put<T, D: DataType>(
    column: &mut parquet::file::writer::SerializedColumnWriter<'_>,
    values: &[Option<T>],
    to: impl Fn(&T) -> D::T,
    typed: impl for<'a, 'b> Fn(
        &'a mut parquet::file::writer::SerializedColumnWriter<'b>,
    ) -> &'a mut parquet::column::writer::ColumnWriterImpl<'b, D>,
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let there: Vec<D::T> = values.iter().flatten().map(to).collect();
    typed(column).write_batch(&there, Some(&levels), None)?;
    Ok(())
}

fn field(name: &str, kind: ColumnKind) -> Result<Arc<Type>, ParquetError> {
    let physical = match kind {
        ColumnKind::Text => Physical::BYTE_ARRAY,
        ColumnKind::Number => Physical::DOUBLE,
        ColumnKind::Integer => Physical::INT64,
        ColumnKind::Boolean => Physical::BOOLEAN,
    };
    Type::primitive_type_builder(name, physical)
        .with_logical_type((kind == ColumnKind::Text).then_some(LogicalType::String))
        .with_repetition(Repetition::OPTIONAL)
        .build()
        .map(Arc::new)
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
        let mut all = ColumnValues::new(cursor.kind);
        while cursor.left > 0 || cursor.at < cursor.some.len() {
            all.push(cursor.next()?);
        }
        Ok(Some(all))
    }

    /// Returns a cursor on the first row of a column; `None` if there is no such column.
    ///
    /// # Errors
    /// If the file is damaged.
    pub(super) fn cursor(&self, name: &str) -> Result<Option<ColumnCursor>, TableError> {
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
        let (path, some) = (self.path.clone(), ColumnValues::new(kind));
        Ok(Some(ColumnCursor { path, kind, reader, left: self.rows, some, at: 0 }))
    }
}

/// Values of a column, read some rows at a time.
pub(super) struct ColumnCursor {
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
    /// Returns the value of the next row; null after the last one.
    pub(super) fn next(&mut self) -> Result<Option<ColumnValue>, TableError> {
        if self.at == self.some.len() && self.left > 0 {
            self.read()?;
        }
        self.at += 1;
        Ok(self.some.at(self.at - 1))
    }

    /// Passes over rows.
    pub(super) fn skip(&mut self, mut rows: usize) -> Result<(), TableError> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::borrow::Cow;

    type Row = (Option<String>, Option<f64>, Option<i64>, Option<bool>);

    /// More rows than are passed at a time, with nulls on both sides of the boundary.
    #[test]
    fn a_long_table_is_read_as_it_was_written() {
        let rows = 2 * ROWS_AT_A_TIME + 77;
        let kept = |row: usize| row % 3 != 1;
        let all = [
            ColumnValues::Text(
                (0..rows).map(|row| kept(row).then(|| (row / 50).to_string().into())).collect(),
            ),
            ColumnValues::Number((0..rows).map(|row| kept(row).then_some(row as f64)).collect()),
        ];
        let columns: Vec<(String, ColumnKind)> =
            all.iter().zip(["a", "b"]).map(|(v, name)| (name.to_owned(), v.kind())).collect();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.parquet");
        write(&path, "p", &columns, |i| Ok(Cow::Borrowed(&all[i]))).unwrap();
        let table = ExistingTable::open(&path).unwrap();
        assert_eq!(table.rows, rows);
        for ((name, _), values) in columns.iter().zip(&all) {
            assert!(table.column(name).unwrap().unwrap() == *values, "{name}");
        }
        let Some(ColumnValues::Text(texts)) = table.column("a").unwrap() else { panic!("texts") };
        let (first, later) = (texts[2].as_ref().unwrap(), texts[3].as_ref().unwrap());
        assert!(Arc::ptr_eq(first, later), "held once");
    }

    proptest! {
        #[test]
        fn what_was_written_is_read(rows in proptest::collection::vec(any::<Row>(), 0..50)) {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a/table.parquet");
            let all = [
                ColumnValues::Text(rows.iter().map(|row| row.0.as_deref().map(Arc::from)).collect()),
                ColumnValues::Number(rows.iter().map(|row| row.1.filter(|v| !v.is_nan())).collect()),
                ColumnValues::Integer(rows.iter().map(|row| row.2).collect()),
                ColumnValues::Boolean(rows.iter().map(|row| row.3).collect()),
            ];
            let columns: Vec<(String, ColumnKind)> =
                all.iter().zip(["a", "b.c", "d", "e"]).map(|(v, name)| (name.to_owned(), v.kind())).collect();
            let write_it = |path: &Path| write(path, "of this plan", &columns, |i| Ok(Cow::Borrowed(&all[i])));
            write_it(&path).unwrap();
            let table = ExistingTable::open(&path).unwrap();
            prop_assert_eq!(&table.columns, &columns);
            prop_assert_eq!(table.plan.as_str(), "of this plan");
            for ((name, _), values) in columns.iter().zip(&all) {
                prop_assert_eq!(&table.column(name).unwrap().unwrap(), values);
            }
            prop_assert_eq!(table.column("none").unwrap(), None);
            let again = folder.path().join("again.parquet");
            write_it(&again).unwrap();
            prop_assert_eq!(std::fs::read(&path).unwrap(), std::fs::read(&again).unwrap());
        }
    }
}
