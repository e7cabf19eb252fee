//! Numbers in frames.

/// Reads numbers in sequence. Beyond the end, which a checked length excludes, it reads zeros.
#[derive(Clone, Copy)]
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
}

macro_rules! numbers {
    ($($little:ident $big:ident $number:ty),*) => {$(
        #[inline]
        #[allow(dead_code, reason = "not every number occurs in both orders")]
        pub(crate) fn $little(&mut self) -> $number {
            <$number>::from_le_bytes(self.take())
        }

        #[inline]
        #[allow(dead_code, reason = "not every number occurs in both orders")]
        pub(crate) fn $big(&mut self) -> $number {
            <$number>::from_be_bytes(self.take())
        }
    )*};
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    #[inline]
    pub(crate) fn take<const N: usize>(&mut self) -> [u8; N] {
        match self.rest.split_first_chunk::<N>() {
            Some((head, tail)) => {
                self.rest = tail;
                *head
            }
            None => [0; N],
        }
    }

    #[inline]
    pub(crate) fn skip(&mut self, bytes: usize) {
        self.rest = self.rest.get(bytes..).unwrap_or_default();
    }

    numbers!(
        u8_le u8_be u8, u16_le u16_be u16, i16_le i16_be i16, u32_le u32_be u32,
        i32_le i32_be i32, u64_le u64_be u64, f32_le f32_be f32, f64_le f64_be f64
    );

    /// Reads three values in sequence.
    #[inline]
    pub(crate) fn three<T>(&mut self, read: impl Fn(&mut Self) -> T) -> [T; 3] {
        core::array::from_fn(|_| read(self))
    }
}

/// A frame that is written byte by byte. Bytes beyond its capacity are dropped: each encoder has room
/// for its longest frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<const N: usize> {
    bytes: [u8; N],
    length: usize,
}

impl<const N: usize> Frame<N> {
    pub(crate) const fn new() -> Self {
        Self { bytes: [0; N], length: 0 }
    }

    pub(crate) fn clear(&mut self) {
        self.length = 0;
    }

    pub(crate) fn put(&mut self, bytes: &[u8]) {
        if let Some(room) = self.bytes.get_mut(self.length..self.length + bytes.len()) {
            room.copy_from_slice(bytes);
            self.length += bytes.len();
        }
    }

    /// Overwrites a byte.
    pub(crate) fn set(&mut self, at: usize, byte: u8) {
        if let Some(room) = self.bytes[..self.length].get_mut(at) {
            *room = byte;
        }
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

impl<const N: usize> core::fmt::Write for Frame<N> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        let before = self.length;
        self.put(text.as_bytes());
        if self.length == before + text.len() { Ok(()) } else { Err(core::fmt::Error) }
    }
}
