//! Time for which an end waits for the other one.

use std::time::{Duration, Instant};

/// How much longer than asked for a wait may take on a busy host.
const LATE: Duration = Duration::from_millis(100);

/// Sum of waits, without the time in which this process was stopped or the host asleep: a wait that took much longer
/// than it was to take counts as long as it was to take. Both ends can be stopped together, as with a debugger or a host that
/// is suspended, and none of them was silent then.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Waited {
    total: Duration,
    until_heard: Duration,
}

impl Waited {
    /// Adds a wait that began at this time and was to take no longer than `wait`.
    pub(crate) fn add(&mut self, begun: Instant, wait: Duration) {
        let took = begun.elapsed();
        self.total += if took > wait.saturating_add(LATE) { wait } else { took };
    }

    /// Notes that an intact message came.
    pub(crate) fn heard(&mut self) {
        self.until_heard = self.total;
    }

    /// Wait since the last intact message.
    pub(crate) fn silence(&self) -> Duration {
        self.total.saturating_sub(self.until_heard)
    }

    /// Wait for the port, all in all.
    pub(crate) fn total(&self) -> Duration {
        self.total
    }
}
