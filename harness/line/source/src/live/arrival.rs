//! Time of arrival of a reading.

use octant_realtime::host_clocks::{HostClocks, since_1970_ns};
use std::time::{Duration, Instant, SystemTime};

/// Oldest stamp of the kernel that is believed: data doesn't wait longer for a run that takes it.
const WAITED_MOST: Duration = Duration::from_secs(60);

/// Time at which data arrived.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    pub(super) at: Instant,
    /// Bound of the conversion of the kernel's stamp; `None`: the time is that of the read's return.
    pub(super) by_kernel: Option<Duration>,
}

impl Arrival {
    /// Arrival at the return of a read.
    pub(super) fn read(at: Instant) -> Self {
        Self { at, by_kernel: None }
    }
}

/// Converts the kernel's stamps of arrivals to the monotonic clock.
#[derive(Debug, Default)]
pub(super) struct ArrivalClock {
    last: Option<HostClocks>,
}

impl ArrivalClock {
    /// Time of an arrival with a stamp of the realtime clock. About a step of that clock it is the time
    /// of the read's return.
    pub(super) fn arrival(&mut self, stamp: Option<SystemTime>) -> Arrival {
        let Some(stamp) = stamp else { return Arrival::read(Instant::now()) };
        let clocks = HostClocks::read();
        let stepped = self.last.is_some_and(|last| clocks.step_since_ns(&last).is_some());
        self.last = Some(clocks);
        let at = clocks.at(since_1970_ns(stamp)).filter(|at| {
            *at <= clocks.monotonic + clocks.within && *at + WAITED_MOST >= clocks.monotonic
        });
        match at {
            Some(at) if !stepped => Arrival { at, by_kernel: Some(clocks.within) },
            _ => Arrival::read(clocks.monotonic),
        }
    }
}
