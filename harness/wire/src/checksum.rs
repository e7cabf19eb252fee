//! CRC-32 as zlib, Ethernet and PNG have it: polynomial 0x04C11DB7 reflected, begun and ended with
//! all ones.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// Sixteen tables: 16 KiB that read sixteen bytes at a time.
const CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// CRC-32 of bytes.
#[inline]
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// CRC-32 of a byte and what follows it.
#[inline]
pub(crate) fn crc32_after(first: u8, bytes: &[u8]) -> u32 {
    let mut digest = CRC.digest();
    digest.update(&[first]);
    digest.update(bytes);
    digest.finalize()
}
