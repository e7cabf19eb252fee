//! `octant design`, from a scenario to a scenario with the designed sequence.

use crate::common::program::{ended, octant_in};
use octant_scenario::Scenario;
use serde_json::Value;
use std::path::Path;

const SCENARIO: &str = "schema = 1\ntitle = \"large G\"\n[site]\nlatitude = \"30.5 deg\"\n[imu]\n\
    g_dependent = { normal = \"0.005 deg/h/g\" }\n[procedure.calibration]\nduration = \"2 h\"\n\
    [procedure.navigation]\nduration = \"24 h\"\n[baseline]\npositions = \"six\"\n";

fn folder(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    folder
}

fn design(folder: &Path, more: &[&str]) -> (String, String) {
    let some = ["design", "s.toml", "--effort", "quick", "--stops", "12"];
    ended(octant_in(folder, &[&some[..], more].concat()), 0)
}

#[test]
fn a_design_is_a_scenario_that_runs() {
    let here = folder(SCENARIO);
    let json = ["--rotation", "both", "--out", "d.toml", "--state", "state.json", "--json"];
    let (said, _) = design(here.path(), &json);
    let report: Value = serde_json::from_str(&said).unwrap();
    let best = &report["designs"][0];
    let score = best["score"].as_f64().unwrap();
    assert!(score > best["bound"]["value"].as_f64().unwrap());
    for published in best["published"].as_array().unwrap() {
        assert!(published["score"].as_f64().is_none_or(|other| score <= other), "{published}");
    }
    let observed = best["observed"].as_f64().unwrap();
    assert!((observed / score - 1.0).abs() < 0.02, "{observed} {score}");
    // What was written has the sequence and the rotation that were reported.
    let written = Scenario::load(&here.path().join("d.toml"), &[]).unwrap();
    let calibration = written.calibration.as_ref().unwrap();
    let stops = best["stops"].as_array().unwrap();
    assert_eq!(calibration.sequence.stops().len(), stops.len());
    for (stop, reported) in calibration.sequence.stops().iter().zip(stops) {
        let dwell_s = stop.weight * calibration.dwell_s;
        assert!((dwell_s - reported["dwell_s"].as_f64().unwrap()).abs() < 1e-6);
        let azimuth_deg = reported["azimuth_deg"].as_f64().unwrap();
        assert!((stop.azimuth_rad.to_degrees() - azimuth_deg).abs() < 1e-9);
    }
    let (text, _) = ended(octant_in(here.path(), &["observe", "d.toml"]), 0);
    assert!(text.contains("designed, seed 1 with G states"), "{text}");
    // The same from the stored state on, and on one thread.
    let resumed = [&json[..], &["--resume", "--jobs", "1", "--force"]].concat();
    assert_eq!(design(here.path(), &resumed).0, said);
}

#[test]
fn a_design_as_text_has_scores_bound_and_stops() {
    let here = folder(SCENARIO);
    let (text, _) = design(here.path(), &["--minimise", "sigma.g_zz", "--gimbals", "one"]);
    for part in ["σ of g_zz", "eight-level", "designed", "bound of all sequences", "without it"] {
        assert!(text.contains(part), "{part:?} is not in\n{text}");
    }
}

#[test]
fn what_is_not_built_is_refused() {
    let here = folder(SCENARIO);
    let refused = |more: &[&str], parts: &[&str]| {
        let all = [&["design", "s.toml"], more].concat();
        let (_, error) = ended(octant_in(here.path(), &all), 2);
        for part in parts {
            assert!(error.contains(part), "{part:?} is not in {error}");
        }
    };
    refused(&["--minimise", "longitud"], &["unknown measure", "longitude"]);
    refused(&["--set", "motion.kind=dockside"], &["motion.kind", "expected \"static\""]);
    refused(&["--set", "procedure.calibration.g_states=false"], &["not_estimated", "all groups"]);
    refused(
        &["--set", "imu.extensions.gyro_bias_instability=0.001 deg/h"],
        &["biases that wander", "expected constant biases"],
    );
    refused(&["--azimuth-range", "30..90"], &["azimuth range", "contains 0"]);
    refused(&["--azimuth-range", "30"], &["expected whole degrees"]);
    refused(&["--lead-in", "3 h"], &["no candidate keeps the limits"]);
    refused(&["--state", "none.json", "--resume"], &["none.json"]);
    // Nothing that was there is lost, and nothing is searched for before that is known.
    refused(&["--out", "s.toml"], &["--out", "s.toml exists already", "--force"]);
    refused(&["--state", "s.toml"], &["--state", "s.toml exists already"]);
    assert_eq!(std::fs::read_to_string(here.path().join("s.toml")).unwrap(), SCENARIO);
}
