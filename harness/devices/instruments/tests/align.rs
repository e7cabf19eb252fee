//! Alignment of an instrument's clock with the host's.

use octant_instruments::align::{CORNERS, ClockAlignment, UnitClockEstimate};

const OFFSET_NS: i64 = 7_000_000_123;
const LEAST_NS: i64 = 850_000;

/// Aligns readings at 200 Hz of a clock that is slow by `skew`, with `delay` beyond the least one.
fn align(skew: f64, seconds: u64, delay: impl Fn(u64) -> i64) -> ClockAlignment {
    let mut alignment = ClockAlignment::new();
    for number in 0..seconds * 200 {
        let stamp = 1_000_000_000 + number * 5_000_000;
        let drift = (skew * (number * 5_000_000) as f64) as i64;
        let arrival = stamp as i64 + OFFSET_NS + drift + LEAST_NS + delay(number);
        alignment.add(stamp, arrival as u64);
    }
    alignment
}

fn check(estimate: UnitClockEstimate, skew: f64, offset_within_ns: f64, skew_within: f64) {
    let expected = (1_000_000_000 + OFFSET_NS + LEAST_NS) as f64;
    let off = estimate.offset_ns - expected;
    assert!(off.abs() <= offset_within_ns, "offset off by {off} ns");
    let off = estimate.skew.unwrap() - skew;
    assert!(off.abs() <= skew_within, "skew off by {off}");
}

#[test]
fn without_jitter_it_is_the_line_itself() {
    for skew in [0.0, 25e-6, -100e-6] {
        // Nanoseconds are truncated: the error is a nanosecond over the span.
        let estimate = align(skew, 600, |_| 0).estimate().unwrap();
        check(estimate, skew, 2.0, 2e-9 / 100.0);
        let stamp = 1_000_000_000 + 500_000_000_000;
        let host = estimate.host_ns(stamp);
        let expected = stamp as f64 * 1.0 + (OFFSET_NS + LEAST_NS) as f64 + skew * 500e9;
        assert!((host - expected).abs() < 10.0, "{host} {expected}");
    }
}

/// One reading in seven has the least delay, the others up to 30 ms more, and for one second every
/// reading is late by 100 ms: the line stays the same.
#[test]
fn what_is_late_does_not_move_it() {
    let late = |number: u64| {
        let jitter = (number.wrapping_mul(2_654_435_761) >> 7) % 30_000_000;
        let stalled = (20_000..20_200).contains(&number);
        match (stalled, number % 7) {
            (true, _) => 100_000_000,
            (_, 0) => 0,
            _ => jitter as i64,
        }
    };
    let estimate = align(40e-6, 300, late).estimate().unwrap();
    check(estimate, 40e-6, 2.0, 1e-10);
    assert_eq!((estimate.readings, estimate.behind), (60_000, 0));
    assert!((estimate.span_s - 299.995).abs() < 1e-9);
}

/// The delay is up to a millisecond, and the least of many is small. The line stays below all
/// points, also if the clock isn't steady and there are more corners than are kept.
#[test]
fn it_is_below_all_points() {
    let jitter = |number: u64| ((number.wrapping_mul(2_654_435_761) >> 9) % 1_000_000) as i64;
    let alignment = align(-10e-6, 120, jitter);
    let estimate = alignment.estimate().unwrap();
    check(estimate, -10e-6, 20_000.0, 2e-7);
    for number in 0..24_000u64 {
        let stamp = 1_000_000_000 + number * 5_000_000;
        let drift = (-10e-6 * (number * 5_000_000) as f64) as i64;
        let arrival = stamp as i64 + OFFSET_NS + drift + LEAST_NS + jitter(number);
        assert!(estimate.host_ns(stamp) <= arrival as f64 + 1.0);
    }
}

/// One reading in three has no delay, one is a millisecond late and one two milliseconds.
#[test]
fn it_says_how_late_readings_come() {
    let late = |number: u64| [0, 1_000_000, 2_000_000][(number % 3) as usize];
    let estimate = align(30e-6, 600, late).estimate().unwrap();
    assert!((estimate.late_mean_ns - 1e6).abs() < 10.0, "{estimate:?}");
    let sigma = libm::sqrt(2.0 / 3.0) * 1e6;
    assert!((estimate.late_sigma_ns - sigma).abs() < 1e3, "{estimate:?}");
    let estimate = align(30e-6, 600, |_| 0).estimate().unwrap();
    assert!(estimate.late_mean_ns.abs() < 2.0 && estimate.late_sigma_ns < 1e3, "{estimate:?}");
}

#[test]
fn at_the_beginning_there_is_an_offset_alone() {
    let mut alignment = ClockAlignment::new();
    assert_eq!(alignment.estimate(), None);
    alignment.add(5_000, 9_000);
    let estimate = alignment.estimate().unwrap();
    assert_eq!((estimate.offset_ns, estimate.skew), (9_000.0, None));
    // A second reading gives a skew: 2 µs less, a millisecond later.
    alignment.add(1_005_000, 1_007_000);
    let estimate = alignment.estimate().unwrap();
    assert_eq!(estimate.offset_ns, 9_000.0);
    assert!((estimate.skew.unwrap() + 2e-3).abs() < 1e-12);
    alignment.add(4_000, 9_000);
    assert_eq!(alignment.estimate().unwrap().behind, 1);
}

#[test]
fn more_corners_than_are_kept() {
    let mut alignment = ClockAlignment::new();
    // On a parabola every point is a corner.
    for number in 0..1000u64 {
        alignment.add(number * 1_000_000_000, number * 1_000_000_000 + number * number);
    }
    let estimate = alignment.estimate().unwrap();
    // Slope of the tangent in the middle: 2·499.5 ns a second.
    assert!((estimate.skew.unwrap() - 999e-9).abs() < 20e-9, "{estimate:?}");
    assert_eq!(alignment.corners(), CORNERS);
}
