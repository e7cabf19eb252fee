//! Lateness over a run, in bounded memory.

/// Most intervals; when they are full, neighbours are merged.
pub const INTERVALS_MAX: usize = 1000;

/// Lateness in an interval of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatenessInterval {
    /// Smallest lateness, ns.
    pub least_ns: u64,
    /// Largest lateness, ns.
    pub largest_ns: u64,
    /// Number of overruns.
    pub overruns: u64,
}

impl LatenessInterval {
    fn take(&mut self, later: &Self) {
        self.least_ns = self.least_ns.min(later.least_ns);
        self.largest_ns = self.largest_ns.max(later.largest_ns);
        self.overruns += later.overruns;
    }
}

/// Lateness over a run, in at most 1000 intervals of equally many frames. Memory is reserved at the
/// beginning: recording a frame allocates nothing, and merging takes some microseconds each time that
/// the run has doubled its length.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LatenessSeries {
    intervals: Vec<LatenessInterval>,
    per_interval: u64,
    in_last: u64,
}

impl Default for LatenessSeries {
    fn default() -> Self {
        Self::new()
    }
}

impl LatenessSeries {
    /// Makes an empty series.
    #[must_use]
    pub fn new() -> Self {
        Self { intervals: Vec::with_capacity(INTERVALS_MAX), per_interval: 1, in_last: 0 }
    }

    /// Records the lateness of the next frame, ns.
    #[inline]
    pub fn record(&mut self, lateness_ns: u64, is_overrun: bool) {
        let frame = LatenessInterval {
            least_ns: lateness_ns,
            largest_ns: lateness_ns,
            overruns: u64::from(is_overrun),
        };
        if self.in_last < self.per_interval
            && let Some(last) = self.intervals.last_mut()
        {
            last.take(&frame);
            self.in_last += 1;
            return;
        }
        if self.intervals.len() == INTERVALS_MAX {
            self.halve();
        }
        self.intervals.push(frame);
        self.in_last = 1;
    }

    /// Merges every second interval with the one before it.
    #[cold]
    fn halve(&mut self) {
        for i in 0..INTERVALS_MAX / 2 {
            let (mut merged, later) = (self.intervals[2 * i], self.intervals[2 * i + 1]);
            merged.take(&later);
            self.intervals[i] = merged;
        }
        self.intervals.truncate(INTERVALS_MAX / 2);
        self.per_interval *= 2;
    }

    /// Number of frames of each interval; the last one may have fewer.
    #[must_use]
    pub fn frames_per_interval(&self) -> u64 {
        self.per_interval
    }

    /// Intervals in the order of the run.
    #[must_use]
    pub fn intervals(&self) -> &[LatenessInterval] {
        &self.intervals
    }
}
