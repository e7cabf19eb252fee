//! Reasons why a record of fixed length is none.

use core::fmt;

/// A number as it was found.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct FoundNumber(u64);

impl FoundNumber {
    pub(crate) fn of(value: f64) -> Self {
        Self(value.to_bits())
    }
}

impl fmt::Display for FoundNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:e}", f64::from_bits(self.0))
    }
}

impl fmt::Debug for FoundNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Reason why a record is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordDefect {
    /// A number is infinite or none.
    #[error("{field} is {found}, expected a finite number")]
    NotFinite {
        /// Name of the field.
        field: &'static str,
        /// Value.
        found: FoundNumber,
    },
    /// A number is beyond what any sensor gives.
    #[error("{field} is {found} in SI units, which no sensor gives")]
    Beyond {
        /// Name of the field.
        field: &'static str,
        /// Value, SI units.
        found: FoundNumber,
    },
    /// The stamp isn't later than the one before it.
    #[error("the stamp, {now_ns} ns, isn't after the one before it, {before_ns} ns")]
    Stamp {
        /// Stamp, ns.
        now_ns: u64,
        /// Stamp of the record before it, ns.
        before_ns: u64,
    },
    /// The checksums of two records in a row are wrong.
    #[error("its checksum is wrong, and so is that of the record before it")]
    Checksums,
}
