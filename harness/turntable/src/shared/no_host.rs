//! The end of the run that drives the table, on systems where nobody can join it.

use crate::TableStatus;
use octant_sample::GimbalAngles;

/// How a guest's run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GuestEnd {
    /// It is still going on.
    Open,
    /// It had all its samples.
    Done,
    /// It left, or was lost, for this reason.
    Left(String),
}

/// Takes no guests.
#[derive(Clone, Debug)]
pub struct TableHost {
    units: usize,
}

impl TableHost {
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
