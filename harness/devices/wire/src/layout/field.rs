//! A field of a payload, and its encoding.

/// Encoding of a field; all are little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldType {
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
    /// Bytes, by their number.
    Bytes(usize),
    /// UTF-8, padded with zeros to this number of bytes.
    Text(usize),
    /// Bytes sent as zero and ignored, by their number.
    Zero(usize),
}

impl FieldType {
    /// Size of the field, bytes.
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

    /// Name used in tables.
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
    /// Index of the field's first byte in the payload.
    pub at: usize,
    /// Encoding.
    pub ty: FieldType,
    /// Name; empty for zeros.
    pub name: &'static str,
    /// Size of one count, in `unit`; 1 if the field is no count.
    pub lsb: f64,
    /// Unit; empty if there is none.
    pub unit: &'static str,
    /// Names of the values, from 0 on; empty if they are numbers.
    pub values: &'static [&'static str],
    /// Meaning.
    pub about: &'static str,
}
