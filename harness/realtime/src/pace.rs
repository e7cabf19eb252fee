//! The frame clock.

use crate::clock::{HostTime, now, sleep_until, spin_until};
use crate::lateness::{Figures, Lateness};
use serde::{Deserialize, Serialize};

/// How frames are paced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pacing {
    /// From one frame to the next, ns; not 0.
    pub period_ns: u64,
    /// The last part of each wait is spent looking at the clock, ns: punctual to a microsecond
    /// where the thread has a real-time priority, worse than sleeping where it hasn't.
    pub spin_ns: u64,
    /// A frame that starts later than this is an overrun, ns.
    pub overrun_ns: u64,
}

/// Waits for the deadlines of frames and measures how late each began. It is a monitor: it calls
/// nothing, skips nothing and never makes a frame shorter. Frames that are late follow each other
/// without a wait until they have caught up.
#[derive(Clone, Debug)]
pub struct FrameClock {
    pacing: Pacing,
    start: HostTime,
    frame: u64,
    lateness: Lateness,
    /// Time that was left when a frame had been dealt with.
    slack: Lateness,
    overruns: u64,
    /// Frames in a row that are late now, and most of them.
    row: u64,
    longest_row: u64,
    first_overrun: Option<u64>,
}

impl FrameClock {
    /// A clock whose frame 0 is due now; nothing waits for it.
    #[must_use]
    pub fn start(pacing: Pacing) -> Self {
        Self::start_at(pacing, now())
    }

    /// A clock whose frame 0 is due at `start`.
    #[must_use]
    pub fn start_at(pacing: Pacing, start: HostTime) -> Self {
        Self {
            pacing: Pacing { period_ns: pacing.period_ns.max(1), ..pacing },
            start,
            frame: 0,
            lateness: Lateness::new(),
            slack: Lateness::new(),
            overruns: 0,
            row: 0,
            longest_row: 0,
            first_overrun: None,
        }
    }

    /// Lets frame 0 be due now. Nothing may have been waited for.
    pub fn restart(&mut self) {
        self.start = now();
    }

    /// When the next frame is due. From the start and the number of the frame, so that nothing
    /// adds up.
    #[must_use]
    #[inline]
    pub fn deadline(&self) -> HostTime {
        self.start.after((self.frame + 1).saturating_mul(self.pacing.period_ns))
    }

    /// When frame 0 was due.
    #[must_use]
    pub fn started(&self) -> HostTime {
        self.start
    }

    /// Waits until the next frame is due, and returns the time at which it begins.
    #[inline]
    pub fn wait(&mut self) -> HostTime {
        let deadline = self.deadline();
        let before = now();
        let mut time = before;
        if before < deadline {
            self.slack.record(deadline.since(before));
            let sleep_to = HostTime { ns: deadline.ns.saturating_sub(self.pacing.spin_ns) };
            if before < sleep_to {
                sleep_until(sleep_to);
            }
            // Without spinning the clock has passed the deadline already, and this is one look.
            time = spin_until(deadline);
        } else {
            self.slack.record(0);
        }
        self.begin(time.since(deadline));
        time
    }

    /// Takes note of a frame that begins.
    #[inline]
    fn begin(&mut self, lateness_ns: u64) {
        self.frame += 1;
        self.lateness.record(lateness_ns);
        if lateness_ns > self.pacing.overrun_ns {
            self.overruns += 1;
            self.row += 1;
            self.longest_row = self.longest_row.max(self.row);
            self.first_overrun.get_or_insert(self.frame);
        } else {
            self.row = 0;
        }
    }

    /// Frames that have begun.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frame
    }

    /// Frames that began too late.
    #[must_use]
    pub fn overruns(&self) -> u64 {
        self.overruns
    }

    /// Lateness of all frames.
    #[must_use]
    pub fn lateness(&self) -> &Lateness {
        &self.lateness
    }

    /// What has been found so far.
    #[must_use]
    pub fn report(&self) -> Report {
        Report {
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

/// What a frame clock found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Frames that began.
    pub frames: u64,
    /// Period, µs.
    pub period_us: f64,
    /// Lateness from which on a frame is an overrun, µs.
    pub overrun_us: f64,
    /// Overruns.
    pub overruns: u64,
    /// Most overruns in a row.
    pub longest_row_of_overruns: u64,
    /// Number of the first frame that was one, from 1.
    pub first_overrun: Option<u64>,
    /// How late frames began.
    pub lateness: Figures,
    /// 99 % of the frames left at least so much of their period unused, µs.
    pub slack_p1_us: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    const PACING: Pacing = Pacing { period_ns: 1_000_000, spin_ns: 0, overrun_ns: 100_000 };

    #[test]
    fn no_frame_begins_before_it_is_due_and_nothing_adds_up() {
        let start = now().after(2_000_000);
        let mut clock = FrameClock::start_at(PACING, start);
        for frame in 1..=50u64 {
            assert_eq!(clock.deadline(), HostTime { ns: start.ns + frame * 1_000_000 });
            assert!(clock.wait() >= HostTime { ns: start.ns + frame * 1_000_000 });
        }
        let report = clock.report();
        assert_eq!((report.frames, report.lateness.count), (50, 50));
    }

    #[test]
    fn spinning_is_not_early_either() {
        let mut clock = FrameClock::start(Pacing { spin_ns: 300_000, ..PACING });
        for _ in 0..20 {
            let deadline = clock.deadline();
            assert!(clock.wait() >= deadline);
        }
        // All of the wait spent at the clock.
        let mut clock = FrameClock::start(Pacing { spin_ns: u64::MAX, ..PACING });
        let deadline = clock.deadline();
        assert!(clock.wait() >= deadline);
    }

    #[test]
    fn late_frames_are_counted_and_caught_up_without_a_wait() {
        // Ten periods ago: the first ten frames are due already.
        let start = HostTime { ns: now().ns - 10_500_000 };
        let mut clock = FrameClock::start_at(PACING, start);
        let first = clock.wait();
        assert!(first.since(start) >= 10_500_000);
        for _ in 0..9 {
            clock.wait();
        }
        let report = clock.report();
        assert_eq!(report.first_overrun, Some(1));
        assert!(report.overruns >= 10, "{report:?}");
        assert!(report.longest_row_of_overruns >= 10);
        assert!(report.lateness.max_us >= 9500.0, "{report:?}");
        assert_eq!(report.slack_p1_us, 0.0);
    }

    #[test]
    fn lateness_up_to_the_limit_is_no_overrun_and_ends_a_row() {
        let mut clock = FrameClock::start(PACING);
        for lateness_ns in [100_000, 100_001, 200_000, 5, 100_001] {
            clock.begin(lateness_ns);
        }
        let report = clock.report();
        assert_eq!((report.overruns, report.longest_row_of_overruns), (3, 2));
        assert_eq!(report.first_overrun, Some(2));
    }

    #[test]
    fn a_period_of_nothing_and_an_end_of_time_are_borne() {
        let mut clock = FrameClock::start(Pacing { period_ns: 0, ..PACING });
        clock.wait();
        let clock = FrameClock::start_at(
            Pacing { period_ns: u64::MAX, ..PACING },
            HostTime { ns: u64::MAX - 5 },
        );
        assert_eq!(clock.deadline().ns, u64::MAX);
    }
}
