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
    let files = ["--out", "d.toml", "--state", "state.json"];
    let json = [&["--rotation", "both", "--seed", "3", "--json"][..], &files].concat();
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
    assert!(text.contains("designed, seed 3 with G states"), "{text}");
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
    refused(
        &[
            "--set",
            "motion.kind=dockside",
            "--set",
            "procedure.calibration.aiding.reference=zero-velocity",
        ],
        &["procedure.calibration.aiding.reference", "expected \"dock-position\""],
    );
    refused(
        &["--set", "procedure.calibration.aiding.reference=dock-position"],
        &["procedure.calibration.aiding.reference", "expected \"zero-velocity\""],
    );
    refused(
        &["--set", "motion.kind=dockside", "--set", "procedure.calibration.aiding.sway=coloured"],
        &["procedure.calibration.aiding.sway", "found \"coloured\", expected \"white\""],
    );
    refused(
        &["--lead-in-round", "20 min", "--gimbals", "azimuth"],
        &["lead-in round", "expected both gimbals"],
    );
    refused(&["--lead-in-round", "20 min", "--stops", "60"], &["stops: found 60", "at most 46"]);
    refused(&["--lead-in-round", "2 min"], &["lead-in round: found 120 s", "expected at least"]);
    refused(
        &["--confirm", "4", "--set", "procedure.navigation.duration=12 h"],
        &["--confirm", "found a navigation of 12 h", "at least 24 h"],
    );
    refused(&["--confirm", "4", "--confirm-rate", "20 m"], &["imu.rate", "20 m"]);
    refused(&["--confirm", "1"], &["--confirm"]);
    refused(&["--set", "procedure.calibration.g_states=false"], &["not_estimated", "all groups"]);
    refused(
        &["--set", "imu.extensions.gyro_bias_instability=0.001 deg/h"],
        &["biases that wander", "expected constant biases"],
    );
    refused(
        &["--set", "site.drawn.deflection={ normal = \"5 arcsec\" }"],
        &["errors beside the parameters", "expected none"],
    );
    refused(
        &["--set", "procedure.calibration.further={ accel_lever = { estimated = \"5 cm\" } }"],
        &["procedure.calibration.further", "expected none"],
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

#[test]
fn a_design_on_a_moored_ship_is_predicted_as_by_observe() {
    let ship = "[motion]\nkind = \"dockside\"\n[motion.ship]\npreset = \"default\"\n";
    let scenario = SCENARIO.replace(
        "[procedure.navigation]",
        "[procedure.calibration.aiding]\nreference = \"dock-position\"\n[procedure.navigation]",
    );
    let here = folder(&(scenario + ship));
    let (said, _) = design(here.path(), &["--json"]);
    let report: Value = serde_json::from_str(&said).unwrap();
    let best = &report["designs"][0];
    let [score, observed] = ["score", "observed"].map(|key| best[key].as_f64().unwrap());
    assert!((observed / score - 1.0).abs() < 0.01, "{observed} {score}");
    assert!(score > best["bound"]["value"].as_f64().unwrap());
}

/// Figures of the attempts of a report with a confirmation.
fn attempts(report: &Value) -> &Vec<Value> {
    report["confirmation"]["attempts"].as_array().unwrap()
}

#[test]
fn a_confirmation_runs_the_design_and_goes_on_until_one_is_confirmed() {
    let here = folder(SCENARIO);
    let options = ["--confirm", "4", "--confirm-rate", "10 Hz", "--confirm-attempts", "3"];
    let all = [
        &["design", "s.toml", "--effort", "quick", "--stops", "12", "--json"][..],
        &["--rotation", "tetrahedral", "--out", "d.toml", "--state", "state.json"],
        &options,
    ]
    .concat();
    let output = octant_in(here.path(), &all);
    let status = output.status.code();
    let said = String::from_utf8(output.stdout).unwrap();
    let report: Value = serde_json::from_str(&said).unwrap();
    let confirmation = &report["confirmation"];
    let tried = attempts(&report);
    let confirmed: Vec<bool> =
        tried.iter().map(|one| one["result"]["confirmed"].as_bool().unwrap()).collect();
    // Every attempt before the last one failed; the exit status tells of the last one.
    let (last, before) = confirmed.split_last().unwrap();
    assert!(before.iter().all(|confirmed| !confirmed), "{confirmed:?}");
    assert_eq!(status, Some(if *last { 0 } else { 3 }), "{confirmed:?}");
    assert!(*last || tried.len() == 3, "{confirmed:?}");
    let number = last.then_some(tried.len() as u64);
    assert_eq!(confirmation["confirmed"].as_u64(), number);
    // The second attempt starts with the round.
    if let Some(second) = tried.get(1) {
        assert!(second["round_s"].as_f64().unwrap() > 0.0, "{}", second["about"]);
    }
    let written = std::fs::read_to_string(here.path().join("d.toml")).unwrap();
    let words = if *last { "It was confirmed by simulation" } else { "It was not confirmed" };
    assert!(written.contains(words), "{written}");
    // The runs are those of the scenario that is written, and of eight positions.
    let other = SCENARIO.replace("[baseline]\npositions = \"six\"\n", "rotation = \"sixteen\"\n");
    let rates = "[record]\nrate = \"0.1 Hz\"\n";
    let other = other.replace("[imu]", "[imu]\nrate = \"10 Hz\"") + rates;
    std::fs::write(here.path().join("eight.toml"), other).unwrap();
    let compared = ["compare", "d.toml", "--against", "eight.toml", "--seeds", "4", "--json"];
    let sets = ["--set", "imu.rate=10 Hz", "--set", "record.rate=0.1 Hz"];
    let (compared, _) = ended(octant_in(here.path(), &[&compared[..], &sets].concat()), 0);
    let compared: Value = serde_json::from_str(&compared).unwrap();
    let shown = if *last { tried.len() - 1 } else { 0 };
    let runs = tried[shown]["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    for (run, expected) in runs.iter().zip(compared["runs"].as_array().unwrap()) {
        assert_eq!(run["seed"], expected["seed"]);
        for (side, key) in [("reference", "first"), ("designed", "second")] {
            let of = |maxima: &Value| maxima["longitude_24h"].as_f64().unwrap();
            let (found, expected) = (of(&run[side]["maxima"]), of(&expected[key]));
            assert!((found / expected - 1.0).abs() < 1e-6, "{side} {found} {expected}");
        }
        assert_eq!(run["designed"]["g_normalized"].as_array().unwrap().len(), 9);
    }
    // From the stored state on nothing is run again, and the result is the same; on one thread too.
    let state: Value =
        serde_json::from_slice(&std::fs::read(here.path().join("state.json")).unwrap()).unwrap();
    assert_eq!(state["runs"].as_object().unwrap().len(), tried.len());
    let resumed = [&all[..], &["--resume", "--force", "--jobs", "1"]].concat();
    let resumed = octant_in(here.path(), &resumed);
    assert_eq!(resumed.status.code(), status);
    assert_eq!(String::from_utf8(resumed.stdout).unwrap(), said);
}

#[test]
fn a_confirmation_as_text_has_the_reasons() {
    let here = folder(SCENARIO);
    let all = ["design", "s.toml", "--effort", "quick", "--stops", "12", "--confirm", "2"];
    let more = ["--confirm-rate", "10", "--confirm-attempts", "1", "--continuous"];
    let output = octant_in(here.path(), &[&all[..], &more].concat());
    let status = output.status.code();
    let text = String::from_utf8(output.stdout).unwrap();
    let parts = [
        "simulation: 2 seeds from 1 on at 10 Hz, against eight positions, sixteen moves",
        "attempt 1: best design",
        "longitude to 24 h",
        "normalized squared errors of G, designed",
        "continuous calibration",
        "continuous navigation",
        if status == Some(0) {
            "  confirmed by simulation"
        } else {
            "  not confirmed by simulation"
        },
    ];
    for part in parts {
        assert!(text.contains(part), "{part:?} is not in\n{text}");
    }
    assert!(status == Some(0) || text.contains("not confirmed: "), "{text}");
}
