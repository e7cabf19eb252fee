//! States of models as bytes: the data with which a model continues bit for bit.
//!
//! A state is a [`StateFormat`]'s frame: magic, version, length, the values, and a CRC-32 over all of it.
//! Values are written by postcard (f64 as their 64 bits, so that NaN stays the same NaN), in the
//! order in which [`State::save`] names them; the same state gives the same bytes.
//!
//! A state holds nothing that follows from a model's configuration. A model is made anew from its
//! configuration, and [`State::load`] puts into it the values that have changed since: no bytes,
//! whatever their content, can contradict the sizes and limits of the configuration. A frame that
//! is truncated, altered, of another model or of another version is refused. Bytes with a correct
//! checksum but with values that no model would have written are refused where a value would be an
//! index, a length or a count out of range; any other value is accepted as a number, and the model
//! computes with it. It doesn't panic.
#![no_std]

extern crate alloc;
#[cfg(any(test, feature = "outline"))]
extern crate std;

mod error;
mod frame;
#[macro_use]
mod fields;
#[cfg(feature = "outline")]
mod outline;
mod values;

pub use error::{COUNT_MAX, StateError, check_below, check_count};
pub use frame::StateFormat;
#[cfg(feature = "outline")]
pub use outline::{assert_layout, outline_of};
pub use values::{State, StateReader, Writer};
