//! The host's monotonic clock.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// A time of the host's monotonic clock, ns. Not device time, not simulated time: they have types
/// of their own and don't mix with it.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct HostTime {
    /// Since a start that only this boot of the host knows, ns.
    pub ns: u64,
}

impl HostTime {
    /// A duration later; at the end of time, which is 584 years after a boot, it stays there.
    #[must_use]
    pub const fn after(self, duration_ns: u64) -> Self {
        Self { ns: self.ns.saturating_add(duration_ns) }
    }

    /// How much later than another time, ns; 0 where it isn't.
    #[must_use]
    pub const fn since(self, earlier: Self) -> u64 {
        self.ns.saturating_sub(earlier.ns)
    }
}

#[cfg(target_os = "linux")]
mod system {
    use super::HostTime;
    use rustix::thread::clock_nanosleep_absolute;
    use rustix::time::{ClockId, Timespec, clock_getres, clock_gettime};

    pub(super) fn now() -> HostTime {
        let Timespec { tv_sec, tv_nsec } = clock_gettime(ClockId::Monotonic);
        HostTime { ns: tv_sec as u64 * 1_000_000_000 + tv_nsec as u64 }
    }

    pub(super) fn sleep_until(deadline: HostTime) {
        let at = Timespec {
            tv_sec: (deadline.ns / 1_000_000_000) as i64,
            tv_nsec: (deadline.ns % 1_000_000_000) as i64,
        };
        // A signal wakes it early: it goes to sleep again for the same deadline.
        while clock_nanosleep_absolute(ClockId::Monotonic, &at) == Err(rustix::io::Errno::INTR) {}
    }

    pub(super) fn resolution_ns() -> u64 {
        let Timespec { tv_sec, tv_nsec } = clock_getres(ClockId::Monotonic);
        tv_sec as u64 * 1_000_000_000 + tv_nsec as u64
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use super::HostTime;
    use std::sync::OnceLock;
    use std::time::{Duration, Instant};

    pub(super) fn now() -> HostTime {
        static START: OnceLock<Instant> = OnceLock::new();
        // From 1 s on, so that a deadline may lie before the first look at the clock.
        let since = START.get_or_init(Instant::now).elapsed() + Duration::from_secs(1);
        HostTime { ns: u64::try_from(since.as_nanos()).unwrap_or(u64::MAX) }
    }

    pub(super) fn sleep_until(deadline: HostTime) {
        let wait_ns = deadline.since(now());
        if wait_ns > 0 {
            std::thread::sleep(Duration::from_nanos(wait_ns));
        }
    }

    pub(super) fn resolution_ns() -> u64 {
        // Not told by the system; what two looks at the clock differ by at least.
        let start = now();
        loop {
            let later = now().since(start);
            if later > 0 {
                return later;
            }
        }
    }
}

/// The time now.
#[must_use]
#[inline]
pub fn now() -> HostTime {
    system::now()
}

/// Sleeps until a deadline; returns at once where it has passed. On Linux the deadline is absolute
/// in the kernel too, so that what happens between a look at the clock and the sleep costs nothing.
#[inline]
pub fn sleep_until(deadline: HostTime) {
    system::sleep_until(deadline);
}

/// Resolution of the clock, ns.
#[must_use]
pub fn resolution_ns() -> u64 {
    system::resolution_ns()
}

/// Looks at the clock until a deadline has passed; returns the time then. Takes the processor for
/// all of that time.
#[inline]
pub fn spin_until(deadline: HostTime) -> HostTime {
    loop {
        let time = now();
        if time >= deadline {
            return time;
        }
        std::hint::spin_loop();
    }
}

/// A duration in ns, at most what 64 bits hold.
#[must_use]
pub fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
