//! Intervals at which an unanswered request is sent again.
//!
//! A lost request must be repeated soon. A request that is only late, because the device is slow or the
//! host busy, stays queued beside its repetition, and both are answered. Repeated at a constant
//! interval, a slow device would fall further behind with each step until no answer came in time. So
//! the interval doubles with each repetition, and a device that was late in all of the last steps gets
//! twice the time that its fastest answer took.

use std::time::Duration;

/// Number of steps whose fastest answer is taken as the speed of the device: even on a bad line, one of
/// so many gets through without loss.
const STEPS: usize = 4;

/// Least number of times that a request is sent before the harness gives up.
pub const TIMES: u32 = 16;

/// Longest interval: no line is so slow that a longer one helps.
const LONGEST: Duration = Duration::from_secs(2);

/// Durations of the last answers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Taken {
    last: [Duration; STEPS],
    next: usize,
}

impl Taken {
    /// Records the duration of an answer.
    pub fn add(&mut self, took: Duration) {
        self.last[self.next] = took;
        self.next = (self.next + 1) % STEPS;
    }

    /// Intervals for the next request: the first is `repeat` or longer, and the harness gives up after
    /// `answer`.
    #[must_use]
    pub fn ask(&self, repeat: Duration, answer: Duration) -> Intervals {
        let fastest = self.last.iter().min().copied().unwrap_or_default();
        // The bound `answer / 4` leaves room for some repetitions, however slow the last steps were.
        let first = (2 * fastest).min(answer / 4).max(repeat);
        Intervals { now: first, longest: (answer / TIMES).min(LONGEST).max(first) }
    }
}

/// Times from one request to its repetition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Intervals {
    now: Duration,
    longest: Duration,
}

impl Intervals {
    /// Time until the request is repeated.
    #[must_use]
    pub fn now(&self) -> Duration {
        self.now
    }

    /// Records a repetition, which doubles the interval.
    pub fn again(&mut self) {
        self.now = (2 * self.now).min(self.longest);
    }
}
