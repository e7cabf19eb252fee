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

mod frame;
#[macro_use]
mod fields;
#[cfg(feature = "outline")]
mod outline;
mod reader;
mod writer;

pub use frame::StateFormat;
#[cfg(feature = "outline")]
pub use outline::{assert_layout, outline_of};
pub use reader::StateReader;
pub use writer::Writer;

use alloc::string::String;

/// Part of a model that changes while it runs.
pub trait State {
    /// Writes the values.
    fn save(&self, to: &mut Writer);

    /// Reads the values into a model that was made from the same configuration.
    ///
    /// # Errors
    /// If the bytes are not those of such a model. The model is then in no useful state.
    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError>;
}

/// Largest count accepted: no run reaches it, and additions to a count below it can't overflow.
pub const COUNT_MAX: u64 = 1 << 62;

/// Reason why bytes are not a state.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// No state at all, or the state of another model.
    #[error("not {what}: it does not begin with {magic}")]
    Magic {
        /// Name of the expected content.
        what: &'static str,
        /// Expected magic.
        magic: &'static str,
    },
    /// A version that this program doesn't read.
    #[error("{what} has version {found}, this program reads version {expected}")]
    Version {
        /// Name of the expected content.
        what: &'static str,
        /// Version found.
        found: u16,
        /// Version that is read.
        expected: u16,
    },
    /// Wrong length.
    #[error("{what} has {found} bytes, {expected} are expected")]
    Length {
        /// Name of the expected content.
        what: &'static str,
        /// Bytes found.
        found: usize,
        /// Length given in the frame, or the smallest possible length.
        expected: u64,
    },
    /// Wrong checksum.
    #[error("{what} is damaged: checksum {found:#010x}, computed {computed:#010x}")]
    Checksum {
        /// Name of the expected content.
        what: &'static str,
        /// Checksum in the bytes.
        found: u32,
        /// Checksum of the bytes.
        computed: u32,
    },
    /// A value that can't be read, or is out of range.
    #[error("{field}: {problem}")]
    Value {
        /// Name of the value.
        field: &'static str,
        /// Value found and values expected.
        problem: String,
    },
}

impl StateError {
    /// Makes [`StateError::Value`].
    #[must_use]
    pub fn value(field: &'static str, problem: impl Into<String>) -> Self {
        Self::Value { field, problem: problem.into() }
    }
}

/// Checks that a count is one that a run can reach.
///
/// # Errors
/// If it is above [`COUNT_MAX`].
pub fn check_count(field: &'static str, found: u64) -> Result<(), StateError> {
    check_below(field, found, COUNT_MAX)
}

/// Checks that a number is at most `largest`.
///
/// # Errors
/// If it is larger.
pub fn check_below(field: &'static str, found: u64, largest: u64) -> Result<(), StateError> {
    if found <= largest {
        Ok(())
    } else {
        let problem = alloc::format!("{found} was found, at most {largest} is expected");
        Err(StateError::value(field, problem))
    }
}
