//! CRC-32 of zlib, Ethernet and PNG: polynomial 0x04C11DB7 reflected, initial value and final XOR all
//! ones.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// Sixteen tables of 16 KiB in total, for sixteen bytes at a time.
const CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// CRC-32 of bytes.
#[inline]
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// CRC-32 of a byte and the bytes after it.
#[inline]
pub(crate) fn crc32_after(first: u8, bytes: &[u8]) -> u32 {
    let mut digest = CRC.digest();
    digest.update(&[first]);
    digest.update(bytes);
    digest.finalize()
}
