//! Check values of the checksums.

use crc::{CRC_16_KERMIT, CRC_16_XMODEM};
use octant_instruments::checksum::{NOVATEL, novatel, sbg, sum, vectornav};

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
