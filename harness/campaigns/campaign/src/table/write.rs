//! Writes tables column by column.

use super::layout::{
    PLAN_KEY, ROWS_AT_A_TIME, SCHEMA, SCHEMA_WITH_UNITS, TableError, UNITS_KEY, VERSION_KEY,
};
use super::values::{ColumnKind, ColumnValue, ColumnValues};
use octant_base::arrow::{ARROW_SCHEMA_KEY, ArrowField, ArrowKind, arrow_schema};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

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
pub(crate) fn write_streamed<V>(
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
    octant_base::whole_file::clean(folder);
    let new = octant_base::whole_file::new_file(folder).map_err(system)?;
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
