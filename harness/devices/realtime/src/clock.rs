//! The host's monotonic clock.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Time of the host's monotonic clock, ns. Device time and simulated time have types of their own, so
/// that they can't be mixed with it.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct MonotonicTime {
    /// Time since a start that is arbitrary for each boot of the host, ns.
    pub ns: u64,
}

impl MonotonicTime {
    /// Adds a duration; the result stays at the end of time, which is 584 years after a boot.
    #[must_use]
    pub const fn after(self, duration_ns: u64) -> Self {
        Self { ns: self.ns.saturating_add(duration_ns) }
    }

    /// Time by which this is later than another time, ns; 0 if it isn't later.
    #[must_use]
    pub const fn since(self, earlier: Self) -> u64 {
        self.ns.saturating_sub(earlier.ns)
    }
}

#[cfg(target_os = "linux")]
mod system {
    use super::MonotonicTime;
    use rustix::thread::clock_nanosleep_absolute;
    use rustix::time::{ClockId, Timespec, clock_getres, clock_gettime};

    pub(super) fn now() -> MonotonicTime {
        let Timespec { tv_sec, tv_nsec } = clock_gettime(ClockId::Monotonic);
        MonotonicTime { ns: tv_sec as u64 * 1_000_000_000 + tv_nsec as u64 }
    }

    pub(super) fn sleep_until(deadline: MonotonicTime) {
        let at = Timespec {
            tv_sec: (deadline.ns / 1_000_000_000) as i64,
            tv_nsec: (deadline.ns % 1_000_000_000) as i64,
        };
        // A signal ends the sleep early: sleep again until the same deadline.
        while clock_nanosleep_absolute(ClockId::Monotonic, &at) == Err(rustix::io::Errno::INTR) {}
    }

    pub(super) fn resolution_ns() -> u64 {
        let Timespec { tv_sec, tv_nsec } = clock_getres(ClockId::Monotonic);
        tv_sec as u64 * 1_000_000_000 + tv_nsec as u64
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use super::MonotonicTime;
    use std::sync::OnceLock;
    use std::time::{Duration, Instant};

    pub(super) fn now() -> MonotonicTime {
        static START: OnceLock<Instant> = OnceLock::new();
        // Times start at 1 s, so that a deadline may lie before the first reading of the clock.
        let since = START.get_or_init(Instant::now).elapsed() + Duration::from_secs(1);
        MonotonicTime { ns: u64::try_from(since.as_nanos()).unwrap_or(u64::MAX) }
    }

    pub(super) fn sleep_until(deadline: MonotonicTime) {
        let wait_ns = deadline.since(now());
        if wait_ns > 0 {
            std::thread::sleep(Duration::from_nanos(wait_ns));
        }
    }

    pub(super) fn resolution_ns() -> u64 {
        // The system doesn't report the resolution: take the least difference of two readings.
        let start = now();
        loop {
            let later = now().since(start);
            if later > 0 {
                return later;
            }
        }
    }
}

/// Present time.
#[must_use]
#[inline]
pub fn now() -> MonotonicTime {
    system::now()
}

/// Sleeps until a deadline; returns at once if it has passed. On Linux the kernel takes the absolute
/// deadline too, so that a delay between reading the clock and sleeping costs nothing.
#[inline]
pub fn sleep_until(deadline: MonotonicTime) {
    system::sleep_until(deadline);
}

/// Resolution of the clock, ns.
#[must_use]
pub fn resolution_ns() -> u64 {
    system::resolution_ns()
}

/// Reads the clock in a loop until a deadline has passed; returns the time of the last reading.
/// Occupies the processor all that time.
#[inline]
pub fn spin_until(deadline: MonotonicTime) -> MonotonicTime {
    loop {
        let time = now();
        if time >= deadline {
            return time;
        }
        std::hint::spin_loop();
    }
}

/// Converts a duration to ns, at most the largest of 64 bits.
#[must_use]
pub fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
