//! The table stops when the harness panics. A test program of its own: a panic stops every table of a
//! program.

use crate::common::*;
use octant_turntable::{Axis, Turntable, on_panic};

/// The driver is neither dropped nor asked: the panic alone stops the table.
#[test]
fn a_panic_in_any_thread_stops_it() {
    on_panic();
    let (server, name) = tcp(invented());
    let mut driver = drive(&name, invented(), settings());
    driver.rate(Axis::Roll, degrees(1.0)).unwrap();
    wait_for("the rate", || turns(&server, Axis::Roll));
    let panicked = std::thread::spawn(|| panic!("somewhere else")).join();
    assert!(panicked.is_err());
    wait_for("rest", || rests(&server));
    let error = driver.rate(Axis::Roll, 0.1).unwrap_err().to_string();
    assert_eq!(error, "the table was stopped: the harness panicked");
}
