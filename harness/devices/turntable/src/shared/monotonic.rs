//! Times for other processes of the same host.

use rustix::time::{ClockId, clock_gettime};
use std::time::{Duration, Instant};

/// Attempts to read both clocks with little between them.
const ATTEMPTS: usize = 16;

/// Relation of [`Instant`] to the host's monotonic time, which all its processes share. Both are the same clock on
/// Linux, so that the relation holds for as long as the program runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Monotonic {
    at: Instant,
    ns: u64,
}

impl Monotonic {
    /// Reads both clocks, several times; of these the pair with the least time between counts.
    pub(super) fn now() -> Self {
        let read = || {
            let before = Instant::now();
            let time = clock_gettime(ClockId::Monotonic);
            let between = before.elapsed();
            let ns = time.tv_sec.unsigned_abs() * 1_000_000_000 + time.tv_nsec.unsigned_abs();
            (between, Self { at: before + between / 2, ns })
        };
        let first = read();
        let nearest = |best: (Duration, Self), next: (Duration, Self)| {
            if next.0 < best.0 { next } else { best }
        };
        (1..ATTEMPTS).map(|_| read()).fold(first, nearest).1
    }

    /// Monotonic time of an instant, ns.
    pub(super) fn of(&self, when: Instant) -> Option<u64> {
        let after = when.saturating_duration_since(self.at).as_nanos() as u64;
        let before = self.at.saturating_duration_since(when).as_nanos() as u64;
        (self.ns + after).checked_sub(before)
    }

    /// Instant of a monotonic time, ns; `None` if it is beyond what an instant can hold.
    pub(super) fn at(&self, ns: u64) -> Option<Instant> {
        if ns >= self.ns {
            self.at.checked_add(Duration::from_nanos(ns - self.ns))
        } else {
            self.at.checked_sub(Duration::from_nanos(self.ns - ns))
        }
    }
}
