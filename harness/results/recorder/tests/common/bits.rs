//! Numbers of every kind.

use proptest::prelude::*;

/// Any f64 by its bits: NaN payloads, infinities, subnormals, signed zeros.
pub(crate) fn bits() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        Just(f64::from_bits(0x7FF0_0000_0000_0001)),
        Just(f64::from_bits(0xFFF8_DEAD_BEEF_0001)),
        Just(-0.0),
    ]
}
