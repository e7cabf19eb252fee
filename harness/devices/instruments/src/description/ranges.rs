//! Ranges of fields, the same in all frames.

use super::fields::ReadField;
use super::table::{DescriptionProblem, Table};
use crate::described::FieldMeaning;
use crate::rollover::Rollover;
use std::borrow::ToOwned;
use std::format;
use std::string::ToString as _;

/// True if the fields are gyros and accelerometers.
pub(super) fn is_whole<'a>(mut meanings: impl Iterator<Item = &'a FieldMeaning> + Clone) -> bool {
    let has_gyros =
        meanings.clone().any(|meaning| matches!(meaning, FieldMeaning::Rotation { .. }));
    has_gyros && meanings.any(|meaning| matches!(meaning, FieldMeaning::Velocity { .. }))
}

/// Ranges of counter and clock, which are the same in all frames.
#[derive(Default)]
pub(super) struct Ranges {
    counter: Option<Option<u64>>,
    stamp: Option<Option<u64>>,
    /// Whether the stamp is an integer.
    integer_stamp: Option<bool>,
}

impl Ranges {
    pub(super) fn counter(&self) -> Rollover {
        rollover(self.counter)
    }

    pub(super) fn stamp(&self) -> Rollover {
        rollover(self.stamp)
    }

    /// Notes the range of a field, which is that of the same field of every frame before it.
    pub(super) fn take(
        &mut self,
        table: &Table<'_>,
        read: &ReadField,
    ) -> Result<(), DescriptionProblem> {
        if let FieldMeaning::Stamp(_) = read.meaning {
            let is_integer = read.is_integer();
            if self.integer_stamp.is_some_and(|known| known != is_integer) {
                let message = "found stamps of integers and of floating-point numbers, expected one of both in all frames";
                return Err(table.problem("field", message));
            }
            self.integer_stamp = Some(is_integer);
        }
        let (known, what) = match read.meaning {
            FieldMeaning::Counter => (&mut self.counter, "counter"),
            FieldMeaning::Stamp(_) => (&mut self.stamp, "stamp"),
            _ => return Ok(()),
        };
        if known.is_some_and(|known| known != read.modulo) {
            let range = |modulo: Option<u64>| modulo.map_or("2^64".to_owned(), |m| m.to_string());
            let message = format!(
                "the {what} has {} values, expected {} as in the frames before it",
                range(read.modulo),
                range(known.flatten())
            );
            return Err(table.problem("field", message));
        }
        *known = Some(read.modulo);
        Ok(())
    }
}

fn rollover(range: Option<Option<u64>>) -> Rollover {
    match range {
        Some(Some(modulo)) => Rollover::modulo(modulo),
        Some(None) | None => Rollover::new(64),
    }
}
