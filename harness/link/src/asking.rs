//! After how long what wasn't answered is asked for again.
//!
//! A question that is lost has to come again soon. One that isn't lost but late, of a device that is
//! slow, on a host that is busy, lies on the line beside the repeated one, and both are answered: asked
//! again always as soon, such a device gets further behind with each step until no answer comes in time.
//! So each time it takes longer until it is asked again, and a device that was late each of the last
//! steps is given twice the time that it took.

use std::time::Duration;

/// Steps of which the fastest tells how slow a device is: of so many one got through at once, however
/// bad the line is.
const STEPS: usize = 4;

/// The least number of times that something is asked for before it is given up.
const TIMES: u32 = 16;

/// No line is so slow that more of them helps.
const LONGEST: Duration = Duration::from_secs(2);

/// How long the last answers took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Taken {
    last: [Duration; STEPS],
    next: usize,
}

impl Taken {
    /// An answer came.
    pub(crate) fn add(&mut self, took: Duration) {
        self.last[self.next] = took;
        self.next = (self.next + 1) % STEPS;
    }

    /// How the next one is asked for: after `repeat` or later, and given up after `answer`.
    pub(crate) fn ask(&self, repeat: Duration, answer: Duration) -> Intervals {
        let fastest = self.last.iter().min().copied().unwrap_or_default();
        // Some times there have to be, whatever was before.
        let first = (2 * fastest).min(answer / 4).max(repeat);
        Intervals { now: first, longest: (answer / TIMES).min(LONGEST).max(first) }
    }
}

/// Times from one question to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Intervals {
    now: Duration,
    longest: Duration,
}

impl Intervals {
    /// After this long it is asked again.
    pub(crate) fn now(&self) -> Duration {
        self.now
    }

    /// It was asked again.
    pub(crate) fn again(&mut self) {
        self.now = (2 * self.now).min(self.longest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPEAT: Duration = Duration::from_millis(200);

    /// What a step takes of a device that works on each question for so long, the ones before it first;
    /// and how many of its questions lie on the line when it is answered. `None`: it is given up.
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

    /// The longest that one of many steps took.
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
        // With what is waited by default.
        for works_ms in [100, 201, 300, 400] {
            let works = Duration::from_millis(works_ms);
            assert!(slowest(works, Duration::from_secs(5)).is_some(), "{works:?}");
        }
    }

    #[test]
    fn a_lossy_line_is_asked_as_often_as_ever() {
        let answer = Duration::from_secs(5);
        let mut taken = Taken::default();
        // Three of four got lost: the fourth tells that the device is fast.
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
        // Longer than all that is computed.
        let repeat = Duration::from_secs(7);
        let mut intervals = Taken::default().ask(repeat, Duration::from_secs(5));
        assert_eq!(intervals.now(), repeat);
        intervals.again();
        assert_eq!(intervals.now(), repeat);
    }
}
