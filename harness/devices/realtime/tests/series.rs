//! Lateness over a run, in bounded memory.

use crate::no_allocation::allocations;
use octant_realtime::series::{INTERVALS_MAX, LatenessInterval, LatenessSeries};

#[test]
fn a_day_at_200_hz_stays_short_and_keeps_every_overrun_and_extreme() {
    let (mut series, frames) = (LatenessSeries::new(), 24 * 3600 * 200u64);
    let late = |k: u64| match k {
        7_777_777 => 9_000_000,
        7_777_778 => 3,
        k => 20_000 + k % 1000,
    };
    let allocated = allocations();
    for k in 0..frames {
        let late_ns = late(k);
        series.record(late_ns, late_ns > 1_000_000 || k % 1_000_000 == 0);
    }
    assert_eq!(allocations(), allocated);
    let (intervals, each) = (series.intervals(), series.frames_per_interval());
    assert!((500..=1000).contains(&intervals.len()), "{}", intervals.len());
    assert_eq!((frames).div_ceil(each), intervals.len() as u64);
    let spike = intervals[(7_777_777 / each) as usize];
    assert_eq!(spike.largest_ns, 9_000_000);
    assert_eq!(intervals[(7_777_778 / each) as usize].least_ns, 3);
    assert_eq!(intervals.iter().filter(|i| i.largest_ns > 21_000).count(), 1);
    let overruns: u64 = intervals.iter().map(|i| i.overruns).sum();
    assert_eq!(overruns, 18 + 1);
}

#[test]
fn the_frame_after_the_last_interval_merges_neighbours() {
    let mut series = LatenessSeries::new();
    for k in 0..INTERVALS_MAX as u64 {
        series.record(k + 1, k == 999);
    }
    assert_eq!((series.intervals().len(), series.frames_per_interval()), (1000, 1));
    series.record(5, false);
    assert_eq!((series.intervals().len(), series.frames_per_interval()), (501, 2));
    let of = |least_ns, largest_ns, overruns| LatenessInterval { least_ns, largest_ns, overruns };
    assert_eq!(series.intervals()[0], of(1, 2, 0));
    assert_eq!(series.intervals()[499], of(999, 1000, 1));
    assert_eq!(series.intervals()[500], of(5, 5, 0));
    // The last interval has room for one more frame.
    series.record(9, false);
    assert_eq!(series.intervals()[500..], [of(5, 9, 0)]);
}
