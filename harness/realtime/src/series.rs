//! Lateness over a run, in bounded memory.

/// Most intervals; when they are full, neighbours are merged.
const INTERVALS_MAX: usize = 1000;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_at_200_hz_stays_short_and_keeps_every_overrun_and_extreme() {
        let (mut series, frames) = (LatenessSeries::new(), 24 * 3600 * 200u64);
        let late = |k: u64| match k {
            7_777_777 => 9_000_000,
            7_777_778 => 3,
            k => 20_000 + k % 1000,
        };
        for k in 0..frames {
            let late_ns = late(k);
            series.record(late_ns, late_ns > 1_000_000 || k % 1_000_000 == 0);
        }
        let (intervals, each) = (series.intervals(), series.frames_per_interval());
        assert!((500..=1000).contains(&intervals.len()), "{}", intervals.len());
        assert_eq!(series.intervals.capacity(), INTERVALS_MAX, "nothing was allocated");
        assert_eq!((frames).div_ceil(each), intervals.len() as u64);
        let spike = intervals[(7_777_777 / each) as usize];
        assert_eq!(spike.largest_ns, 9_000_000);
        assert_eq!(intervals[(7_777_778 / each) as usize].least_ns, 3);
        assert_eq!(intervals.iter().filter(|i| i.largest_ns > 21_000).count(), 1);
        let overruns: u64 = intervals.iter().map(|i| i.overruns).sum();
        assert_eq!(overruns, 18 + 1);
    }

    #[test]
    fn the_frame_after_the_last_interval_merges_neighbours() {
        let mut series = LatenessSeries::new();
        for k in 0..INTERVALS_MAX as u64 {
            series.record(k + 1, k == 999);
        }
        assert_eq!((series.intervals().len(), series.frames_per_interval()), (1000, 1));
        series.record(5, false);
        assert_eq!((series.intervals().len(), series.frames_per_interval()), (501, 2));
        let of =
            |least_ns, largest_ns, overruns| LatenessInterval { least_ns, largest_ns, overruns };
        assert_eq!(series.intervals()[0], of(1, 2, 0));
        assert_eq!(series.intervals()[499], of(999, 1000, 1));
        assert_eq!(series.intervals()[500], of(5, 5, 0));
        // The last interval has room for one more frame.
        series.record(9, false);
        assert_eq!(series.intervals()[500..], [of(5, 9, 0)]);
    }
}
