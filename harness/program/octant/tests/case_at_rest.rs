//! Case that is said to rest, from the scenario to the summary: used where it rests, and where it turns the
//! parameters are those of the same calibration without it.

use crate::common::program::program;
use octant_scenario::Scenario;
use serde_json::Value;
use std::path::Path;

const STILL: &str = r#"schema = 1
title = "case at rest"
seed = 3

[imu]
rate = "50 Hz"

[procedure.calibration]
duration = "1 h"

[procedure.navigation]
duration = "6 min"
"#;
const REST: &str = "\n[procedure.calibration.aiding.rest]\n";

/// Sway of the case about its axes, arc seconds, with one period.
fn sway(angles_arcsec: [f64; 3], period_s: f64) -> String {
    let angles = angles_arcsec.map(|angle| format!("\"{angle} arcsec\"")).join(", ");
    format!(
        "\n[[faults]]\nid = \"floor\"\nkind = \"sway\"\ntrigger = {{ at = \"1 s\" }}\nangles = [{angles}]\n\
         angle_periods = [\"{period_s} s\", \"{period_s} s\", \"{period_s} s\"]\n\
         displacement = [\"0 m\", \"0 m\", \"0 m\"]\nedge = \"60 s\"\n"
    )
}

fn summary(text: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let mut run = program(&["run", "s.toml", "--out", "out", "--json"]);
    let output = run.current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"))
}

#[test]
fn a_case_at_rest_is_used_and_says_so() {
    let [with, without] = [REST, ""].map(|rest| summary(&format!("{STILL}{rest}")));
    let rest = &with["calibration"]["rest"];
    assert_eq!(rest["used"], true, "{rest}");
    assert!(rest["largest_difference_sigmas"].as_f64().unwrap() < 5.0, "{rest}");
    assert!(without["calibration"].get("rest").is_none());
    let sigma =
        |of: &Value| of["calibration"]["parameters"]["gyro_bias_z"]["sigma"].as_f64().unwrap();
    assert!(sigma(&with) < 0.6 * sigma(&without), "{} {}", sigma(&with), sigma(&without));
    assert!(with["calibration"]["worst_normalized_error"].as_f64().unwrap() < 4.0);
}

/// A floor that swings slowly by 12′ about a level axis, one that turns by 20″ in heading, one that rocks by 6″ in ten
/// minutes, and steps of a foot: each beyond jitter and wander.
#[test]
fn a_case_that_turns_leaves_the_calibration_without_rest() {
    for (angles, period_s) in [
        ([720.0, 0.0, 0.0], 3600.0),
        ([0.0, 0.0, 20.0], 3600.0),
        ([0.0, 0.0, 60.0], 3600.0),
        ([0.0, 6.0, 0.0], 600.0),
        ([20.0, 0.0, 20.0], 600.0),
    ] {
        let floor = sway(angles, period_s);
        let [with, without] = [REST, ""].map(|rest| summary(&format!("{STILL}{floor}{rest}")));
        let [rested, plain] = [&with, &without].map(|of| &of["calibration"]);
        if !plain["refused"].is_null() {
            // Neither is published.
            assert!(!rested["refused"].is_null(), "{angles:?} {period_s}: {rested}");
            continue;
        }
        assert_eq!(rested["rest"]["used"], false, "{angles:?} {period_s}: {}", rested["rest"]);
        assert!(rested["rest"]["contradicted"].as_str().is_some_and(|why| !why.is_empty()));
        assert!(rested["refused"].is_null(), "{rested}");
        assert_eq!(rested["parameters"], plain["parameters"], "{angles:?} {period_s}");
        assert_eq!(with["navigation"], without["navigation"], "{angles:?} {period_s}");
    }
}

#[test]
fn a_rest_that_nothing_measures_is_refused_in_plain_words() {
    let refused =
        |text: &str| Scenario::parse(text, "s.toml", Path::new("."), &[]).unwrap_err().to_string();
    let at_dock = refused(&format!("{STILL}{REST}\n[motion]\nkind = \"dockside\"\n"));
    assert!(at_dock.contains("aiding.rest: found with motion.kind = \"dockside\""), "{at_dock}");
    let adjusted =
        STILL.replace("duration = \"1 h\"", "duration = \"1 h\"\nestimator = \"least-squares\"");
    let adjusted = refused(&format!("{adjusted}{REST}"));
    assert!(adjusted.contains("least squares takes every case for one at rest"), "{adjusted}");
    let elsewhere = refused(&format!("{STILL}{REST}\n[endpoint]\nuri = \"udp:127.0.0.1:9000\"\n"));
    assert!(elsewhere.contains("neither a wire nor an FMU has a place"), "{elsewhere}");
}
