//! Progress of many cases: rate, time left, slow cases.

use octant::case_progress::{CaseProgress, duration};
use std::time::{Duration, Instant};

/// Runs cases in pairs, each `took_s` long, until `ended` have ended; returns the time.
fn pairs(progress: &mut CaseProgress, begun: Instant, took_s: u64, ended: usize) -> Instant {
    let mut now = begun;
    for pair in 0..ended / 2 {
        for case in [2 * pair, 2 * pair + 1] {
            progress.begun(case, now);
        }
        now += Duration::from_secs(took_s);
        progress.ended(Some(2 * pair), false, now);
        progress.ended(Some(2 * pair + 1), false, now);
    }
    now
}

#[test]
fn the_time_left_is_right_from_the_first_case_on() {
    let begun = Instant::now();
    let mut progress = CaseProgress::new("", 10, 2, false, begun);
    progress.begun(0, begun);
    progress.begun(1, begun);
    assert_eq!(progress.words(begun + Duration::from_secs(3)), "0 of 10 cases, time left unknown");
    let now = begun + Duration::from_secs(6);
    progress.ended(Some(0), false, now);
    // Eight wait, and one is about to end: 8 x 6 s on two processors.
    assert_eq!(progress.left_s(now), Some(24.0));
    assert_eq!(progress.words(now), "1 of 10 cases, 10.0 per minute, 24 s left");
}

#[test]
fn results_from_before_are_no_speed() {
    let begun = Instant::now();
    let mut progress = CaseProgress::new("", 1000, 2, true, begun);
    progress.there(990);
    assert_eq!(progress.words(begun), "990 of 1000 cases, time left unknown");
    let now = pairs(&mut progress, begun, 100, 2);
    assert_eq!(progress.words(now), "992 of 1000 cases, 1.2 per minute, at most 7 min left");
}

#[test]
fn the_last_case_is_not_promised_for_now() {
    let begun = Instant::now();
    let mut progress = CaseProgress::new("night", 5, 2, false, begun);
    let now = pairs(&mut progress, begun, 10, 4);
    progress.begun(4, now);
    assert_eq!(progress.left_s(now + Duration::from_secs(4)), Some(6.0));
    let late = now + Duration::from_secs(15);
    assert_eq!(progress.words(late), "night: 4 of 5 cases, 6.9 per minute, time left unknown");
    assert!(progress.slow(late).is_empty());
    let slow = now + Duration::from_secs(41);
    assert_eq!(progress.slow(slow), [(4, 41.0)]);
    assert!(progress.slow(slow).is_empty(), "told once");
    progress.ended(Some(4), true, slow);
    assert_eq!(progress.words(slow), "night: 5 of 5 cases, 1 failed");
}

#[test]
fn times_are_rounded_up() {
    let words = [0.0, 0.2, 59.1, 99.0, 99.5, 120.0, 5940.0, 5941.0, 86_400.0].map(duration);
    let expected =
        ["1 s", "1 s", "60 s", "99 s", "2 min", "2 min", "99 min", "1 h 40 min", "24 h 00 min"];
    assert_eq!(words, expected);
}
