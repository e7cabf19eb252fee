//! The fields of every payload. The CAN database and the tables of `README.md` are made from this
//! table, and tests compare the code with it.

mod field;
mod tables;

pub use field::{Field, FieldType};

use crate::MessageKind;

/// Fields of a payload, in order and without gaps.
#[must_use]
pub fn fields(kind: MessageKind) -> &'static [Field] {
    tables::fields(kind)
}

/// SI unit of a parameter by its index.
#[must_use]
pub const fn parameter_unit(index: usize) -> &'static str {
    tables::parameter_unit(index)
}

/// Index in the CAN image of a byte of the payload: shifted by the CRC after the first four bytes.
#[must_use]
pub const fn image_at(payload_at: usize) -> usize {
    if payload_at < 4 { payload_at } else { payload_at + 4 }
}
