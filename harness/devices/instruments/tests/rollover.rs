//! Counters that roll over.

use octant_instruments::rollover::Rollover;

#[test]
fn a_counter_is_continued_across_its_end_and_goes_back_when_it_does() {
    let mut counter = Rollover::new(16);
    let raw = [65_534, 65_535, 0, 1, 1, 0, 40_000, 65_000, 3];
    let continued = raw.map(|raw| counter.continued(raw));
    assert_eq!(continued, [65_534, 65_535, 65_536, 65_537, 65_537, 65_536, 40_000, 65_000, 65_539]);
    let mut anew = Rollover::new(32);
    assert_eq!(anew.continued(5), 5);
    assert_eq!(anew.continued(u32::MAX.into()), u64::from(u32::MAX));
    let mut whole = Rollover::new(64);
    for counter in [3, 1 << 62, 7] {
        assert_eq!(whole.continued(counter), counter);
    }
}

#[test]
fn a_range_that_is_no_power_of_two_is_continued_too() {
    let mut counter = Rollover::modulo(1000);
    let raw = [998, 999, 0, 1, 1, 0, 400, 850, 3];
    let continued = raw.map(|raw| counter.continued(raw));
    assert_eq!(continued, [998, 999, 1000, 1001, 1001, 1000, 1400, 1850, 2003]);
    // A power of two gives what so many bits give.
    let (mut modulo, mut bits) = (Rollover::modulo(128), Rollover::new(7));
    for raw in [120, 127, 3, 2, 70, 5, 0] {
        assert_eq!(modulo.continued(raw), bits.continued(raw));
    }
}
