//! Time scales against dates of their publishers.

use octant_instruments::StampScale;

const SECOND_NS: u64 = 1_000_000_000;

/// GPS week 1930 began on Sunday, 1 January 2017, at 0:00:00 GPS time, 18 s before the UTC of that name
/// by the leap second at this midnight: UTC 2016-12-31T23:59:42 has the Unix time 1 483 228 782.
#[test]
fn gps_time_is_ahead_of_utc_by_the_leap_seconds_since_1980() {
    let week_ns = 1930 * 604_800 * SECOND_NS;
    let utc_s = StampScale::Gps.utc_ns(week_ns, 37) / i128::from(SECOND_NS);
    assert_eq!(utc_s, 1_483_228_800 - 18);
    assert_eq!(StampScale::Gps.tai_ns(week_ns, 0) / i128::from(SECOND_NS), utc_s + 37);
    assert_eq!(StampScale::Gps.utc_ns(0, 19) / i128::from(SECOND_NS), 315_964_800);
}

#[test]
fn tai_is_ahead_by_its_offset_and_utc_is_the_clock_itself() {
    let ns = 1_700_000_000 * SECOND_NS + 5;
    assert_eq!(StampScale::Utc.utc_ns(ns, 37), i128::from(ns));
    assert_eq!(StampScale::Tai.utc_ns(ns, 37), i128::from(ns) - 37_000_000_000);
    assert_eq!(StampScale::Utc.tai_ns(ns, 37), i128::from(ns) + 37_000_000_000);
    assert_eq!(StampScale::Tai.tai_ns(ns, 37), i128::from(ns));
}
