//! Text in memory of the caller.

use core::fmt::Write;

/// Writes into a buffer, cuts off what doesn't fit, and ends with zero.
pub(crate) struct Buffer<'a> {
    bytes: &'a mut [u8],
    length: usize,
}

impl<'a> Buffer<'a> {
    /// An empty text; the buffer has at least one byte.
    pub(crate) fn new(bytes: &'a mut [u8]) -> Self {
        bytes[0] = 0;
        Self { bytes, length: 0 }
    }
}

impl Write for Buffer<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        let room = self.bytes.len() - 1 - self.length;
        let mut end = text.len().min(room);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        self.bytes[self.length..self.length + end].copy_from_slice(&text.as_bytes()[..end]);
        self.length += end;
        self.bytes[self.length] = 0;
        if end == text.len() { Ok(()) } else { Err(core::fmt::Error) }
    }
}
