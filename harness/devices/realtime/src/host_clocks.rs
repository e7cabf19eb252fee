//! The host's realtime clock, or another one, against its monotonic one.
//!
//! The kernel stamps pulses and arrivals by the realtime clock. Samples are dated by the monotonic one,
//! which nobody sets. Both run at the same rate; they move against each other only when the realtime
//! clock is set (a step). So a pair of readings converts times until the next step, and two pairs with
//! another difference show that there was one.

use std::convert::Infallible;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Readings of which the closest pair is taken: an interruption between two of them widens its bound.
const TRIES: usize = 5;
/// Difference of two pairs, beyond their bounds, from which the realtime clock was set.
const STEP_LEAST: Duration = Duration::from_micros(1);

/// A reading of two clocks at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostClocks {
    /// Monotonic clock.
    pub monotonic: Instant,
    /// The other clock, ns: the realtime one, since 1970, unless another one was read.
    pub other_ns: i128,
    /// Bound of the time between both readings.
    pub within: Duration,
}

/// Time of the realtime clock since 1970, ns.
#[must_use]
pub fn since_1970_ns(time: SystemTime) -> i128 {
    match time.duration_since(UNIX_EPOCH) {
        Ok(since) => since.as_nanos() as i128,
        Err(before) => -(before.duration().as_nanos() as i128),
    }
}

impl HostClocks {
    /// Reads both clocks: the realtime one between two readings of the monotonic one.
    #[must_use]
    pub fn read() -> Self {
        let Ok(clocks) = Self::read_with(|| Ok::<_, Infallible>(since_1970_ns(SystemTime::now())));
        clocks
    }

    /// Reads another clock between two readings of the monotonic one, five times, and takes the
    /// reading with the least bound.
    ///
    /// # Errors
    /// If the clock can't be read.
    pub fn read_with<E>(mut other_ns: impl FnMut() -> Result<i128, E>) -> Result<Self, E> {
        let mut one = || {
            let before = Instant::now();
            let other_ns = other_ns()?;
            let half = before.elapsed() / 2;
            // Half of an odd number of nanoseconds is rounded down.
            let within = half + Duration::from_nanos(1);
            Ok(Self { monotonic: before + half, other_ns, within })
        };
        let mut best = one()?;
        for _ in 1..TRIES {
            let next = one()?;
            if next.within < best.within {
                best = next;
            }
        }
        Ok(best)
    }

    /// Monotonic time of a time of the other clock, as it is set at present.
    #[must_use]
    pub fn at(&self, other_ns: i128) -> Option<Instant> {
        let since_ns = other_ns - self.other_ns;
        let since = Duration::from_nanos(u64::try_from(since_ns.unsigned_abs()).ok()?);
        if since_ns < 0 {
            self.monotonic.checked_sub(since)
        } else {
            self.monotonic.checked_add(since)
        }
    }

    /// Time by which the realtime clock was set forward since an earlier pair, ns; negative: back.
    /// `None`: it wasn't set by more than the bounds of the two pairs.
    #[must_use]
    pub fn step_since_ns(&self, earlier: &Self) -> Option<i128> {
        let elapsed_ns = match self.monotonic.checked_duration_since(earlier.monotonic) {
            Some(elapsed) => elapsed.as_nanos() as i128,
            None => -((earlier.monotonic - self.monotonic).as_nanos() as i128),
        };
        let step_ns = self.other_ns - earlier.other_ns - elapsed_ns;
        let limit = self.within + earlier.within + STEP_LEAST;
        (step_ns.unsigned_abs() > limit.as_nanos()).then_some(step_ns)
    }
}
