//! A panic of the harness stops the table. The test runs in a separate process, because a panic stops
//! every table of a process, including those of the other tests.

use crate::common::*;
use octant_test_processes::command;
use octant_turntable::{TableAxis, Turntable, on_panic};

/// Environment variable that marks the separate process.
const ALONE: &str = "OCTANT_PANICS_ALONE";

/// The driver is neither dropped nor called: the panic alone stops the table.
#[test]
fn a_panic_in_any_thread_stops_it() {
    if std::env::var_os(ALONE).is_none() {
        let output = command(std::env::current_exe().unwrap())
            .args(["--exact", "panic::a_panic_in_any_thread_stops_it", "--nocapture"])
            .env(ALONE, "1")
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        // A filter that matches no test would also succeed, so one passed test is required.
        assert!(
            output.status.success() && said.contains("1 passed"),
            "{said}{}",
            String::from_utf8_lossy(&output.stderr)
        );
        return;
    }
    on_panic();
    let (server, name) = tcp(invented());
    let mut driver = drive(&name, invented(), settings());
    driver.rate(TableAxis::Roll, degrees(1.0)).unwrap();
    wait_for("the rate", || turns(&server, TableAxis::Roll));
    let panicked = std::thread::spawn(|| panic!("somewhere else")).join();
    assert!(panicked.is_err());
    wait_for("rest", || rests(&server));
    let error = driver.rate(TableAxis::Roll, 0.1).unwrap_err().to_string();
    assert_eq!(error, "the table was stopped: the harness panicked");
}
