//! Checksums of the protocols.

use crc::{Algorithm, CRC_16_KERMIT, CRC_16_XMODEM, Crc, Table};

/// CRC-32 of NovAtel: the polynomial of Ethernet, reflected, with the initial value zero and no final
/// XOR. `check` is the CRC of "123456789", `residue` that of a frame with its CRC.
pub const NOVATEL: Algorithm<u32> = Algorithm {
    width: 32,
    poly: 0x04C1_1DB7,
    init: 0,
    refin: true,
    refout: true,
    xorout: 0,
    check: 0x2DFD_2D88,
    residue: 0,
};

/// Each has sixteen tables, for sixteen bytes at a time.
const CCITT: Crc<u16, Table<16>> = Crc::<u16, Table<16>>::new(&CRC_16_XMODEM);
const KERMIT: Crc<u16, Table<16>> = Crc::<u16, Table<16>>::new(&CRC_16_KERMIT);
const CRC32: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&NOVATEL);

/// CRC-16 of VectorNav: polynomial 0x1021, initial value zero.
#[inline]
#[must_use]
pub fn vectornav(bytes: &[u8]) -> u16 {
    CCITT.checksum(bytes)
}

/// CRC-16 of SBG: polynomial 0x8408 reflected, initial value zero.
#[inline]
#[must_use]
pub fn sbg(bytes: &[u8]) -> u16 {
    KERMIT.checksum(bytes)
}

/// CRC-32 of NovAtel.
#[inline]
#[must_use]
pub fn novatel(bytes: &[u8]) -> u32 {
    CRC32.checksum(bytes)
}

/// Sum of bytes.
#[inline]
#[must_use]
pub fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}
