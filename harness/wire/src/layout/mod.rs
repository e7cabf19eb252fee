//! The fields of every payload: the table that the CAN database and the tables of `README.md` are
//! made from, and that the tests hold the code against.

mod tables;

use crate::Kind;

/// How a field is written; all little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// Unsigned, 1 byte.
    U8,
    /// Unsigned, 2 bytes.
    U16,
    /// Unsigned, 4 bytes.
    U32,
    /// Unsigned, 8 bytes.
    U64,
    /// Two's complement, 4 bytes.
    I32,
    /// IEEE 754 binary64, 8 bytes.
    F64,
    /// Step in bits 0 to 14 of 2 bytes; bit 15 is the flag of this name, or zero.
    Step(Option<&'static str>),
    /// So many bytes.
    Bytes(usize),
    /// UTF-8, filled up with zeros to so many bytes.
    Text(usize),
    /// So many bytes that are sent as zero and not looked at.
    Zero(usize),
}

impl Type {
    /// Bytes of the field.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::Step(_) => 2,
            Self::U32 | Self::I32 => 4,
            Self::U64 | Self::F64 => 8,
            Self::Bytes(bytes) | Self::Text(bytes) | Self::Zero(bytes) => bytes,
        }
    }

    /// The name used in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::U16 => "u16",
            Self::U32 => "u32",
            Self::U64 => "u64",
            Self::I32 => "i32",
            Self::F64 => "f64",
            Self::Step(None) => "step",
            Self::Step(Some(_)) => "step, flag",
            Self::Bytes(_) => "bytes",
            Self::Text(_) => "text",
            Self::Zero(_) => "zero",
        }
    }
}

/// One field of a payload.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Index of its first byte in the payload.
    pub at: usize,
    /// How it is written.
    pub ty: Type,
    /// Its name; empty for zeros.
    pub name: &'static str,
    /// What one count of it is, in `unit`; 1 where it is no count.
    pub lsb: f64,
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// What its values mean, from 0 on; empty where they are numbers.
    pub values: &'static [&'static str],
    /// What it is.
    pub about: &'static str,
}

/// The fields of a payload, in order and without gaps.
#[must_use]
pub fn fields(kind: Kind) -> &'static [Field] {
    tables::fields(kind)
}

/// SI unit of a parameter by its index.
#[must_use]
pub const fn parameter_unit(index: usize) -> &'static str {
    tables::parameter_unit(index)
}

/// Where the byte of a payload is in the CAN image: behind the CRC that follows the first four.
#[must_use]
pub const fn image_at(payload_at: usize) -> usize {
    if payload_at < 4 { payload_at } else { payload_at + 4 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_fill_every_payload_without_gaps() {
        for kind in Kind::ALL {
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
        for kind in Kind::ALL {
            assert_eq!((kind.payload_bytes() + 4) % 8, 0, "{}", kind.name());
            for field in fields(kind) {
                if !matches!(field.ty, Type::Bytes(_) | Type::Text(_) | Type::Zero(_)) {
                    let at = image_at(field.at);
                    let last = at + field.ty.bytes() - 1;
                    assert_eq!(at / 8, last / 8, "{}.{}", kind.name(), field.name);
                }
            }
        }
    }
}
