//! Short texts of fixed capacity.

use core::fmt;

/// A text of at most `N` bytes of UTF-8 without a NUL; on the wire it is padded with zeros.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Text<const N: usize> {
    bytes: [u8; N],
    length: usize,
}

/// Reason why bytes or characters are no [`Text`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextError {
    /// The text is too long.
    #[error("the text has {found} bytes, {room} fit")]
    Long {
        /// Bytes of the text.
        found: usize,
        /// Capacity, bytes.
        room: usize,
    },
    /// The text has a zero byte inside.
    #[error("the text has a NUL at byte {at} and goes on after it")]
    Nul {
        /// Index of the first zero.
        at: usize,
    },
    /// The text isn't UTF-8.
    #[error("the text isn't UTF-8 from byte {at} on")]
    Encoding {
        /// Length of the valid part, bytes.
        at: usize,
    },
}

impl<const N: usize> Text<N> {
    /// Makes a text.
    ///
    /// # Errors
    /// If it is longer than `N` bytes or contains a NUL.
    pub fn new(text: &str) -> Result<Self, TextError> {
        if text.len() > N {
            return Err(TextError::Long { found: text.len(), room: N });
        }
        if let Some(at) = text.bytes().position(|byte| byte == 0) {
            return Err(TextError::Nul { at });
        }
        Ok(Self::fitting(text))
    }

    /// Makes a text of as many whole characters as fit, up to a NUL.
    #[must_use]
    pub fn fitting(text: &str) -> Self {
        let mut bytes = [0; N];
        let mut length = 0;
        for character in text.chars() {
            let end = length + character.len_utf8();
            if end > N || character == '\0' {
                break;
            }
            character.encode_utf8(&mut bytes[length..end]);
            length = end;
        }
        Self { bytes, length }
    }

    /// Content of the text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        // All constructors store whole characters only.
        core::str::from_utf8(&self.bytes[..self.length]).unwrap_or("")
    }

    /// All `N` bytes, as on the wire.
    #[must_use]
    pub fn bytes(&self) -> &[u8; N] {
        &self.bytes
    }

    /// Reads the text from its `N` bytes.
    ///
    /// # Errors
    /// If the bytes aren't UTF-8 padded with zeros.
    pub fn from_bytes(bytes: [u8; N]) -> Result<Self, TextError> {
        let length = bytes.iter().position(|byte| *byte == 0).unwrap_or(N);
        if bytes[length..].iter().any(|byte| *byte != 0) {
            return Err(TextError::Nul { at: length });
        }
        match core::str::from_utf8(&bytes[..length]) {
            Ok(_) => Ok(Self { bytes, length }),
            Err(error) => Err(TextError::Encoding { at: error.valid_up_to() }),
        }
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self { bytes: [0; N], length: 0 }
    }
}

impl<const N: usize> fmt::Display for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl<const N: usize> fmt::Debug for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}
