//! Tests of watched runs, in one program.
#![allow(clippy::unwrap_used)]

#[cfg(feature = "dashboard")]
mod fit;
#[cfg(feature = "foxglove")]
mod gate;
mod place;
