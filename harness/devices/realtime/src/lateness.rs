//! Histogram of lateness.

use hdrhistogram::Histogram;
use serde::{Deserialize, Serialize};

/// Largest lateness that is distinguished from larger ones, ns: a minute.
pub const LARGEST_NS: u64 = 60_000_000_000;

/// Histogram of durations with three significant digits, from 1 ns to a minute; longer ones count as a
/// minute. Recording a duration takes a few nanoseconds and allocates nothing.
#[derive(Clone, Debug)]
pub struct LatenessHistogram {
    histogram: Histogram<u64>,
    /// Largest duration, exact, ns.
    max_ns: u64,
}

impl Default for LatenessHistogram {
    fn default() -> Self {
        Self::new()
    }
}

impl LatenessHistogram {
    /// Makes an empty histogram.
    #[must_use]
    pub fn new() -> Self {
        #[allow(clippy::expect_used, reason = "the bounds are constants that a test makes one of")]
        let histogram = Histogram::new_with_bounds(1, LARGEST_NS, 3).expect("bounds of constants");
        Self { histogram, max_ns: 0 }
    }

    /// Records a duration.
    #[inline]
    pub fn record(&mut self, lateness_ns: u64) {
        self.max_ns = self.max_ns.max(lateness_ns);
        self.histogram.saturating_record(lateness_ns);
    }

    /// Number of durations recorded.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.histogram.len()
    }

    /// Largest duration, ns.
    #[must_use]
    pub fn max_ns(&self) -> u64 {
        self.max_ns
    }

    /// Quantile of the durations for a share from 0 to 1, ns, to three digits; 0 without any.
    #[must_use]
    pub fn quantile_ns(&self, share: f64) -> u64 {
        self.histogram.value_at_quantile(share.clamp(0.0, 1.0)).min(self.max_ns)
    }

    /// Adds another histogram.
    pub fn add(&mut self, other: &Self) {
        self.max_ns = self.max_ns.max(other.max_ns);
        for step in other.histogram.iter_recorded() {
            self.histogram.saturating_record_n(step.value_iterated_to(), step.count_at_value());
        }
    }

    /// Figures for a summary.
    #[must_use]
    pub fn figures(&self) -> Figures {
        let us = |ns: u64| ns as f64 / 1e3;
        Figures {
            count: self.count(),
            p50_us: us(self.quantile_ns(0.5)),
            p99_us: us(self.quantile_ns(0.99)),
            p999_us: us(self.quantile_ns(0.999)),
            max_us: us(self.max_ns),
        }
    }

    /// Rows of the histogram: an upper edge in ns, and the number of durations up to it and above the
    /// edge before. There are at most ten rows to the decade, none of them empty. The counts add up to
    /// [`Self::count`].
    #[must_use]
    pub fn rows(&self) -> Vec<(u64, u64)> {
        let mut rows: Vec<(u64, u64)> = Vec::new();
        for step in self.histogram.iter_recorded() {
            // A value is kept as the upper end of its cell, which is 0.1 % wide.
            let value = step.value_iterated_to().max(1) as f64;
            let edge = 10f64.powf((value.log10() * 10.0).ceil() / 10.0).round() as u64;
            match rows.last_mut() {
                Some((last, count)) if *last == edge => *count += step.count_at_value(),
                _ => rows.push((edge, step.count_at_value())),
            }
        }
        rows
    }
}

/// Most important figures of a [`LatenessHistogram`]. The maximum grows with the length of a test; compare the
/// quantiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Number of durations.
    pub count: u64,
    /// Median, µs.
    pub p50_us: f64,
    /// 99 % quantile, µs.
    pub p99_us: f64,
    /// 99.9 % quantile, µs.
    pub p999_us: f64,
    /// Maximum, µs.
    pub max_us: f64,
}
