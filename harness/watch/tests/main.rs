//! Tests of watched runs, in one program.
#![allow(clippy::unwrap_used)]

#[cfg(feature = "dashboard")]
mod fit;
mod place;
