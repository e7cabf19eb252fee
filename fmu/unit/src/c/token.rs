//! Token of a model, which links a description to the library.

use super::mode::ServedStandard;
use crate::table::Model;
use core::fmt::Write as _;

/// Makes the token of a model in a standard: `guid` in FMI 2.0, `instantiationToken` in FMI 3.0. It
/// follows from the text of the model's table, so that a library refuses descriptions of other
/// variables.
#[must_use]
pub fn token(model: &Model, standard: ServedStandard) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let mut text = String::new();
    // Writing to a String can't fail. Debug prints every field, and floats with all their digits.
    let _ = write!(text, "octant {version} {standard:?} {model:?}");
    let hash = fnv_1a(text.as_bytes());
    format!(
        "{{{:08x}-{:04x}-{:04x}-{:04x}-{:012x}}}",
        (hash >> 96) as u32,
        (hash >> 80) as u16,
        (hash >> 64) as u16,
        (hash >> 48) as u16,
        hash & 0xFFFF_FFFF_FFFF
    )
}

/// FNV-1a of 128 bits: a fingerprint against mistakes, not against forgery.
#[must_use]
pub fn fnv_1a(bytes: &[u8]) -> u128 {
    const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    bytes.iter().fold(OFFSET, |hash, byte| (hash ^ u128::from(*byte)).wrapping_mul(PRIME))
}
