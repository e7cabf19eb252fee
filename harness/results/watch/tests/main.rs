//! Tests of watched runs, in one program.
#![allow(clippy::unwrap_used)]

#[path = "../../recorder/tests/common"]
mod common {
    pub(crate) mod epochs;
    pub(crate) mod stream;
}
#[cfg(feature = "dashboard")]
mod known;
#[cfg(feature = "dashboard")]
mod screen;

#[cfg(feature = "dashboard")]
mod dashboard;
#[cfg(feature = "dashboard")]
mod fit;
#[cfg(feature = "foxglove")]
mod gate;
mod place;
mod tail;
