//! Parts of the recorder's tests.

#[path = "../../recorder/tests/common/bits.rs"]
pub(crate) mod bits;
#[path = "../../recorder/tests/common/epochs.rs"]
pub(crate) mod epochs;
