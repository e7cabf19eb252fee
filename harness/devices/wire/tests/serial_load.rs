//! Capacity of a serial line.

use octant_wire::serial::Baud;
use octant_wire::traffic::Traffic;

#[test]
fn the_load_of_a_line_is_counted_each_way() {
    // A sample has at most 2 + 1 + 11 + 52 + 4 bytes, an output 2 + 1 + 11 + 132 + 4, with 10 bits
    // each.
    let traffic = Traffic { samples_hz: 200.0, outputs_hz: 200.0, ..Traffic::default() };
    let load = Baud::new(921_600).load(&traffic);
    assert!((load.from_harness - 200.0 * 700.0 / 921_600.0).abs() < 1e-12, "{load:?}");
    assert!((load.to_harness - 200.0 * 1500.0 / 921_600.0).abs() < 1e-12, "{load:?}");
    // The slowest common rate doesn't carry the answers, the fastest does.
    assert!(Baud::new(115_200).load(&Traffic::session(200.0)).to_harness > 1.0);
    assert!(Baud::new(921_600).load(&Traffic::session(200.0)).to_harness < 0.4);
}
