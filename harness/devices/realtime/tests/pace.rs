//! The frame clock.

use octant_realtime::clock::{MonotonicTime, now};
use octant_realtime::pace::{FrameClock, FramePacing};

const PACING: FramePacing = FramePacing { period_ns: 1_000_000, spin_ns: 0, overrun_ns: 100_000 };

#[test]
fn no_frame_begins_before_it_is_due_and_nothing_adds_up() {
    let start = now().after(2_000_000);
    let mut clock = FrameClock::start_at(PACING, start);
    for frame in 1..=50u64 {
        assert_eq!(clock.deadline(), MonotonicTime { ns: start.ns + frame * 1_000_000 });
        assert!(clock.wait() >= MonotonicTime { ns: start.ns + frame * 1_000_000 });
    }
    let report = clock.report();
    assert_eq!((report.frames, report.lateness.count), (50, 50));
}

#[test]
fn spinning_is_not_early_either() {
    let mut clock = FrameClock::start(FramePacing { spin_ns: 300_000, ..PACING });
    for _ in 0..20 {
        let deadline = clock.deadline();
        assert!(clock.wait() >= deadline);
    }
    // The whole wait is spent reading the clock.
    let mut clock = FrameClock::start(FramePacing { spin_ns: u64::MAX, ..PACING });
    let deadline = clock.deadline();
    assert!(clock.wait() >= deadline);
}

#[test]
fn late_frames_are_counted_and_caught_up_without_a_wait() {
    // The start was ten periods ago: the first ten frames are already due.
    let start = MonotonicTime { ns: now().ns - 10_500_000 };
    let mut clock = FrameClock::start_at(PACING, start);
    let first = clock.wait();
    assert!(first.since(start) >= 10_500_000);
    for _ in 0..9 {
        clock.wait();
    }
    let report = clock.report();
    assert_eq!(report.first_overrun, Some(1));
    assert!(report.overruns >= 10, "{report:?}");
    assert!(report.longest_row_of_overruns >= 10);
    assert!(report.lateness.max_us >= 9500.0, "{report:?}");
    assert_eq!(report.slack_p1_us, 0.0);
}

#[test]
fn lateness_up_to_the_limit_is_no_overrun_and_ends_a_row() {
    let mut clock = FrameClock::start(PACING);
    for lateness_ns in [100_000, 100_001, 200_000, 5, 100_001] {
        clock.begin(lateness_ns);
    }
    let report = clock.report();
    assert_eq!((report.overruns, report.longest_row_of_overruns), (3, 2));
    assert_eq!(report.first_overrun, Some(2));
}

#[test]
fn a_period_of_nothing_and_an_end_of_time_are_borne() {
    let mut clock = FrameClock::start(FramePacing { period_ns: 0, ..PACING });
    clock.wait();
    let clock = FrameClock::start_at(
        FramePacing { period_ns: u64::MAX, ..PACING },
        MonotonicTime { ns: u64::MAX - 5 },
    );
    assert_eq!(clock.deadline().ns, u64::MAX);
}
