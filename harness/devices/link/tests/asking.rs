//! Intervals at which an unanswered request is sent again.

use octant_link::asking::{Intervals, TIMES, Taken};
use std::time::Duration;

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
