//! Frame clock.

use crate::clock::{MonotonicTime, now, sleep_until, spin_until};
use crate::lateness::{Figures, LatenessHistogram};
use crate::series::LatenessSeries;
use serde::{Deserialize, Serialize};

/// Pacing of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FramePacing {
    /// Period of the frames, ns; not 0.
    pub period_ns: u64,
    /// Last part of each wait that is spent reading the clock, ns. Punctual to a microsecond if the
    /// thread has a real-time priority, worse than sleeping if it hasn't.
    pub spin_ns: u64,
    /// Lateness above which a frame is an overrun, ns.
    pub overrun_ns: u64,
}

/// Waits for the deadlines of frames and measures their lateness. It is a monitor: it calls nothing,
/// skips nothing and never shortens a frame. Late frames follow each other without a wait until they
/// have caught up.
#[derive(Clone, Debug)]
pub struct FrameClock {
    pacing: FramePacing,
    start: MonotonicTime,
    frame: u64,
    lateness: LatenessHistogram,
    series: LatenessSeries,
    /// Time left before the next deadline when the work of a frame was done.
    slack: LatenessHistogram,
    overruns: u64,
    /// Present number of overruns in a row; `longest_row` is the largest.
    row: u64,
    longest_row: u64,
    first_overrun: Option<u64>,
}

impl FrameClock {
    /// Starts a clock whose frame 0 is due now, without waiting.
    #[must_use]
    pub fn start(pacing: FramePacing) -> Self {
        Self::start_at(pacing, now())
    }

    /// Starts a clock whose frame 0 is due at `start`.
    #[must_use]
    pub fn start_at(pacing: FramePacing, start: MonotonicTime) -> Self {
        Self {
            pacing: FramePacing { period_ns: pacing.period_ns.max(1), ..pacing },
            start,
            frame: 0,
            lateness: LatenessHistogram::new(),
            series: LatenessSeries::new(),
            slack: LatenessHistogram::new(),
            overruns: 0,
            row: 0,
            longest_row: 0,
            first_overrun: None,
        }
    }

    /// Makes frame 0 due now. To be called before the first wait.
    pub fn restart(&mut self) {
        self.start = now();
    }

    /// Deadline of the next frame. Computed from the start and the frame number, so that no error
    /// accumulates.
    #[must_use]
    #[inline]
    pub fn deadline(&self) -> MonotonicTime {
        self.start.after((self.frame + 1).saturating_mul(self.pacing.period_ns))
    }

    /// Time at which frame 0 was due.
    #[must_use]
    pub fn started(&self) -> MonotonicTime {
        self.start
    }

    /// Waits until the next frame is due, and returns the time at which it begins.
    #[inline]
    pub fn wait(&mut self) -> MonotonicTime {
        let deadline = self.deadline();
        let before = now();
        let mut time = before;
        if before < deadline {
            self.slack.record(deadline.since(before));
            let sleep_to = MonotonicTime { ns: deadline.ns.saturating_sub(self.pacing.spin_ns) };
            if before < sleep_to {
                sleep_until(sleep_to);
            }
            // Without spinning the deadline has already passed, and this reads the clock once.
            time = spin_until(deadline);
        } else {
            self.slack.record(0);
        }
        self.begin(time.since(deadline));
        time
    }

    /// Records the lateness of a frame that begins.
    #[inline]
    pub fn begin(&mut self, lateness_ns: u64) {
        self.frame += 1;
        self.lateness.record(lateness_ns);
        let is_overrun = lateness_ns > self.pacing.overrun_ns;
        self.series.record(lateness_ns, is_overrun);
        if is_overrun {
            self.overruns += 1;
            self.row += 1;
            self.longest_row = self.longest_row.max(self.row);
            self.first_overrun.get_or_insert(self.frame);
        } else {
            self.row = 0;
        }
    }

    /// Number of frames that have begun.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frame
    }

    /// Number of overruns.
    #[must_use]
    pub fn overruns(&self) -> u64 {
        self.overruns
    }

    /// Lateness of all frames.
    #[must_use]
    pub fn lateness(&self) -> &LatenessHistogram {
        &self.lateness
    }

    /// Lateness of the frames over the run.
    #[must_use]
    pub fn series(&self) -> &LatenessSeries {
        &self.series
    }

    /// Results so far.
    #[must_use]
    pub fn report(&self) -> PaceReport {
        PaceReport {
            frames: self.frame,
            period_us: self.pacing.period_ns as f64 / 1e3,
            overrun_us: self.pacing.overrun_ns as f64 / 1e3,
            overruns: self.overruns,
            longest_row_of_overruns: self.longest_row,
            first_overrun: self.first_overrun,
            lateness: self.lateness.figures(),
            slack_p1_us: self.slack.quantile_ns(0.01) as f64 / 1e3,
        }
    }
}

/// Results of a frame clock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PaceReport {
    /// Number of frames that began.
    pub frames: u64,
    /// Period, µs.
    pub period_us: f64,
    /// Lateness above which a frame is an overrun, µs.
    pub overrun_us: f64,
    /// Number of overruns.
    pub overruns: u64,
    /// Largest number of overruns in a row.
    pub longest_row_of_overruns: u64,
    /// Number of the first overrun frame, from 1.
    pub first_overrun: Option<u64>,
    /// Lateness of the frames.
    pub lateness: Figures,
    /// Part of the period that 99 % of the frames left unused at least, µs.
    pub slack_p1_us: f64,
}
