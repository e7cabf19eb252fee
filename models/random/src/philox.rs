//! Philox4x64-10: the counter-based generator of Salmon, Moraes, Dror and Shaw, "Parallel random
//! numbers: as easy as 1, 2, 3" (SC 2011).
//!
//! Any block follows from its key and counter alone, so that the noise of a sample needs no history
//! and costs one call. (The `rand` family's implementations keep a buffer and a position, which
//! random access per sample would discard each time.)

const MULTIPLIER: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
const WEYL: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];

/// Key of a stream.
pub type StreamKey = [u64; 2];

#[inline(always)]
fn multiply(a: u64, b: u64) -> (u64, u64) {
    let product = u128::from(a) * u128::from(b);
    ((product >> 64) as u64, product as u64)
}

/// Keys of the ten rounds, which follow from a stream's key.
pub type RoundKeys = [StreamKey; 10];

/// The keys of the rounds: made once for many blocks, they are a fifth of a block's work.
#[must_use]
#[inline(always)]
pub fn round_keys(key: StreamKey) -> RoundKeys {
    let mut keys = [key; 10];
    for round in 1..10 {
        let before = keys[round - 1];
        keys[round] = [before[0].wrapping_add(WEYL[0]), before[1].wrapping_add(WEYL[1])];
    }
    keys
}

/// The 256 random bits of one key, given by those of its rounds, and counter.
#[must_use]
#[inline(always)]
pub fn block_of(keys: &RoundKeys, counter: [u64; 4]) -> [u64; 4] {
    let mut c = counter;
    for k in keys {
        let (high0, low0) = multiply(MULTIPLIER[0], c[0]);
        let (high1, low1) = multiply(MULTIPLIER[1], c[2]);
        c = [high1 ^ c[1] ^ k[0], low1, high0 ^ c[3] ^ k[1], low0];
    }
    c
}

/// The 256 random bits of one key and counter.
#[must_use]
#[inline(always)]
pub fn block(key: StreamKey, counter: [u64; 4]) -> [u64; 4] {
    block_of(&round_keys(key), counter)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known-answer test of the Random123 distribution (kat_vectors, philox4x64 10).
    #[test]
    fn known_answers_of_random123() {
        assert_eq!(
            block([0; 2], [0; 4]),
            [0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b]
        );
        assert_eq!(
            block([u64::MAX; 2], [u64::MAX; 4]),
            [0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0]
        );
        assert_eq!(
            block(
                [0x452821e638d01377, 0xbe5466cf34e90c6c],
                [0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89]
            ),
            [0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6]
        );
    }
}
