//! Checksum of a described frame.

use super::number::{ByteOrder, FrameNumber};

/// Parameters of a CRC, in the terms of R. Williams, *A painless guide to CRC error detection algorithms* (1993),
/// chapter 15.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CrcParameters {
    /// Number of bits: 8, 16 or 32.
    pub width: u32,
    /// Polynomial without its highest bit, not reflected.
    pub poly: u32,
    /// Initial value of the register.
    pub init: u32,
    /// True if the bits of each byte come in lowest first.
    pub refin: bool,
    /// True if the bits of the register are reversed at the end.
    pub refout: bool,
    /// Value that is combined with the register by exclusive or at the end.
    pub xorout: u32,
}

/// A CRC whose parameters are known at run time alone: `crc::Crc` needs them when the program is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DescribedCrc {
    parameters: CrcParameters,
    /// Remainders of the values of four bits, in the highest bits.
    table: [u32; 16],
}

impl DescribedCrc {
    /// Makes a CRC. A width other than 8, 16 and 32 is taken as 32.
    #[must_use]
    pub fn new(parameters: CrcParameters) -> Self {
        let width = match parameters.width {
            8 | 16 => parameters.width,
            _ => 32,
        };
        let parameters = CrcParameters { width, ..parameters };
        let poly = parameters.poly << (32 - width);
        let table = core::array::from_fn(|value| {
            (0..4).fold((value as u32) << 28, |rest, _| {
                if rest >> 31 == 1 { (rest << 1) ^ poly } else { rest << 1 }
            })
        });
        Self { parameters, table }
    }

    /// Computes the CRC of bytes.
    #[inline]
    #[must_use]
    pub fn of(&self, bytes: impl Iterator<Item = u8>) -> u32 {
        let CrcParameters { width, init, refin, refout, xorout, .. } = self.parameters;
        let unused = 32 - width;
        let step = |register: u32| (register << 4) ^ self.table[(register >> 28) as usize];
        let register = bytes.fold(init << unused, |register, byte| {
            let byte = if refin { byte.reverse_bits() } else { byte };
            step(step(register ^ (u32::from(byte) << 24)))
        });
        let register =
            if refout { register.reverse_bits() << unused >> unused } else { register >> unused };
        let used = u32::MAX >> unused;
        (register ^ xorout) & used
    }
}

/// Kind of a checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChecksumKind {
    /// Sum of the bytes, 8 bits.
    Sum8,
    /// Sum of the bytes, 16 bits.
    Sum16,
    /// Sum of words of two bytes, in the order of the checksum's bytes, 16 bits. A last single byte counts as the
    /// word's first one.
    Words16,
    /// Exclusive or of the bytes.
    Xor8,
    /// Cyclic redundancy check.
    Crc(DescribedCrc),
}

impl ChecksumKind {
    /// Number of bytes in the frame.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        match self {
            Self::Sum8 | Self::Xor8 => 1,
            Self::Sum16 | Self::Words16 => 2,
            Self::Crc(crc) => (crc.parameters.width / 8) as usize,
        }
    }
}

/// A checksum with its place in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameChecksum {
    /// Kind.
    pub kind: ChecksumKind,
    /// First byte that it covers.
    pub from: usize,
    /// Byte after the last one that it covers.
    pub to: usize,
    /// Zero bytes are counted behind those bytes, which are not in the frame, up to a multiple of this number; 1: none.
    pub pad_to: usize,
    /// The number in the frame.
    pub number: FrameNumber,
}

impl FrameChecksum {
    /// Checksum in a frame, and that of its bytes.
    #[inline]
    #[must_use]
    pub fn found_and_computed(&self, frame: &[u8]) -> (u32, u32) {
        let covered = frame.get(self.from..self.to).unwrap_or_default();
        let beyond = covered.len() % self.pad_to.max(1);
        let zeros = if beyond == 0 { 0 } else { self.pad_to - beyond };
        let bytes = covered.iter().copied().chain(core::iter::repeat_n(0, zeros));
        let computed = match &self.kind {
            ChecksumKind::Sum8 => bytes.fold(0u8, u8::wrapping_add).into(),
            ChecksumKind::Sum16 => {
                bytes.fold(0u16, |sum, byte| sum.wrapping_add(byte.into())).into()
            }
            ChecksumKind::Words16 => {
                let words = bytes.enumerate().map(|(index, byte)| {
                    let is_first = index % 2 == 0;
                    let is_high = is_first == (self.number.order == ByteOrder::Big);
                    u16::from(byte) << if is_high { 8 } else { 0 }
                });
                words.fold(0u16, u16::wrapping_add).into()
            }
            ChecksumKind::Xor8 => bytes.fold(0u8, |all, byte| all ^ byte).into(),
            ChecksumKind::Crc(crc) => crc.of(bytes),
        };
        (self.number.raw(frame) as u32, computed)
    }
}
