//! Clock of a run whose unit sends on: that of the host, or in a rehearsal that of the unit's own TAG blocks.

use octant_trajectory::tag_time_ns;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Difference between the host's two clocks that shows that one was set.
const SET: Duration = Duration::from_secs(1);
/// Longest line whose TAG block is read, bytes.
const LINE_BYTES_MAX: usize = 4096;

/// Clock of a run.
#[derive(Debug)]
pub(super) enum BenchClock {
    /// The host's.
    Host {
        /// Time at which it was begun, by the clock that nobody sets and by the one of the stamps.
        begun: (Instant, SystemTime),
    },
    /// Time of the last TAG block that came.
    Line {
        /// The line that is incomplete.
        line: Vec<u8>,
        now: Option<SystemTime>,
    },
}

impl BenchClock {
    pub(super) fn host() -> Self {
        Self::Host { begun: (Instant::now(), SystemTime::now()) }
    }

    pub(super) fn line() -> Self {
        Self::Line { line: Vec::new(), now: None }
    }

    /// Takes what came.
    pub(super) fn take(&mut self, came: &[u8]) {
        let Self::Line { line, now } = self else { return };
        for part in came.split_inclusive(|byte| *byte == b'\n') {
            line.extend_from_slice(part);
            if !part.ends_with(b"\n") && line.len() < LINE_BYTES_MAX {
                return;
            }
            let time_ns = tag_time_ns(&String::from_utf8_lossy(line));
            let time = time_ns.and_then(|ns| u64::try_from(ns).ok());
            let time = time.map(|ns| UNIX_EPOCH + Duration::from_nanos(ns));
            // A clock that is set back stands until it has come so far again.
            *now = (*now).max(time);
            line.clear();
        }
    }

    /// The present time by the clock of the stamps; `None`: nothing has told it yet.
    pub(super) fn now(&self) -> Option<SystemTime> {
        match self {
            Self::Host { begun } => Some(begun.1 + begun.0.elapsed()),
            Self::Line { now, .. } => *now,
        }
    }

    /// How far the clock of the stamps was set while the run went, s; `None`: it wasn't.
    pub(super) fn set_s(&self) -> Option<f64> {
        let Self::Host { begun } = self else { return None };
        let (steady, stamps) = (begun.1 + begun.0.elapsed(), SystemTime::now());
        let [ahead, back] = [stamps.duration_since(steady), steady.duration_since(stamps)];
        let off_s = ahead.map_or_else(
            |_| -back.as_ref().map_or(0.0, Duration::as_secs_f64),
            |ahead| ahead.as_secs_f64(),
        );
        (off_s.abs() > SET.as_secs_f64()).then_some(off_s)
    }
}
