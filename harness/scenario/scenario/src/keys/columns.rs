//! Columns of text files, and the units of their times and temperatures.

use super::definition::Kind;
use super::table::{Of, Value, choice};
use crate::error::Problem;
use crate::read::reader::Reader;
use crate::recorded::{RecordedColumn, TemperatureUnit, TimeUnit};

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

pub(super) const fn temperature_unit() -> Of<TemperatureUnit> {
    choice! {
        "degC" => TemperatureUnit::Celsius, "degrees Celsius";
        "K" => TemperatureUnit::Kelvin, "kelvin";
    }
}
