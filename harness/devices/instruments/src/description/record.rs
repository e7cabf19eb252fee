//! Records of one length.

use super::checksum::checksum;
use super::fields::{ORDERS, Places, ReadField, fields};
use super::ranges::{Ranges, is_whole};
use super::table::{DescriptionProblem, Table};
use crate::described::{FRAME_BYTES_MAX, FixedRecords, FrameField};
use std::string::ToString as _;
use std::vec::Vec;

/// Most bytes at the start of a file that are no records.
const SKIP_MAX: i64 = 1 << 30;

/// Reads `[record]`.
pub(super) fn record(root: &Table<'_>) -> Result<FixedRecords, DescriptionProblem> {
    let order = root.choice("byte_order", &ORDERS)?.unwrap_or_default();
    let table = root.table("record")?.ok_or_else(|| root.problem("record", "missing"))?;
    table.only(&["length", "skip", "checksum", "field"])?;
    let bytes = table.integer("length", 1..=FRAME_BYTES_MAX as i64)?;
    let bytes = bytes.ok_or_else(|| {
        table.problem("length", "missing, expected the number of a record's bytes")
    })?;
    let bytes = usize::try_from(bytes).unwrap_or(FRAME_BYTES_MAX);
    let skip = table.integer("skip", 0..=SKIP_MAX)?.unwrap_or(0).unsigned_abs();
    let own = table.table("checksum")?;
    let check = match own.or(root.table("checksum")?) {
        Some(table) => checksum(&table, bytes, order)?,
        None => None,
    };
    let read = fields(&table, Places::Bytes { bytes, order, float_stamps: true })?;
    let mut ranges = Ranges::default();
    for field in &read {
        ranges.take(&table, field)?;
    }
    if !is_whole(read.iter().map(|field| &field.meaning)) {
        let what = "found no gyros and accelerometers, expected both: a reading has both";
        return Err(table.problem("field", what));
    }
    let fields: Vec<FrameField> = read.iter().filter_map(ReadField::of_frame).collect();
    FixedRecords::new(skip, bytes, check, &fields, ranges.counter(), ranges.stamp())
        .map_err(|error| table.problem_of_all(error.to_string()))
}
