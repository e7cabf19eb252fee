//! Compares the rate of an instrument's readings with that of the scenario: with another one every sample would stand
//! for the wrong time.

use octant_instruments::Reading;

/// Number of intervals that are looked at.
const INTERVALS: usize = 50;
/// Number of intervals that a shorter source has to have.
const INTERVALS_MIN: usize = 10;
/// Largest difference from the period, as a share of it.
const TOLERANCE: f64 = 0.05;

/// The first intervals of the readings.
#[derive(Debug)]
pub(super) struct RateCheck {
    period_s: f64,
    last_ns: Option<u64>,
    intervals_s: Vec<f64>,
    is_done: bool,
}

impl RateCheck {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            period_s: 1.0 / rate_hz,
            last_ns: None,
            intervals_s: Vec::with_capacity(INTERVALS),
            is_done: false,
        }
    }

    /// Takes a reading: the interval that it has, or the one since the stamp before.
    ///
    /// # Errors
    /// If it is the last one that is looked at, and the rate isn't that of the scenario.
    #[inline]
    pub(super) fn reading(&mut self, reading: &Reading) -> Result<(), String> {
        if self.is_done {
            return Ok(());
        }
        let stamp_ns = reading.stamp.map(|stamp| stamp.ns);
        let passed_ns = stamp_ns.zip(self.last_ns).map(|(now, last)| now.saturating_sub(last));
        self.last_ns = stamp_ns;
        let passed_s = passed_ns.filter(|ns| *ns > 0).map(|ns| ns as f64 * 1e-9);
        self.intervals_s.extend(reading.interval_s.or(passed_s));
        if self.intervals_s.len() < INTERVALS { Ok(()) } else { self.end() }
    }

    /// Judges the intervals so far; few ones say nothing.
    ///
    /// # Errors
    /// If the rate isn't that of the scenario.
    pub(super) fn end(&mut self) -> Result<(), String> {
        if self.is_done || self.intervals_s.len() < INTERVALS_MIN {
            return Ok(());
        }
        self.is_done = true;
        self.intervals_s.sort_by(f64::total_cmp);
        let median_s = self.intervals_s[self.intervals_s.len() / 2];
        // Stamps of few digits are a mean of the interval; gaps are none.
        let near = || self.intervals_s.iter().filter(|s| **s < 1.5 * median_s);
        let found_s = near().sum::<f64>() / near().count().max(1) as f64;
        if (found_s - self.period_s).abs() <= TOLERANCE * self.period_s {
            return Ok(());
        }
        Err(format!(
            "readings are {:.4} ms apart, {:.1} Hz, expected {:.4} ms by imu.rate",
            1e3 * found_s,
            1.0 / found_s,
            1e3 * self.period_s
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_instruments::{Stamp, StampClock};

    /// Judgement of readings with these stamps, ns, at 400 Hz.
    fn judged(stamps: impl Iterator<Item = u64>) -> Result<(), String> {
        let mut check = RateCheck::new(400.0);
        for ns in stamps {
            let stamp = Some(Stamp { ns, clock: StampClock::Startup });
            check.reading(&Reading { stamp, ..Reading::NOTHING })?;
        }
        check.end()
    }

    #[test]
    fn stamps_in_whole_milliseconds_and_gaps_are_no_other_rate() {
        // 2 and 3 ms in turn, and a fifth of the readings lost.
        assert_eq!(judged((0..130).map(|k| k * 25 / 10 * 1_000_000)), Ok(()));
        assert_eq!(judged((0..130).filter(|k| k % 5 != 3).map(|k| k * 2_500_000)), Ok(()));
        assert_eq!(judged((0..5).map(|k| k * 10_000_000)), Ok(()), "too few");
    }

    #[test]
    fn another_rate_is_told() {
        for period_ns in [2_000_000, 2_700_000, 5_000_000] {
            let found = judged((0..130).map(|k| k * period_ns)).unwrap_err();
            assert!(found.contains("expected 2.5000 ms by imu.rate"), "{found}");
            judged((0..20).map(|k| k * period_ns)).unwrap_err();
        }
    }
}
