//! Parts that the tests share, with those of other crates that read recordings.

pub(crate) mod bits;
pub(crate) mod epochs;
pub(crate) mod stream;
