//! Reasons why bytes are no state, and checks of values that are counts.

use alloc::string::String;

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
