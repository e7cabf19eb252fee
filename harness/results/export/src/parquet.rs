//! A folder of Parquet files, one a table, with units in each column's metadata.
//!
//! Columns may be null. The unit and the description are metadata of the field in the Arrow schema, which readers
//! that know Arrow show, and in the key `octant.columns` as JSON for all others.

use super::csv::about_file;
use super::error::ExportFailure;
use super::job::{EXPORT_VERSION, Job, NewFile, columns_json};
use super::survey::SurveyedTable;
use super::table::{Cell, CellKind};
use octant_base::arrow::{ARROW_SCHEMA_KEY, ArrowField, ArrowKind, arrow_schema};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::column::writer::ColumnWriterImpl;
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use std::fs::File;
use std::path::PathBuf;
use std::sync::Arc;

/// Rows of a row group: they are in memory until it is written.
const GROUP_ROWS: usize = 32 * 1024;

struct TableFile<'a> {
    new: NewFile,
    table: &'a SurveyedTable,
    writer: SerializedFileWriter<File>,
    /// Cells of the row group so far, by column.
    cells: Vec<Vec<Cell>>,
}

/// Writes `TABLE.parquet` for every table, and `export.json`; returns the files.
pub(crate) fn write(job: &Job<'_>) -> Result<Vec<PathBuf>, ExportFailure> {
    let open = |table| TableFile::create(job, table);
    let mut files = job.survey.tables.iter().map(open).collect::<Result<Vec<_>, _>>()?;
    let about = about_file(job)?;
    job.rows(&mut |index, cells| files[index].row(cells))?;
    let mut written = Vec::new();
    for file in files {
        written.push(file.finish()?);
    }
    written.push(about.finish()?);
    Ok(written)
}

impl<'a> TableFile<'a> {
    fn create(job: &Job<'_>, table: &'a SurveyedTable) -> Result<Self, ExportFailure> {
        let path = job.out.join(format!("{}.parquet", table.table.name()));
        let new = NewFile::create(&path, job.force)?;
        let writer = begin(job, table, new.file()?).map_err(|error| new.format(error))?;
        let cells = table.columns.iter().map(|_| Vec::with_capacity(GROUP_ROWS)).collect();
        Ok(Self { new, table, writer, cells })
    }

    fn row(&mut self, row: &[Cell]) -> Result<(), ExportFailure> {
        for (column, found) in self.cells.iter_mut().zip(&self.table.columns) {
            column.push(row[found.place].clone());
        }
        match self.cells.first() {
            Some(first) if first.len() >= GROUP_ROWS => self.flush(),
            _ => Ok(()),
        }
    }

    fn flush(&mut self) -> Result<(), ExportFailure> {
        if self.cells.first().is_none_or(Vec::is_empty) {
            return Ok(());
        }
        let kinds = self.table.columns.iter().map(|found| found.column.kind);
        group(&mut self.writer, kinds, &self.cells).map_err(|error| self.new.format(error))?;
        self.cells.iter_mut().for_each(Vec::clear);
        Ok(())
    }

    fn finish(mut self) -> Result<PathBuf, ExportFailure> {
        self.flush()?;
        let Self { new, writer, .. } = self;
        writer.close().map_err(|error| new.format(error))?;
        new.finish()
    }
}

fn begin(
    job: &Job<'_>,
    table: &SurveyedTable,
    file: File,
) -> Result<SerializedFileWriter<File>, ParquetError> {
    let fields = table.columns.iter().map(|found| {
        let (physical, logical) = match found.column.kind {
            CellKind::Number => (Physical::DOUBLE, None),
            CellKind::Integer => (Physical::INT64, None),
            CellKind::Boolean => (Physical::BOOLEAN, None),
            CellKind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        Type::primitive_type_builder(&found.column.name, physical)
            .with_logical_type(logical)
            .with_repetition(Repetition::OPTIONAL)
            .build()
            .map(Arc::new)
    });
    let fields = fields.collect::<Result<Vec<_>, _>>()?;
    let schema = Type::group_type_builder("octant").with_fields(fields).build()?;
    let pair = |key: &str, value: String| KeyValue::new(key.to_owned(), value);
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(3)?))
        .set_key_value_metadata(Some(vec![
            pair("octant.export", EXPORT_VERSION.to_string()),
            pair("octant.columns", columns_json(table).to_string()),
            pair("octant.run", serde_json::json!(job.info.run).to_string()),
            pair(ARROW_SCHEMA_KEY, arrow_schema(&arrow_fields(table))),
        ]))
        .build();
    SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))
}

fn arrow_fields(table: &SurveyedTable) -> Vec<ArrowField> {
    let field = |found: &super::survey::SurveyedColumn| {
        let column = &found.column;
        let mut metadata = vec![("description".to_owned(), column.description.clone())];
        if !column.unit.is_empty() {
            metadata.insert(0, ("unit".to_owned(), column.unit.to_owned()));
        }
        ArrowField {
            name: column.name.clone(),
            kind: match column.kind {
                CellKind::Number => ArrowKind::Double,
                CellKind::Integer => ArrowKind::Int64,
                CellKind::Boolean => ArrowKind::Boolean,
                CellKind::Text => ArrowKind::Utf8,
            },
            metadata,
        }
    };
    table.columns.iter().map(field).collect()
}

/// Writes one row group.
fn group(
    writer: &mut SerializedFileWriter<File>,
    kinds: impl Iterator<Item = CellKind>,
    cells: &[Vec<Cell>],
) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for (kind, cells) in kinds.zip(cells) {
        let Some(mut column) = group.next_column()? else { break };
        match kind {
            CellKind::Number => put(&mut column, cells, number, |c| c.typed::<DoubleType>()),
            CellKind::Integer => put(&mut column, cells, integer, |c| c.typed::<Int64Type>()),
            CellKind::Boolean => put(&mut column, cells, boolean, |c| c.typed::<BoolType>()),
            CellKind::Text => put(&mut column, cells, text, |c| c.typed::<ByteArrayType>()),
        }?;
        column.close()?;
    }
    group.close()?;
    Ok(())
}

fn number(cell: &Cell) -> Option<f64> {
    Some(cell.as_f64()).filter(|number| !number.is_nan())
}

const fn integer(cell: &Cell) -> Option<i64> {
    if let Cell::Integer(number) = cell { Some(*number) } else { None }
}

const fn boolean(cell: &Cell) -> Option<bool> {
    if let Cell::Boolean(value) = cell { Some(*value) } else { None }
}

fn text(cell: &Cell) -> Option<ByteArray> {
    if let Cell::Text(text) = cell { Some(ByteArray::from(text.as_str())) } else { None }
}

fn put<D: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    cells: &[Cell],
    value: impl Fn(&Cell) -> Option<D::T>,
    typed: impl for<'a, 'b> Fn(&'a mut SerializedColumnWriter<'b>) -> &'a mut ColumnWriterImpl<'b, D>,
) -> Result<(), ParquetError> {
    let values: Vec<Option<D::T>> = cells.iter().map(value).collect();
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let there: Vec<D::T> = values.into_iter().flatten().collect();
    typed(column).write_batch(&there, Some(&levels), None)?;
    Ok(())
}
