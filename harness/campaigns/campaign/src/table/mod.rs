//! Tables as Parquet files: written and read one column at a time, and a column some rows at a time.
//!
//! A file has one row group, every column may be null, and it contains nothing of host or clock:
//! the same table gives the same bytes.

mod cursor;
mod layout;
mod read;
pub(crate) mod spill;
mod values;
mod write;

pub(crate) use cursor::ColumnCursor;
pub use layout::{SCHEMA, SCHEMA_WITH_UNITS, TableError};
pub use read::ExistingTable;
pub use values::{ColumnKind, ColumnValue, ColumnValues};
pub(crate) use write::write_streamed;
pub use write::{write, write_with_units};

#[cfg(test)]
mod tests {
    use super::layout::ROWS_AT_A_TIME;
    use super::*;
    use proptest::prelude::*;
    use std::borrow::Cow;
    use std::path::Path;
    use std::sync::Arc;

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
