//! The end of the run that drives the table, on systems where nobody can join it.

use super::ends::GuestEnd;
use crate::TableStatus;
use octant_sample::GimbalAngles;

/// Takes no guests.
#[derive(Clone, Debug)]
pub struct NoTableHost {
    units: usize,
}

impl NoTableHost {
    /// Makes a host for so many runs, its own among them.
    #[must_use]
    pub fn new(units: usize) -> Self {
        Self { units }
    }

    /// True if everybody is there.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.units < 2
    }

    /// Number of the runs that are there.
    #[must_use]
    pub fn present(&self) -> usize {
        1
    }

    /// Number of all runs, its own among them.
    #[must_use]
    pub const fn units(&self) -> usize {
        self.units
    }

    pub(crate) fn begin(&self) {}

    pub(crate) fn look(&self, _: &TableStatus, _: Option<GimbalAngles>) {}

    pub(crate) fn stopped(&self, _: &str) {}

    pub(crate) fn end(&self) {}

    /// Returns false.
    #[must_use]
    pub fn has_open(&self) -> bool {
        false
    }

    /// Returns none.
    #[must_use]
    pub fn ends(&self) -> Vec<GuestEnd> {
        Vec::new()
    }
}
