//! States of models as bytes: what a model needs to go on exactly as it would have.
//!
//! A state is a [`Format`]'s frame: magic, version, length, the values, and a CRC-32 over all of it.
//! Values are written by postcard (f64 as their 64 bits, so that NaN stays the same NaN), in the
//! order in which [`State::save`] names them; the same state gives the same bytes.
//!
//! What follows from a model's configuration is not in its state. A model is made anew from its
//! configuration, and [`State::load`] puts into it what has changed since: so no bytes, whatever is
//! in them, can contradict what the configuration says of sizes and limits. A frame that is
//! truncated, altered, of another model or of a newer version is refused. Bytes whose checksum is
//! right and whose values no model would have written are refused where a value would be an index,
//! a length or a count out of range; beyond that they are numbers, and the model computes with them
//! what it can. It doesn't panic.
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

pub use frame::Format;
#[cfg(feature = "outline")]
pub use outline::{assert_layout, outline_of};
pub use reader::Reader;
pub use writer::Writer;

use alloc::string::String;

/// What changes in a model while it runs.
pub trait State {
    /// Writes it.
    fn save(&self, to: &mut Writer);

    /// Reads it into a model that was made from the same configuration.
    ///
    /// # Errors
    /// If the bytes are not those of such a model. It is then in no useful state.
    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), StateError>;
}

/// A count above this is none that a run reaches: what is added to it can't overflow.
pub const COUNT_MAX: u64 = 1 << 62;

/// Why bytes are not a state.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// Something else, or the state of another model.
    #[error("not {what}: it does not begin with {magic}")]
    Magic {
        /// What is expected.
        what: &'static str,
        /// How it begins.
        magic: &'static str,
    },
    /// A version that isn't known here.
    #[error("{what} has version {found}, this program reads version {expected}")]
    Version {
        /// What is expected.
        what: &'static str,
        /// Version found.
        found: u16,
        /// Version that is read.
        expected: u16,
    },
    /// Wrong length.
    #[error("{what} has {found} bytes, {expected} are expected")]
    Length {
        /// What is expected.
        what: &'static str,
        /// Bytes found.
        found: usize,
        /// Bytes that it says to have, or the fewest that it can have.
        expected: u64,
    },
    /// Damaged.
    #[error("{what} is damaged: checksum {found:#010x}, computed {computed:#010x}")]
    Checksum {
        /// What is expected.
        what: &'static str,
        /// Checksum in the bytes.
        found: u32,
        /// Checksum of the bytes.
        computed: u32,
    },
    /// A value that isn't one.
    #[error("{field}: {problem}")]
    Value {
        /// Its name.
        field: &'static str,
        /// What was found and what is expected.
        problem: String,
    },
}

impl StateError {
    /// A value that isn't one.
    #[must_use]
    pub fn value(field: &'static str, problem: impl Into<String>) -> Self {
        Self::Value { field, problem: problem.into() }
    }
}

/// A count that a run reaches.
///
/// # Errors
/// If it is above [`COUNT_MAX`].
pub fn check_count(field: &'static str, found: u64) -> Result<(), StateError> {
    check_below(field, found, COUNT_MAX)
}

/// A number that is at most `largest`.
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
