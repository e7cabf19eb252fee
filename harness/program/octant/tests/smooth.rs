//! `octant smooth`: a run is smoothed, a change is found, and what can't be smoothed is said.

use crate::common::program::program;
use serde_json::{Value, json};
use std::path::Path;

const SHORT: &str = r#"schema = 1
title = "short"

[imu]
rate = "20 Hz"

[procedure.calibration]
duration = "1 h"

[record]
samples = "full"
"#;

/// A step of a gyro that the unit itself doesn't refuse: its own test is off.
const STEP: &str = r#"
[screening]
drift = "off"

[[faults]]
id = "step"
kind = "bias-step"
channels = "gyro x"
amplitude = "0.05 deg/h"
trigger = { at = "2000 s" }
"#;

/// Runs a scenario in a folder, into its folder `r`.
fn run(folder: &Path, text: &str, settings: &[&str]) {
    std::fs::write(folder.join("s.toml"), text).unwrap();
    let mut arguments = vec!["run", "s.toml", "--out", "r"];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    let output = program(&arguments).current_dir(folder).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(folder.join("r/recording.mcap").exists(), "{said}");
}

fn smooth(folder: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let arguments = [&["smooth"], more].concat();
    let output = program(&arguments).current_dir(folder).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_calibration_is_smoothed_and_its_constants_are_constant() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), SHORT, &[]);
    let (code, said, told) = smooth(folder.path(), &["r", "--json", "--csv", "h.csv"]);
    assert_eq!(code, Some(0), "{said}{told}");
    let found: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(found["equal_to_recording"], true);
    assert_eq!((&found["invalid"], &found["incomplete"]), (&json!([]), &json!([])));
    assert!(found["untested"].as_array().unwrap().len() < 15, "{}", found["untested"]);
    let nis = found["mean_nis"].as_f64().unwrap();
    // 3600 measurements of three axes: σ of the mean is 0.04.
    assert!((nis - 3.0).abs() < 0.2, "{nis}");
    let states = found["states"].as_array().unwrap();
    assert_eq!(states.len(), 9);
    for state in states {
        let (filtered, smoothed) =
            (state["filtered"].as_f64().unwrap(), state["smoothed"].as_f64().unwrap());
        assert!(smoothed > 0.0 && smoothed <= filtered * (1.0 + 1e-9), "{state}");
    }
    assert!(
        states[2]["smoothed"].as_f64().unwrap() < 0.7 * states[2]["filtered"].as_f64().unwrap()
    );
    assert_eq!(found["changes"].as_array().unwrap().len(), 7);
    // Smoothed, every constant has its last value and σ at all times.
    let table = std::fs::read_to_string(folder.path().join("h.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next().unwrap(), "# octant smooth, version 1");
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!((head.len(), rows.len()), (1 + 9 * 3 + 30 * 4, 48));
    let column = |name: &str| head.iter().position(|head| *head == name).unwrap();
    let [value, correction, sigma] = ["filter", "correction", "smoothed sigma"]
        .map(|what| column(&format!("gyro_bias_x {what} [deg/h]")));
    let last = rows.last().unwrap();
    for row in &rows {
        assert!((row[sigma] / last[sigma] - 1.0).abs() < 0.01, "{row:?}");
        let apart = row[value] + row[correction] - last[value] - last[correction];
        assert!(apart.abs() < 0.05 * last[sigma], "{apart}");
    }
    // A file isn't replaced.
    let (code, _, told) = smooth(folder.path(), &["r", "--csv", "h.csv"]);
    assert!(code == Some(2) && told.contains("failed to write h.csv"), "{told}");
}

#[test]
fn a_change_is_found_with_its_parameter_its_time_and_its_size() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &format!("{SHORT}{STEP}"), &[]);
    let (code, said, told) = smooth(folder.path(), &["r", "--json"]);
    assert_eq!(code, Some(1), "{said}{told}");
    let found: Value = serde_json::from_str(&said).unwrap();
    let jump = found["changes"].as_array().unwrap().iter().find(|c| c["change"] == "jump").unwrap();
    assert_eq!(jump["parameter"], "gyro_bias_x");
    assert!((jump["between_s"][0].as_f64().unwrap() - 2000.0).abs() < 80.0, "{jump}");
    let (size, sigma) = (jump["size"].as_f64().unwrap(), jump["size_sigma"].as_f64().unwrap());
    assert!((size - 0.05).abs() < 4.0 * sigma && sigma < 0.01, "{jump}");
    let (_, said, _) = smooth(folder.path(), &["r"]);
    assert!(said.contains("what the calibration takes for constant has changed"), "{said}");
}

#[test]
fn what_cannot_be_smoothed_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let short = SHORT.replace("\"1 h\"", "\"10 min\"");
    let cases = [
        (&["record.samples=decimated"][..], "needs every sample"),
        (
            &["procedure.calibration.estimator=least-squares"],
            "found estimator = \"least-squares\", expected \"kalman\"",
        ),
        (
            &["procedure.calibration.further={ gravity_anomaly = { considered = \"100 ug\" } }"],
            "found a filter with further states",
        ),
    ];
    for (settings, expected) in cases {
        let folder = tempfile::tempdir().unwrap();
        run(folder.path(), &short, settings);
        let (code, said, told) = smooth(folder.path(), &["r"]);
        assert!(code == Some(2) && told.contains(expected), "{code:?} {said}{told}");
    }
    // A recording that is cut in the calibration gives no verdict.
    run(folder.path(), &short, &[]);
    let path = folder.path().join("r/recording.mcap");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(folder.path().join("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    let (code, said, told) = smooth(folder.path(), &["cut.mcap"]);
    assert_eq!(code, Some(3), "{said}{told}");
    assert!(said.contains("incomplete: the recording ends before the calibration"), "{said}");
    let (code, _, told) = smooth(folder.path(), &["nowhere"]);
    assert!(code == Some(2) && told.contains("nowhere"), "{told}");
}

/// Calibrations of which the tests can't say that all is well.
#[test]
fn what_was_not_tested_is_no_pass() {
    let short = SHORT.replace("\"1 h\"", "\"10 min\"");
    let noise = "\n[[faults]]\nid = \"noise\"\nkind = \"noise-gain\"\nchannels = \"accelerometer\"\ngain = \"200 %\"\n\
                 trigger = { at = \"60 s\" }\n";
    let ship = "\n[motion]\nkind = \"dockside\"\n\n[procedure.calibration.aiding]\nreference = \"dock-position\"\n";
    let cases: [(String, &[&str], &str); 5] = [
        (
            SHORT.replace("\"1 h\"", "\"190 s\""),
            &[],
            "gyro_bias_x, gyro_bias_y, gyro_bias_z are known too little",
        ),
        (format!("{SHORT}{noise}"), &[], "the noise isn't that of the filter"),
        (format!("{short}{ship}"), &[], "the base moves"),
        (
            short.clone(),
            &["procedure.calibration.g_states=false"],
            "leaves out a group of parameters",
        ),
        (
            short.clone(),
            &["procedure.calibration.refuse_above_mean_nis=2.5"],
            "the core refused the calibration: the mean NIS",
        ),
    ];
    for (text, settings, expected) in cases {
        let folder = tempfile::tempdir().unwrap();
        run(folder.path(), &text, settings);
        let (code, said, told) = smooth(folder.path(), &["r"]);
        assert!(code == Some(3) && said.contains(expected), "{expected}: {code:?} {said}{told}");
        assert!(!said.contains("the data agree"), "{said}");
    }
}
