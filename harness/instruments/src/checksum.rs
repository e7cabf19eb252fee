//! Checksums of the protocols.

use crc::{Algorithm, CRC_16_KERMIT, CRC_16_XMODEM, Crc, Table};

/// CRC-32 of NovAtel: the polynomial of Ethernet, reflected, with the initial value zero and no final
/// XOR. `check` is the CRC of "123456789", `residue` that of a frame with its CRC.
const NOVATEL: Algorithm<u32> = Algorithm {
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
pub(crate) fn vectornav(bytes: &[u8]) -> u16 {
    CCITT.checksum(bytes)
}

/// CRC-16 of SBG: polynomial 0x8408 reflected, initial value zero.
#[inline]
pub(crate) fn sbg(bytes: &[u8]) -> u16 {
    KERMIT.checksum(bytes)
}

/// CRC-32 of NovAtel.
#[inline]
pub(crate) fn novatel(bytes: &[u8]) -> u32 {
    CRC32.checksum(bytes)
}

/// Sum of bytes.
#[inline]
pub(crate) fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_values() {
        assert_eq!(vectornav(b"123456789"), CRC_16_XMODEM.check);
        assert_eq!(sbg(b"123456789"), CRC_16_KERMIT.check);
        // Bit by bit, as in the receiver's manual.
        let slow = b"123456789".iter().fold(0u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 }
            })
        });
        assert_eq!((novatel(b"123456789"), NOVATEL.check), (slow, slow));
        assert_eq!(sum(&[0xFF, 0x36, 0xCB]), 0);
    }
}
