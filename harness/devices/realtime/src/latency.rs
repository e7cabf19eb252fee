//! Wake-up latency of this host: a short measurement, where cyclictest makes a long one.

use crate::clock::{MonotonicTime, now};
use crate::pace::{FrameClock, FramePacing, PaceReport};
use crate::schedule::{Granted, Wish, apply};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Settings of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trial {
    /// Period, ns.
    pub period_ns: u64,
    /// Total duration.
    pub duration: Duration,
    /// Last part of each wait that is spent reading the clock, ns.
    pub spin_ns: u64,
    /// Scheduling that the thread requests.
    pub wish: Wish,
}

/// Result of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LatencyResult {
    /// Scheduling that the thread was granted.
    pub granted: Granted,
    /// Lateness of the wake-ups. Overruns are later than a tenth of the period.
    pub report: PaceReport,
}

/// Measures on a separate thread.
///
/// # Errors
/// If the system can't start a thread.
pub fn measure(trial: Trial) -> std::io::Result<LatencyResult> {
    let thread = std::thread::Builder::new().name("latency".into()).spawn(move || {
        let granted = apply(&trial.wish);
        // Spinning without a real-time priority is worse than sleeping, and no run would do it.
        let spin_ns = if granted.is_realtime() { trial.spin_ns } else { 0 };
        let period_ns = trial.period_ns.max(1);
        let pacing = FramePacing { period_ns, spin_ns, overrun_ns: period_ns / 10 };
        let end: MonotonicTime = now().after(crate::clock::nanoseconds(trial.duration));
        let mut clock = FrameClock::start(pacing);
        while clock.deadline() <= end {
            clock.wait();
        }
        LatencyResult { granted, report: clock.report() }
    })?;
    thread.join().map_err(|_| std::io::Error::other("the measuring thread panicked"))
}
