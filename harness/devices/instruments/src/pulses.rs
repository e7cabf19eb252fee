//! Alignment of a unit's clock with that of the host, from pulses at the unit's whole seconds (1PPS).
//!
//! The unit marks each whole second of its stamps by a pulse, and the host knows when the pulse came. A
//! pulse doesn't say which second it marks: the alignment from arrivals ([`crate::align`]) does, as long
//! as the line delays a reading by less than [`DELAY_MOST_NS`]. The line through the pulses is then the
//! relation of the two clocks, without the unknown least delay of the line.
//!
//! The last [`PULSES`] pulses count, so that the line follows a clock whose rate changes with its
//! temperature. All of them weigh the same (least squares).

use crate::align::UnitClockEstimate;

/// Number of pulses that the line is fitted to.
pub const PULSES: usize = 64;
/// Number of pulses from which there is an estimate: with two the line has no residuals.
pub const PULSES_LEAST: usize = 3;
/// Largest delay of the line at which a pulse is paired with a second. It stays clear of half a second,
/// where the pairing is ambiguous.
pub const DELAY_MOST_NS: f64 = 0.4e9;
/// A pulse that is farther than this from the line is none of this unit's seconds, ns.
pub const PULSE_OFF_NS: f64 = 0.5e6;
/// Growth of that limit with the time since the last pulse: a clock that changed its rate, ns/s.
const OFF_NS_PER_S: f64 = 50e3;
/// Largest time by which readings may seem to arrive before they were made: the jitter of arrivals that
/// the alignment has seen too few of.
const EARLY_MOST_NS: f64 = 1e6;
/// Number of pulses in a row off the line after which the unit's clock has jumped.
const OFF_MOST: u32 = 3;
const SECOND_NS: u64 = 1_000_000_000;

/// A pulse with the second that it marks.
#[derive(Clone, Copy, Debug, Default)]
struct MarkedSecond {
    stamp_ns: u64,
    host_ns: u64,
}

/// Reason why pulses can't date readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PulseMismatch {
    /// The second that a pulse marks can't be told: the delay of the line is too near half a second.
    Ambiguous {
        /// Delay to the nearest second, ns.
        delay_ns: f64,
    },
    /// Readings arrive before the second that the pulse marks.
    Early {
        /// Time by which they do, ns.
        early_ns: f64,
    },
    /// The pulses left the line: the unit's clock jumped, or the pulses are those of another clock.
    Jumped {
        /// Distance of the last pulse from the line, ns.
        off_ns: f64,
    },
}

impl core::fmt::Display for PulseMismatch {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Ambiguous { delay_ns } => write!(
                f,
                "found readings that arrive {:.0} ms from a pulse's nearest whole second, expected less than \
                 {:.0} ms: which second the pulse marks can't be told",
                delay_ns.abs() * 1e-6,
                DELAY_MOST_NS * 1e-6
            ),
            Self::Early { early_ns } => write!(
                f,
                "found readings that arrive {:.3} ms before the second that a pulse marks, expected them after \
                 it: it is the pulse's other edge, or its seconds aren't those of the stamps",
                early_ns * 1e-6
            ),
            Self::Jumped { off_ns } => write!(
                f,
                "found {OFF_MOST} pulses in a row off the unit's clock, the last by {:+.3} ms, expected within \
                 {:.1} ms: the clock jumped, or the pulses aren't its own",
                off_ns * 1e-6,
                PULSE_OFF_NS * 1e-6
            ),
        }
    }
}

/// Use that was made of a pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PulseUse {
    /// It is part of the line.
    Taken,
    /// It is too far from the line, and was left out.
    Off,
}

/// Counts of pulses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PulseCounts {
    /// Pulses that were taken.
    pub taken: u64,
    /// Pulses that were left out.
    pub off: u64,
    /// Seconds without a pulse that was taken, between the first and the last one.
    pub missing: u64,
}

/// Estimate of a unit's clock from its pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulseEstimate {
    /// Stamp of the newest pulse, to which the offset refers.
    pub origin_ns: u64,
    /// Host time at that stamp, ns.
    pub offset_ns: f64,
    /// Relative rate by which host time is fast against the unit's.
    pub skew: f64,
    /// Largest distance of a pulse from the line, ns.
    pub residual_ns: f64,
    /// Standard deviation of the distances, ns.
    pub sigma_ns: f64,
    /// Time between the oldest and the newest pulse of the line, s.
    pub span_s: f64,
    /// Number of pulses of the line.
    pub pulses: usize,
}

impl PulseEstimate {
    /// Time since the newest pulse, s.
    fn since_s(&self, stamp_ns: u64) -> f64 {
        (i128::from(stamp_ns) - i128::from(self.origin_ns)) as f64 * 1e-9
    }

    /// Host time of a stamp, ns.
    #[must_use]
    pub fn host_ns(&self, stamp_ns: u64) -> f64 {
        self.offset_ns + self.since_s(stamp_ns) * 1e9 * (1.0 + self.skew)
    }

    /// Bound of the error of that time by the jitter of the pulses, ns. After the newest pulse it grows
    /// by the error that the residuals allow the rate. Residuals of few pulses are smaller than their
    /// jitter, as the line follows each of them: they count for more.
    #[must_use]
    pub fn within_ns(&self, stamp_ns: u64) -> f64 {
        let few = 1.0 + 4.0 / (self.pulses as f64 - 2.0);
        self.residual_ns * few * (1.0 + 2.0 * self.since_s(stamp_ns).max(0.0) / self.span_s)
    }
}

/// Estimates offset and skew of a unit's clock from pulses, without allocating.
#[derive(Clone, Debug)]
pub struct PulseAlignment {
    /// Ring of pulses; `next` is the index of the next one.
    ring: [MarkedSecond; PULSES],
    held: usize,
    next: usize,
    counts: PulseCounts,
    off_in_a_row: u32,
    estimate: Option<PulseEstimate>,
}

impl Default for PulseAlignment {
    fn default() -> Self {
        Self::new()
    }
}

impl PulseAlignment {
    /// Makes an estimator without pulses.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ring: [MarkedSecond { stamp_ns: 0, host_ns: 0 }; PULSES],
            held: 0,
            next: 0,
            counts: PulseCounts { taken: 0, off: 0, missing: 0 },
            off_in_a_row: 0,
            estimate: None,
        }
    }

    /// Adds a pulse that came at a host time. `arrivals` is the estimate from readings, on the same host
    /// clock.
    ///
    /// # Errors
    /// If the second that it marks can't be told, contradicts the arrivals, or the clock jumped.
    pub fn add(
        &mut self,
        host_ns: u64,
        arrivals: &UnitClockEstimate,
    ) -> Result<PulseUse, PulseMismatch> {
        let stamp_ns = marked(host_ns, arrivals)?;
        let Some(newest) = self.back(0) else {
            self.take(stamp_ns, host_ns);
            return Ok(PulseUse::Taken);
        };
        let skew = self.estimate.map_or(arrivals.skew.unwrap_or(0.0), |estimate| estimate.skew);
        let since_ns = i128::from(stamp_ns) - i128::from(newest.stamp_ns);
        let from_ns = self.estimate.map_or(newest.host_ns as f64, |estimate| estimate.offset_ns);
        let off_ns = host_ns as f64 - from_ns - since_ns as f64 * (1.0 + skew);
        let limit_ns = PULSE_OFF_NS + OFF_NS_PER_S * since_ns as f64 * 1e-9;
        if since_ns > 0 && off_ns.abs() <= limit_ns {
            self.counts.missing += (since_ns as u64 / SECOND_NS).saturating_sub(1);
            self.take(stamp_ns, host_ns);
            return Ok(PulseUse::Taken);
        }
        self.counts.off += 1;
        if self.estimate.is_none() {
            // With so few pulses the first may have been the stray one.
            self.held = 0;
            self.take(stamp_ns, host_ns);
            return Ok(PulseUse::Off);
        }
        self.off_in_a_row += 1;
        if self.off_in_a_row >= OFF_MOST {
            return Err(PulseMismatch::Jumped { off_ns });
        }
        Ok(PulseUse::Off)
    }

    /// Estimate; `None` before [`PULSES_LEAST`] pulses.
    #[must_use]
    pub const fn estimate(&self) -> Option<PulseEstimate> {
        self.estimate
    }

    /// Counts so far.
    #[must_use]
    pub const fn counts(&self) -> PulseCounts {
        self.counts
    }

    /// Pulse so many places before the newest.
    fn back(&self, places: usize) -> Option<MarkedSecond> {
        (places < self.held).then(|| self.ring[(self.next + PULSES - 1 - places) % PULSES])
    }

    fn take(&mut self, stamp_ns: u64, host_ns: u64) {
        self.ring[self.next] = MarkedSecond { stamp_ns, host_ns };
        self.next = (self.next + 1) % PULSES;
        self.held = (self.held + 1).min(PULSES);
        self.counts.taken += 1;
        self.off_in_a_row = 0;
        self.estimate = self.fit();
    }

    /// Least squares through the pulses that are held, relative to the newest one, so that all
    /// differences are small.
    fn fit(&self) -> Option<PulseEstimate> {
        if self.held < PULSES_LEAST {
            return None;
        }
        let newest = self.back(0)?;
        let point = |pulse: MarkedSecond| {
            let stamp_ns = i128::from(pulse.stamp_ns) - i128::from(newest.stamp_ns);
            let host_ns = i128::from(pulse.host_ns) - i128::from(newest.host_ns);
            (stamp_ns as f64 * 1e-9, (host_ns - stamp_ns) as f64)
        };
        let points = || (0..self.held).filter_map(|places| self.back(places)).map(point);
        let count = self.held as f64;
        let (sum_s, sum_ns) = points().fold((0.0, 0.0), |sum, (t, y)| (sum.0 + t, sum.1 + y));
        let (mean_s, mean_ns) = (sum_s / count, sum_ns / count);
        let (square, product) = points().fold((0.0, 0.0), |sum, (t, y)| {
            (sum.0 + (t - mean_s) * (t - mean_s), sum.1 + (t - mean_s) * (y - mean_ns))
        });
        // Seconds of pulses that are held differ: the sum is positive.
        let slope = product / square;
        let at_newest_ns = mean_ns - slope * mean_s;
        let (residual_ns, squares) = points().fold((0.0f64, 0.0), |found, (t, y)| {
            let off_ns = y - at_newest_ns - slope * t;
            (found.0.max(off_ns.abs()), found.1 + off_ns * off_ns)
        });
        let oldest = self.back(self.held - 1)?;
        Some(PulseEstimate {
            origin_ns: newest.stamp_ns,
            offset_ns: newest.host_ns as f64 + at_newest_ns,
            skew: slope * 1e-9,
            residual_ns,
            sigma_ns: libm::sqrt(squares / (count - 2.0)),
            span_s: (newest.stamp_ns - oldest.stamp_ns) as f64 * 1e-9,
            pulses: self.held,
        })
    }
}

/// Whole second of the unit that a pulse marks. By the arrivals the pulse is at its second less the delay
/// of the line.
fn marked(host_ns: u64, arrivals: &UnitClockEstimate) -> Result<u64, PulseMismatch> {
    let since_ns = (host_ns as f64 - arrivals.offset_ns) / (1.0 + arrivals.skew.unwrap_or(0.0));
    let by_arrivals_ns = i128::from(arrivals.origin_ns) + since_ns as i128;
    let second_ns = i128::from(SECOND_NS);
    let stamp_ns = (by_arrivals_ns + second_ns / 2).div_euclid(second_ns) * second_ns;
    let delay_ns = (stamp_ns - by_arrivals_ns) as f64;
    if delay_ns.abs() > DELAY_MOST_NS {
        return Err(PulseMismatch::Ambiguous { delay_ns });
    }
    if delay_ns < -EARLY_MOST_NS {
        return Err(PulseMismatch::Early { early_ns: -delay_ns });
    }
    u64::try_from(stamp_ns).map_err(|_| PulseMismatch::Ambiguous { delay_ns })
}
