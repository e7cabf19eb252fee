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
const TIMES: u32 = 16;

/// Longest interval: no line is so slow that a longer one helps.
const LONGEST: Duration = Duration::from_secs(2);

/// Durations of the last answers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Taken {
    last: [Duration; STEPS],
    next: usize,
}

impl Taken {
    /// Records the duration of an answer.
    pub(crate) fn add(&mut self, took: Duration) {
        self.last[self.next] = took;
        self.next = (self.next + 1) % STEPS;
    }

    /// Intervals for the next request: the first is `repeat` or longer, and the harness gives up after
    /// `answer`.
    pub(crate) fn ask(&self, repeat: Duration, answer: Duration) -> Intervals {
        let fastest = self.last.iter().min().copied().unwrap_or_default();
        // The bound `answer / 4` leaves room for some repetitions, however slow the last steps were.
        let first = (2 * fastest).min(answer / 4).max(repeat);
        Intervals { now: first, longest: (answer / TIMES).min(LONGEST).max(first) }
    }
}

/// Times from one request to its repetition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Intervals {
    now: Duration,
    longest: Duration,
}

impl Intervals {
    /// Time until the request is repeated.
    pub(crate) fn now(&self) -> Duration {
        self.now
    }

    /// Records a repetition, which doubles the interval.
    pub(crate) fn again(&mut self) {
        self.now = (2 * self.now).min(self.longest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPEAT: Duration = Duration::from_millis(200);

    /// Duration of a step on a device that works for `works` on each request, `before` earlier ones
    /// first, and the number of requests still queued when the step is answered. `None`: the harness
    /// gives up.
    fn step(
        mut intervals: Intervals,
        works: Duration,
        before: u32,
        answer: Duration,
    ) -> Option<(Duration, u32)> {
        let took = works * (before + 1);
        let (mut at, mut asked) = (Duration::ZERO, 1);
        while at + intervals.now() < took {
            at += intervals.now();
            intervals.again();
            asked += 1;
        }
        (took < answer).then_some((took, asked - 1))
    }

    /// Longest duration among 100 steps.
    fn slowest(works: Duration, answer: Duration) -> Option<Duration> {
        let (mut taken, mut before, mut slowest) = (Taken::default(), 0, Duration::ZERO);
        for k in 0..100 {
            let (took, left) = step(taken.ask(REPEAT, answer), works, before, answer)?;
            taken.add(took);
            (before, slowest) = (left, slowest.max(took));
            assert!(k < 20 || left == 0, "{works:?}: asked {left} times too often in step {k}");
        }
        Some(slowest)
    }

    #[test]
    fn a_slow_device_is_not_asked_faster_than_it_answers() {
        let answer = Duration::from_secs(30);
        for works_ms in [100, 199, 201, 300, 500, 800, 1000, 1500, 2000] {
            let works = Duration::from_millis(works_ms);
            let slowest = slowest(works, answer);
            assert!(slowest.is_some_and(|slowest| slowest < answer), "{works:?}: {slowest:?}");
        }
        // Uses the default patience.
        for works_ms in [100, 201, 300, 400] {
            let works = Duration::from_millis(works_ms);
            assert!(slowest(works, Duration::from_secs(5)).is_some(), "{works:?}");
        }
    }

    #[test]
    fn a_lossy_line_is_asked_as_often_as_ever() {
        let answer = Duration::from_secs(5);
        let mut taken = Taken::default();
        // Three of four answers are delayed by loss: the fourth shows that the device is fast.
        for took_ms in [900, 5, 700, 600, 1100, 6, 800] {
            taken.add(Duration::from_millis(took_ms));
            let mut intervals = taken.ask(REPEAT, answer);
            assert_eq!(intervals.now(), REPEAT);
            let (mut at, mut asked) = (Duration::ZERO, 1);
            while at + intervals.now() < answer {
                at += intervals.now();
                intervals.again();
                asked += 1;
            }
            assert!(asked >= TIMES, "asked {asked} times");
        }
    }

    #[test]
    fn what_is_told_is_kept() {
        // The configured interval is longer than any computed one.
        let repeat = Duration::from_secs(7);
        let mut intervals = Taken::default().ask(repeat, Duration::from_secs(5));
        assert_eq!(intervals.now(), repeat);
        intervals.again();
        assert_eq!(intervals.now(), repeat);
    }
}
