//! Attacks of a foreign core in an FMU: outputs that a wire's messages can't express.

use super::unit::{check, summary_of};
use super::{Ends, Row, breaks, fails, open};
use crate::common::foreign;
use octant_scenario::Scenario;
use octant_score::summary::Summary;
use std::path::Path;

const SCENARIO: &str = r#"
schema = 1
title = "another's core"
[imu]
rate = "50 Hz"
[procedure.calibration]
duration = "20 s"
stops = [{}, { azimuth = "90 deg", roll = "-45 deg" }]
[procedure.navigation]
duration = "10 s"
[[requirements]]
id = "NEAR"
text = "It stays near."
measure = "navigation.radial_error_nmi.max"
limit = "1 nmi"
[endpoint]
uri = "fmu:CORE"
[endpoint.fmu]
modes = { calibrating = ["standing", "turned"], navigating = 30 }
[endpoint.fmu.parameters]
turn_at = "5 s"
sail_at = "20 s"
trouble = TROUBLE
from = FROM
[endpoint.fmu.map]
gyro.rate = "w"
accelerometer.specific_force = "f"
reference.velocity = "log.v"
reference.valid = "log.fresh"
gimbal_command.azimuth = "table.azimuth"
gimbal_command.roll = "table.roll"
mode = "phase"
navigation.latitude = "lat"
navigation.longitude = "lon"
navigation.height = "h"
parameters.gyro_bias = "bias"
"#;

/// Runs a foreign core with a trouble from a time on (s).
fn run(trouble: u32, from_s: u32) -> Result<Summary, String> {
    let fmu = foreign::fmu("core_fmi2");
    let text = SCENARIO
        .replace("CORE", fmu.to_str().unwrap())
        .replace("TROUBLE", &trouble.to_string())
        .replace("FROM", &from_s.to_string());
    let scenario = Scenario::parse(&text, "fmu.toml", Path::new(""), &[])
        .map_err(|error| error.to_string())
        .unwrap();
    summary_of(&scenario)
}

/// Trouble number of small changes, as in a real navigation.
const MOVES: u32 = 3;

#[test]
fn a_foreign_core_that_moves_passes() {
    let summary = run(MOVES, 0).unwrap();
    assert_eq!(summary.verdict.exit_code(), 0, "{:?}", summary.reasons);
    assert!(summary.reasons.is_empty(), "{:?}", summary.reasons);
}

macro_rules! troubles {
    ($($name:ident: $trouble:literal, $from:literal, $about:literal, $ends:expr;)*) => {
        /// Returns the rows of the table.
        pub fn rows() -> Vec<Row> {
            vec![$(Row { group: "FMU", about: $about, over: "FMU", ends: $ends }),*]
        }
        $(#[test]
        fn $name() {
            let ends: Ends = $ends;
            check($about, &ends, run($trouble, $from));
        })*
    };
}

troubles! {
    stands_still: 0, 0, "tells where it was told to be, for ever",
        open("the position of the navigation doesn't follow the samples");
    crashes: 1, 25, "crashes in its navigation", breaks("SIGSEGV");
    latitude_nan: 4, 25, "has a latitude that is NaN", fails("navigation.latitude_rad is NaN");
    longitude_infinite: 5, 25, "has an infinite longitude", fails("navigation.longitude_rad is inf");
    height_nan: 6, 1, "has a height that is NaN in its calibration", fails("navigation.height_m is NaN");
    mode_unknown: 7, 25, "has a mode that nobody named", fails("mode is 77, expected a value that the scenario's modes name");
    bias_nan: 8, 10, "estimates NaN", fails("parameters.gyro_bias_x is NaN");
    sails_at_once: 9, 1, "navigates after a second of its calibration", open("calibration: planned 20 s, done");
    wants_the_end: 10, 21, "refuses a step after a second of its navigation", breaks("it refused a step of 0.02 s");
    turns_elsewhere: 11, 0, "turns its table to another place", open("stops of the calibration: planned 2, done 1");
    back_to_calibration: 12, 25, "calibrates again in its navigation", fails("mode is calibrating, expected navigating");
}
