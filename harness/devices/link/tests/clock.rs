//! Offset and drift of the other end's clock.

use octant_link::clock::{ClockEstimator, Stamps};
use octant_wire::message::{ClockTime, TimeReply};

/// Exchange at a time, s, with a clock that is ahead by `ahead_ns` and fast by `skew`, with the
/// delays there and back, ns.
fn exchange(at_s: f64, ahead_ns: f64, skew: f64, there_ns: f64, back_ns: f64) -> Stamps {
    let start = 1e12;
    let t1 = start + at_s * 1e9;
    let other = |t: f64| t + ahead_ns + skew * (t - start);
    let (t2, t3) = (t1 + there_ns, t1 + there_ns + 3000.0);
    let time = |ns: f64| ClockTime::from_ns(ns.round() as u64);
    Stamps {
        reply: TimeReply {
            id: 0,
            harness_sent: time(t1),
            received: time(other(t2)),
            sent: time(other(t3)),
        },
        harness_received: time(t3 + back_ns),
    }
}

#[test]
fn equal_delays_give_offset_and_skew_as_they_are() {
    let mut clock = ClockEstimator::new(1.0);
    assert_eq!(clock.estimate(), None);
    for i in 0..120 {
        clock.add(&exchange(f64::from(i) * 0.25, 5e9, 20e-6, 50e3, 50e3));
    }
    let found = clock.estimate().unwrap();
    let at = 119.0 * 0.25 * 1e9 + 51_500.0;
    assert!((found.offset_ns - (5e9 + 20e-6 * at)).abs() < 5.0, "{found:?}");
    assert!((found.skew.unwrap() - 20e-6).abs() < 1e-9, "{found:?}");
    assert!((found.delay_min_ns - 100e3).abs() < 10.0);
    assert_eq!((found.exchanges, found.contradictory), (120, 0));
}

#[test]
fn what_is_delayed_on_one_way_is_left_out() {
    let mut clock = ClockEstimator::new(1.0);
    // Three of four exchanges are held up on the way back, by up to 9 ms.
    for i in 0..240 {
        let held = if i % 4 == 1 { 0.0 } else { 1e6 * f64::from(1 + i % 9) };
        clock.add(&exchange(f64::from(i) * 0.25, -3e6, -50e-6, 40e3, 40e3 + held));
    }
    let found = clock.estimate().unwrap();
    assert!((found.skew.unwrap() + 50e-6).abs() < 1e-8, "{found:?}");
    let at = 239.0 * 0.25 * 1e9 + 41_500.0;
    assert!((found.offset_ns - (-3e6 - 50e-6 * at)).abs() < 600e3, "{found:?}");
    assert_eq!(found.delay_min_ns, 80e3);
}

#[test]
fn the_offset_is_within_its_bound() {
    // Worst case: all of the delay is on one way.
    let mut clock = ClockEstimator::new(1.0);
    clock.add(&exchange(0.0, 1e6, 0.0, 200e3, 0.0));
    let found = clock.estimate().unwrap();
    assert_eq!(found.skew, None);
    assert!((found.offset_ns - 1e6).abs() <= found.bound_ns + 2.0, "{found:?}");
}

#[test]
fn old_stretches_are_forgotten() {
    let mut clock = ClockEstimator::new(1.0);
    for i in 0..300 {
        // The other clock is set back after 100 s.
        let ahead = if i < 100 { 7e9 } else { 1e6 };
        clock.add(&exchange(f64::from(i), ahead, 0.0, 10e3, 10e3));
    }
    let found = clock.estimate().unwrap();
    assert!((found.offset_ns - 1e6).abs() < 5.0, "{found:?}");
}

#[test]
fn stamps_that_contradict_each_other_are_not_taken() {
    let mut clock = ClockEstimator::new(1.0);
    let mut stamps = exchange(0.0, 0.0, 0.0, 10e3, 10e3);
    stamps.harness_received = ClockTime::from_ns(5);
    clock.add(&stamps);
    assert_eq!(clock.estimate(), None);
    clock.add(&exchange(1.0, 0.0, 0.0, 10e3, 10e3));
    assert_eq!(clock.estimate().unwrap().contradictory, 1);
}
