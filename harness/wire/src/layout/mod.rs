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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_fill_every_payload_without_gaps() {
        for kind in MessageKind::ALL {
            let mut at = 0;
            for field in fields(kind) {
                assert_eq!(field.at, at, "{}.{}", kind.name(), field.name);
                at += field.ty.bytes();
            }
            assert_eq!(at, kind.payload_bytes(), "{}", kind.name());
        }
    }

    #[test]
    fn no_number_crosses_a_word_of_the_can_image() {
        for kind in MessageKind::ALL {
            assert_eq!((kind.payload_bytes() + 4) % 8, 0, "{}", kind.name());
            for field in fields(kind) {
                if !matches!(
                    field.ty,
                    FieldType::Bytes(_) | FieldType::Text(_) | FieldType::Zero(_)
                ) {
                    let at = image_at(field.at);
                    let last = at + field.ty.bytes() - 1;
                    assert_eq!(at / 8, last / 8, "{}.{}", kind.name(), field.name);
                }
            }
        }
    }
}
