//! Times for other processes where monotonic time can't be compared with theirs.

use std::time::Instant;

/// The host's monotonic time, which isn't available here.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoMonotonic;

impl NoMonotonic {
    /// Makes the relation.
    pub(super) fn now() -> Self {
        Self
    }

    /// Returns no time.
    pub(super) fn of(&self, _: Instant) -> Option<u64> {
        None
    }
}

pub(super) use NoMonotonic as Monotonic;
