//! Fields of messages as plain CDR, little-endian: encoder and decoder.

/// Encapsulation of little-endian plain CDR.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Appends fields to a message.
pub(super) struct Encoder<'a>(&'a mut Vec<u8>);

impl<'a> Encoder<'a> {
    pub(super) fn new(bytes: &'a mut Vec<u8>) -> Self {
        bytes.clear();
        bytes.extend_from_slice(&ENCAPSULATION);
        Self(bytes)
    }

    #[inline]
    pub(super) fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        self.0.extend_from_slice(&bytes);
    }

    #[inline]
    pub(super) fn f64s(&mut self, values: &[f64]) {
        for value in values {
            self.put(value.to_bits().to_le_bytes());
        }
    }
}

/// Takes fields from a message.
pub(super) struct Decoder<'a>(&'a [u8]);

/// Error of a message whose bytes don't fit its topic.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MessageError {
    /// The message has another length than its layout.
    #[error("message of {found} bytes, expected {expected}")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes of the layout.
        expected: usize,
    },
    /// The message is not little-endian plain CDR.
    #[error("message begins with {found:02x?}, expected little-endian CDR (00, 01)")]
    Encapsulation {
        /// The first two bytes.
        found: [u8; 2],
    },
    /// A field has an invalid value.
    #[error("field {field} is {found}, expected {expected}")]
    Value {
        /// The field.
        field: &'static str,
        /// The value found.
        found: u64,
        /// Valid values.
        expected: &'static str,
    },
    /// JSON that can't be read.
    #[error("event is not the expected JSON: {reason}")]
    Json {
        /// Error of the parser.
        reason: String,
    },
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8], expected: usize) -> Result<Self, MessageError> {
        if bytes.len() != expected {
            return Err(MessageError::Length { found: bytes.len(), expected });
        }
        match bytes.split_first_chunk::<4>() {
            Some(([0, 1, _, _], rest)) => Ok(Self(rest)),
            _ => {
                let first = |i: usize| bytes.get(i).copied().unwrap_or(0);
                Err(MessageError::Encapsulation { found: [first(0), first(1)] })
            }
        }
    }

    /// Takes the next `N` bytes. The total length was checked; beyond the end it reads zeros.
    #[inline]
    pub(super) fn take<const N: usize>(&mut self) -> [u8; N] {
        match self.0.split_first_chunk::<N>() {
            Some((head, rest)) => {
                self.0 = rest;
                *head
            }
            None => {
                debug_assert!(false, "layout and length disagree");
                [0; N]
            }
        }
    }

    pub(super) fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }
    pub(super) fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }
    pub(super) fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }
    pub(super) fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }
    pub(super) fn f64(&mut self) -> f64 {
        f64::from_bits(self.u64())
    }
    pub(super) fn f64s<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.f64())
    }
}
