//! A panic in the harness stops the table.

use crate::common::program::passes_as_process;
use crate::common::table::{Bench, Stage, wait_for};
use octant_sample::{GimbalAngles, GimbalCommand};
use octant_scenario::SourceSpec as Kind;
use octant_source::{Epoch, LiveSource, Source};

/// In a process of its own: a panic stops every table of its process.
#[test]
fn a_panic_anywhere_stops_the_table_and_ends_the_run() {
    passes_as_process("turntable_panic::the_table_stops_at_a_panic");
}

/// The thread of the samples isn't at fault: another one panics, and the next sample reports it.
#[test]
#[ignore = "run by a_panic_anywhere_stops_the_table_and_ends_the_run"]
fn the_table_stops_at_a_panic() {
    let stage = Stage::new();
    // A guard would be this test program again, which can't act as one.
    let scenario = Bench::new(&stage, 200, "guard = \"0 s\"\n").scenario();
    let Kind::Live(instrument) = &scenario.source else { panic!() };
    let mut source = LiveSource::of(&scenario, instrument).unwrap();
    let target = GimbalAngles::from_rad(0.0, 200f64.to_radians());
    let command = GimbalCommand { target };
    let mut epoch = Epoch::default();
    wait_for("the move", || {
        source.next(&command, &mut epoch).unwrap();
        stage.angle(octant_turntable::TableAxis::Roll) > 5.0
    });
    assert!(std::thread::spawn(|| panic!("somewhere else")).join().is_err());
    wait_for("rest", || stage.rests());
    let error = source.next(&command, &mut epoch).unwrap_err().to_string();
    assert_eq!(error, format!("turntable {}: the harness panicked", stage.port));
    // The summary is still available, and the table stays where it is.
    let (bench, failed) = source.conclude(Some(&error));
    assert!(failed.is_none(), "{failed:?}");
    let stopped = bench.unwrap().table.unwrap().stopped;
    assert_eq!(stopped.as_deref(), Some("the harness panicked"));
    assert!(stage.rests() && stage.angle(octant_turntable::TableAxis::Roll) < 195.0);
}
