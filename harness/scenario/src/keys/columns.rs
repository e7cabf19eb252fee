//! Columns of text files, and the unit of their times.

use super::definition::Kind;
use super::table::{Of, Value, choice};
use crate::error::Problem;
use crate::read::reader::Reader;
use crate::recorded::{RecordedColumn, TimeUnit};

impl Value for RecordedColumn {
    fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem> {
        Ok(match String::read(table, key)? {
            Some(name) => Some(Self::Name(name)),
            None => usize::read(table, key)?.map(Self::Number),
        })
    }
}

pub(super) const fn column() -> Of<RecordedColumn> {
    Of::kind(Kind::Column)
}

pub(super) const fn time_unit() -> Of<TimeUnit> {
    choice! {
        "s" => TimeUnit::Second, "seconds";
        "ms" => TimeUnit::Millisecond, "milliseconds";
        "us" => TimeUnit::Microsecond, "microseconds";
        "ns" => TimeUnit::Nanosecond, "nanoseconds";
    }
}
