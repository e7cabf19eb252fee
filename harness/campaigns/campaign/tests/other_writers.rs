//! Tables of a campaign that pyarrow wrote anew, by fixtures/golden/tables.py.

use octant_campaign::table::{ColumnValues, ExistingTable};
use std::path::Path;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden");

#[test]
fn a_table_with_snappy_is_read() {
    let table = ExistingTable::open(&Path::new(FOLDER).join("tables-snappy.parquet")).unwrap();
    assert_eq!((table.rows, table.plan.as_str()), (200, "0123456789abcdef"));
    let column = |name: &str| table.column(name).unwrap().unwrap();
    let rows = 0..200_i64;
    assert_eq!(column("case"), ColumnValues::Integer(rows.clone().map(Some).collect()));
    let nis = rows.clone().map(|row| (row % 5 != 0).then_some(3.0 + 0.01 * (row % 7) as f64));
    assert_eq!(column("nis"), ColumnValues::Number(nis.collect()));
    let passed = rows.clone().map(|row| Some(row % 3 != 0));
    assert_eq!(column("passed"), ColumnValues::Boolean(passed.collect()));
    let verdict = rows.map(|row| Some(if row % 3 == 0 { "fail" } else { "pass" }.into()));
    assert_eq!(column("verdict"), ColumnValues::Text(verdict.collect()));
}

#[test]
fn another_compression_is_told_with_what_to_write() {
    let path = Path::new(FOLDER).join("tables-gzip.parquet");
    let said = ExistingTable::open(&path).unwrap_err().to_string();
    let expected = "tables-gzip.parquet: column case is compressed with gzip, expected zstd, snappy or none: write the \
                    table with compression=\"zstd\"";
    assert!(said.contains(expected), "{said}");
}
