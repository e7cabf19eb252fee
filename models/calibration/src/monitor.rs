//! Plain faults of a sample: order, gaps, saturation, stuck channels.

use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Health, Sample, Status};

/// Position of a sample after the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleOrder {
    /// The next sample, with its interval in ns.
    Next(u64),
    /// A later sample than the next one.
    Gap {
        /// Missing samples.
        missing: u64,
    },
    /// Not later than the last sample, or so much later that the stamp must be wrong: not to be
    /// used.
    Behind,
}

/// Counts since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct MonitorTally {
    /// Number of gaps.
    pub gaps: u64,
    /// Samples missing in all gaps.
    pub missing: u64,
    /// Samples that did not advance in time or sequence.
    pub out_of_order: u64,
    /// Samples with a channel that the test finds stuck.
    pub stuck: u64,
    /// Samples with saturated or invalid counts.
    pub invalid: u64,
}

/// Number and stamp of a sample.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
struct Last {
    sequence: u64,
    time_ns: u64,
}

/// Monitor of the stream of samples.
#[derive(Clone, Debug)]
pub struct Monitor {
    period_ns: u64,
    stuck_samples: Option<u32>,
    /// Triads with enough noise for the test of identical counts.
    testable: [bool; 2],
    last: Option<Last>,
    /// Counts of the last sample, gyros first. Kept as they are compared: a copy of the whole
    /// sample would wait for the stores that have just filled it.
    counts: [i32; 6],
    /// Samples in a row, beyond the first, in which a channel gave the same count.
    identical: [u32; 6],
    /// True if one of `identical` is not zero.
    repeats: bool,
    /// True if there are no counts yet to compare with.
    fresh: bool,
    tally: MonitorTally,
}

#[cfg(feature = "state")]
octant_state::state! {
    Monitor {
        values: last, counts, identical, repeats, fresh, tally;
        parts: ;
        kept: period_ns, stuck_samples, testable;
        check: Self::check_tally
    }
}

#[cfg(feature = "state")]
impl Monitor {
    fn check_tally(&self) -> Result<(), octant_state::StateError> {
        let MonitorTally { gaps, missing, out_of_order, stuck, invalid } = self.tally;
        for count in [gaps, missing, out_of_order, stuck, invalid] {
            octant_state::check_count("tally", count)?;
        }
        Ok(())
    }
}

/// Largest jump ahead of a stamp or number; a larger one is damage: no source pauses for more than
/// a day, and if it were accepted, every later sample would lie before it.
const JUMP_MAX_NS: u64 = 86_400_000_000_000;

/// White noise below this many counts makes identical samples likely.
const TESTABLE_COUNTS: f64 = 20.0;

impl Monitor {
    /// Makes a monitor for samples of this period, noise (1σ of an increment, rad and m/s) and
    /// number of identical counts in a row that make a channel stuck. Pulses of a `resolution` (rad
    /// and m/s) that is coarser than the noise repeat by themselves: the triad isn't tested.
    #[must_use]
    pub fn new(
        period_ns: u64,
        sigmas: (f64, f64),
        resolution: (f64, f64),
        stuck_samples: Option<u32>,
    ) -> Self {
        Self {
            period_ns,
            stuck_samples,
            testable: [
                sigmas.0 / DELTA_THETA_LSB_RAD >= TESTABLE_COUNTS && resolution.0 <= sigmas.0,
                sigmas.1 / DELTA_VELOCITY_LSB_MPS >= TESTABLE_COUNTS && resolution.1 <= sigmas.1,
            ],
            last: None,
            counts: [0; 6],
            identical: [0; 6],
            repeats: false,
            fresh: true,
            tally: MonitorTally::default(),
        }
    }

    /// Returns the position of this sample after the last, and its health flags without those of
    /// stuck channels, for which [`Self::stuck`] or a [`crate::screen::Screen`] tests.
    #[inline]
    pub fn check(&mut self, sample: &Sample) -> (SampleOrder, Health) {
        let mut health = Health::empty();
        let order = self.order(sample);
        match order {
            SampleOrder::Behind => {
                self.tally.out_of_order += 1;
                return (order, Health::OUT_OF_ORDER);
            }
            SampleOrder::Gap { missing } => {
                self.tally.gaps += 1;
                self.tally.missing += missing;
                health |= Health::GAP;
            }
            SampleOrder::Next(_) => {}
        }
        if sample.status.intersects(
            Status::GYRO_SATURATED | Status::ACCELEROMETER_SATURATED | Status::INERTIAL_INVALID,
        ) {
            self.tally.invalid += 1;
            health |= Health::INERTIAL_INVALID;
        }
        self.last = Some(Last { sequence: sample.sequence, time_ns: sample.device_time.ns });
        (order, health)
    }

    #[inline]
    fn order(&self, sample: &Sample) -> SampleOrder {
        let Some(last) = &self.last else { return SampleOrder::Next(self.period_ns) };
        if sample.sequence <= last.sequence || sample.device_time.ns <= last.time_ns {
            return SampleOrder::Behind;
        }
        let interval_ns = sample.device_time.ns - last.time_ns;
        if interval_ns == self.period_ns && sample.sequence == last.sequence + 1 {
            // The usual case, without a division: division is slow for every sample.
            return SampleOrder::Next(interval_ns);
        }
        let jump = sample.sequence - last.sequence;
        if interval_ns > JUMP_MAX_NS || jump > JUMP_MAX_NS / self.period_ns.max(1) {
            return SampleOrder::Behind;
        }
        // Rounded to whole samples: stamps of real instruments jitter.
        let periods = (interval_ns + self.period_ns / 2) / self.period_ns;
        if periods >= 2 {
            SampleOrder::Gap { missing: periods - 1 }
        } else {
            SampleOrder::Next(interval_ns)
        }
    }

    /// Finds channels that repeat the same count; to be called for every sample.
    ///
    /// Each count is an argument of its own, and the call is not inlined, so that each is read with
    /// the width with which it was written: a wide read of single stores has to wait for them.
    #[inline(never)]
    pub fn stuck(&mut self, x: i32, y: i32, z: i32, u: i32, v: i32, w: i32) -> Health {
        let before = core::mem::replace(&mut self.counts, [x, y, z, u, v, w]);
        // With noise of many counts nearly every sample ends here.
        let same = x == before[0]
            || y == before[1]
            || z == before[2]
            || u == before[3]
            || v == before[4]
            || w == before[5];
        let fresh = core::mem::replace(&mut self.fresh, false);
        if !fresh && (same || self.repeats) { self.repeated(&before) } else { Health::empty() }
    }

    #[cold]
    #[inline(never)]
    fn repeated(&mut self, before: &[i32; 6]) -> Health {
        let Some(limit) = self.stuck_samples else { return Health::empty() };
        let mut health = Health::empty();
        let flags = [Health::GYRO_STUCK, Health::ACCELEROMETER_STUCK];
        for channel in 0..6 {
            let run = &mut self.identical[channel];
            *run = if self.counts[channel] == before[channel] { run.saturating_add(1) } else { 0 };
            if self.testable[channel / 3] && run.saturating_add(1) >= limit {
                health |= flags[channel / 3];
            }
        }
        self.repeats = self.identical != [0; 6];
        if !health.is_empty() {
            self.tally.stuck += 1;
        }
        health
    }

    /// Counts a sample with a channel that a screen found stuck.
    pub fn note_stuck(&mut self) {
        self.tally.stuck += 1;
    }

    /// Counts since the start.
    #[must_use]
    pub fn tally(&self) -> &MonitorTally {
        &self.tally
    }
}
