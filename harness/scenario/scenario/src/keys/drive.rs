//! Keys of a real table.

use super::by_case::GUARDS;
use super::definition::Bounds;
use super::table::{At, Of, boolean, choice, integer, keys, si, si_array, text, time};
use crate::model::TableDriver;
use crate::quantity::UnitDimension;

const fn wait() -> Of<f64> {
    time(1e-3, 3600.0, "from 1 ms to 1 h")
}

const fn silence() -> Of<f64> {
    time(0.0, 3600.0, "from 0 s to 1 h")
}

keys! {
    /// `[turntable.drive]`.
    pub(crate) struct DriveKeys {
        port: At<String> = text(), required,
            "Port of its controller: tcp:HOST:PORT, or serial:DEVICE?baud=RATE (115200 by default).";
        dialect: String = text(), "aerotech-ensemble",
            "What the controller speaks: aerotech-ensemble, or a file with a table of patterns.";
        driver: TableDriver = choice! {
            "this run" => TableDriver::ThisRun, "This run drives the table.";
            "another run" => TableDriver::AnotherRun, "Another run on this host drives it: this one gets its angles, and commands nothing.";
        }, "this run", "Which run drives the table.";
        units: u64 = integer(1, 64), "1",
            "Number of runs on the table, this one included: all begin together.";
        azimuth: At<[f64; 2]> = si_array(UnitDimension::ANGLE), required,
            "Least and greatest angle to which azimuth may turn. How fast both may turn is turntable.rate and turntable.acceleration.";
        roll: At<[f64; 2]> = si_array(UnitDimension::ANGLE), required,
            "Least and greatest angle to which roll may turn.";
        home: bool = boolean(), "false", "Whether both axes find their reference before the run.";
        start: f64 = time(1.0, 3600.0, "from 1 s to 1 h"), "2 min",
            "How long homing may take, and the way to zero, where every run begins.";
        tolerance: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), "36 arcsec",
            "How far from zero a gimbal may rest at the start.";
        look: f64 = wait(), "20 ms",
            "Pause from one look at the table to the next; set points are told with a look.";
        oldest: f64 = wait(), "100 ms",
            "How far a sample may be from the nearest look and still get its gimbal angles; beyond it they are flagged invalid.";
        reply: f64 = wait(), "500 ms",
            "How long a reply of the controller is waited for; then the table is stopped.";
        guard: At<f64> = silence(), by_case(GUARDS),
            "Silence of the program after which a process of its own stops the table. 0 s: there is none.";
        watchdog: At<f64> = silence(), "0 s",
            "Silence after which the controller stops the table by itself. 0 s: it isn't told to.";
    }
}
