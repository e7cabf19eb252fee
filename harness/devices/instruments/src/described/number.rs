//! Numbers in a described frame.

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ByteOrder {
    /// Least significant byte first.
    #[default]
    Little,
    /// Most significant byte first.
    Big,
}

/// Type of a number in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberType {
    /// Integer of this many bytes, 1 to 8.
    Unsigned(u8),
    /// Integer in two's complement of this many bytes, 1 to 8.
    Signed(u8),
    /// IEEE 754, 32 bits.
    Float32,
    /// IEEE 754, 64 bits.
    Float64,
}

impl NumberType {
    /// Number of bytes in the frame.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::Unsigned(bytes) | Self::Signed(bytes) => bytes as usize,
            Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }

    /// Number of bits.
    #[must_use]
    pub const fn bits(self) -> u32 {
        8 * self.bytes() as u32
    }

    /// True for an integer.
    #[must_use]
    pub const fn is_integer(self) -> bool {
        matches!(self, Self::Unsigned(_) | Self::Signed(_))
    }
}

/// A number at a place in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameNumber {
    /// Offset of its first byte from the start of the frame.
    pub at: usize,
    /// Type.
    pub number: NumberType,
    /// Order of its bytes.
    pub order: ByteOrder,
    /// Lowest bit of an integer that is used; it is moved to bit 0.
    pub shift: u32,
    /// Number of bits of an integer that are used; the highest one is the sign of a signed type.
    pub bits: u32,
}

impl FrameNumber {
    /// All bits of a number.
    #[must_use]
    pub const fn whole(at: usize, number: NumberType, order: ByteOrder) -> Self {
        Self { at, number, order, shift: 0, bits: number.bits() }
    }

    /// Bits of the number, without its sign. Beyond the frame's end, which a checked description excludes, zero.
    #[inline]
    #[must_use]
    pub fn raw(&self, frame: &[u8]) -> u64 {
        let bytes = frame.get(self.at..self.at + self.number.bytes()).unwrap_or_default();
        let take = |word: u64, byte: &u8| (word << 8) | u64::from(*byte);
        let word = match self.order {
            ByteOrder::Big => bytes.iter().fold(0, take),
            ByteOrder::Little => bytes.iter().rev().fold(0, take),
        };
        let unused = 64u32.saturating_sub(self.bits).min(63);
        word.checked_shr(self.shift).unwrap_or(0) & (u64::MAX >> unused)
    }

    /// Value of the number.
    #[inline]
    #[must_use]
    pub fn value(&self, frame: &[u8]) -> f64 {
        let raw = self.raw(frame);
        match self.number {
            NumberType::Float32 => f64::from(f32::from_bits(raw as u32)),
            NumberType::Float64 => f64::from_bits(raw),
            NumberType::Unsigned(_) => raw as f64,
            NumberType::Signed(_) => {
                let above = 64u32.saturating_sub(self.bits).min(63);
                ((raw << above) as i64 >> above) as f64
            }
        }
    }
}
