//! Further states of the filter, from the scenario to the summary.

use crate::common::program::program;
use octant_observe::perfect;
use octant_sample::further::FURTHER_NAMES;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario};
use serde_json::Value;
use std::path::Path;

/// A short calibration of an instrument whose proof masses sit apart.
const LEVER: &str = r#"schema = 1
title = "size effect"
seed = 3

[imu]
rate = "50 Hz"

[imu.extensions.lever_arm]
x = ["3 cm", "-4 cm", "2 cm"]
y = ["-2 cm", "3 cm", "4 cm"]
z = ["1 cm", "5 cm", "-3 cm"]

[screening]
gate = "off"
drift = "off"

[procedure.calibration]
duration = "1 h"

[procedure.calibration.further]
accel_lever = { estimated = "5 cm" }
gravity_anomaly = { considered = "30 ug" }

[baseline]
further = {}
"#;

fn summary(text: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let mut run = program(&["run", "s.toml", "--out", "out", "--json"]);
    let output = run.current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"))
}

/// What a command says as JSON, whatever its exit status.
fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = program(arguments).current_dir(folder).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"))
}

fn refused(text: &str) -> String {
    Scenario::parse(text, "s.toml", Path::new("."), &[]).unwrap_err().to_string()
}

#[test]
fn estimated_lever_arms_are_in_the_summary_and_right() {
    let summary = summary(LEVER);
    let calibration = &summary["calibration"];
    let further = calibration["further"].as_object().unwrap();
    let names: Vec<&str> = further.keys().map(String::as_str).collect();
    let mut expected: Vec<&str> = FURTHER_NAMES[..9].to_vec();
    expected.push("gravity_anomaly");
    assert_eq!(names, expected);
    let truth = [30.0, -40.0, 20.0, -20.0, 30.0, 40.0, 10.0, 50.0, -30.0];
    for (name, truth) in FURTHER_NAMES.iter().zip(truth) {
        let score = &further[*name];
        assert_eq!((score["true"].as_f64(), score["unit"].as_str()), (Some(truth), Some("mm")));
        // Four σ of each, and a σ that is far below the prior.
        assert!(score["normalized"].as_f64().unwrap().abs() < 4.0, "{name}: {score}");
        assert!(score["sigma"].as_f64().unwrap() < 10.0, "{name}: {score}");
    }
    let anomaly = &further["gravity_anomaly"];
    assert_eq!(anomaly["estimate"].as_f64(), Some(0.0));
    assert!((anomaly["sigma"].as_f64().unwrap() - 30.0).abs() < 1e-9, "{anomaly}");
    // The same instrument to a filter that doesn't know of them: every centimetre is somebody else's error.
    let worst = |of: &Value| of["worst_normalized_error"].as_f64().unwrap();
    let ignored = &summary["baseline"]["calibration"];
    assert!(ignored.get("further").is_none());
    assert!(worst(calibration) < 4.5, "{}", worst(calibration));
    assert!(worst(ignored) > 2.0 * worst(calibration), "{}", worst(ignored));
}

#[test]
fn what_is_observed_before_a_run_is_the_sigma_after_it() {
    let scenario = Scenario::parse(LEVER, "s.toml", Path::new("."), &[]).unwrap();
    let found = perfect::run(&scenario, Method::Primary).unwrap();
    let summary = summary(LEVER);
    let sigma = |of: &str, name: &str| summary["calibration"][of][name]["sigma"].as_f64().unwrap();
    for (index, name) in FURTHER_NAMES[..9].iter().enumerate() {
        let before = found.further.unwrap().sigma[index] * 1e3;
        assert!((before / sigma("further", name) - 1.0).abs() < 0.01, "{name}: {before}");
    }
    for (index, name) in octant_sample::parameters::NAMES.iter().enumerate() {
        let unit = octant_sample::parameters::ParameterGroup::of(index).si_per_unit();
        let before = found.parameters[index] / unit;
        assert!((before / sigma("parameters", name) - 1.0).abs() < 0.01, "{name}: {before}");
    }
}

/// The predicted ensemble has the states, and compares them with the cases of a campaign.
#[test]
fn the_predicted_ensemble_has_the_further_states() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), DRAWN).unwrap();
    let predicted = json(folder.path(), &["observe", "s.toml", "--ensemble", "--json"]);
    let states = predicted[0]["states"].as_array().unwrap();
    assert_eq!(states.len(), 39 + 21);
    let arm = states.iter().find(|state| state["name"] == "accel_lever_xx").unwrap();
    assert_eq!((arm["prior"].as_f64(), arm["unit"].as_str()), (Some(30.0), Some("mm")));
    let [believed, sigma] = ["believed", "sigma"].map(|key| arm[key].as_f64().unwrap());
    // The filter's σ is that of the draws: it achieves what it believes.
    assert!(sigma < 10.0 && (sigma / believed - 1.0).abs() < 0.01, "{arm}");
    let campaign =
        "schema = 1\ntitle = \"c\"\nreplicates = 6\n[[scenarios]]\nid = \"s\"\nfile = \"s.toml\"\n";
    std::fs::write(folder.path().join("c.toml"), campaign).unwrap();
    // Nothing is required of the cases: they are inconclusive.
    for (command, status) in
        [(&["campaign", "plan", "c.toml", "--out", "c"][..], 0), (&["campaign", "run", "c"], 3)]
    {
        let done = program(command).current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(status), "{said}");
    }
    let against =
        json(folder.path(), &["observe", "s.toml", "--ensemble", "--against", "c", "--json"]);
    let compared = against["compared"][0]["states"].as_array().unwrap();
    assert_eq!(compared.len(), 30 + 21);
    assert!(compared.iter().all(|row| row["agrees"] == true), "{against}");
}

/// Every further error that the seed draws, with the filter's σ. Deflection and anomaly can't be told from other errors
/// on a base at rest, and are considered.
const DRAWN: &str = r#"schema = 1
seed = 1

[imu]
rate = "50 Hz"

[imu.extensions.drawn]
lever_arm = { normal = "3 cm" }
gyro_asymmetry = { normal = "30 ppm" }
accel_asymmetry = { normal = "30 ppm" }
accel_quadratic = { normal = "20 ug/g^2" }

[site.drawn]
deflection = { normal = "10 arcsec" }
gravity_anomaly = { normal = "50 ug" }

[screening]
gate = "off"
drift = "off"

[procedure.calibration]
duration = "1 h"

[procedure.calibration.further]
accel_lever = { estimated = "3 cm" }
gyro_asymmetry = { estimated = "30 ppm" }
accel_asymmetry = { estimated = "30 ppm" }
accel_quadratic = { estimated = "20 ug/g^2" }
deflection = { considered = "10 arcsec" }
gravity_anomaly = { considered = "50 ug" }
"#;

/// Instruments of many seeds: the squared normalized error of each further state is χ² with one degree of freedom a seed.
/// Each mean has to be in the interval that all 21 keep with a probability of 99.9 %.
#[test]
fn drawn_further_errors_are_as_large_as_the_filter_says() {
    const SEEDS: u32 = 24;
    let mut sums = std::collections::BTreeMap::new();
    let (mut nees, mut first) = (0.0, None);
    for seed in 1..=SEEDS {
        let summary = summary(&DRAWN.replace("seed = 1", &format!("seed = {seed}")));
        let calibration = &summary["calibration"];
        for (name, score) in calibration["further"].as_object().unwrap() {
            *sums.entry(name.clone()).or_insert(0.0) +=
                score["normalized"].as_f64().unwrap().powi(2);
        }
        nees += calibration["nees"]["accel_lever"].as_f64().unwrap();
        let arm = calibration["further"]["accel_lever_zx"]["true"].as_f64();
        assert_ne!(arm, first, "seed {seed}");
        first = arm;
    }
    assert_eq!(sums.len(), 21);
    // Of a two-sided probability of 0.001 for 21 states: χ² with 24 degrees of freedom, by Wilson and Hilferty.
    let (n, z) = (f64::from(SEEDS), 4.07);
    let bound = |z: f64| (1.0 - 2.0 / (9.0 * n) + z * (2.0 / (9.0 * n)).sqrt()).powi(3);
    for (name, sum) in &sums {
        let mean = sum / n;
        println!("{name:20} {mean:.2}");
        assert!((bound(-z)..bound(z)).contains(&mean), "{name}: {mean}");
    }
    let arms = sums.iter().filter(|(name, _)| name.starts_with("accel_lever")).map(|(_, sum)| sum);
    assert!((arms.sum::<f64>() / 9.0 / nees - 1.0).abs() < 1e-9);
}

/// The resolved scenario has the drawn values as given ones, and is the same run.
#[test]
fn a_resolved_scenario_has_the_errors_that_were_drawn() {
    let given =
        DRAWN.replace("[site.drawn]", "[site]\ndeflection_east = \"3 arcsec\"\n\n[site.drawn]");
    let scenario = Scenario::parse(&given, "s.toml", Path::new("."), &[]).unwrap();
    let draws = DrawnValues::of(&scenario, &Seeded(7));
    let resolved = scenario.to_resolved_toml(7, &draws);
    assert!(!resolved.contains("drawn]"), "{resolved}");
    let again = Scenario::parse(&resolved, "r.toml", Path::new("."), &[]).unwrap();
    let plant = scenario.plant(7, &draws);
    assert_eq!(again.plant(7, &DrawnValues::of(&again, &Seeded(7))), plant);
    // Draws add to what is given.
    let without = Scenario::parse(DRAWN, "s.toml", Path::new("."), &[]).unwrap();
    let less = without.plant(7, &draws);
    let arcsec = octant_earth::units::ARCSEC;
    let moved = plant.site.gravity.deflection_east_rad - less.site.gravity.deflection_east_rad;
    assert!((moved / arcsec - 3.0).abs() < 1e-9 && less.site.gravity.deflection_east_rad != 0.0);
}

#[test]
fn a_requirement_can_be_on_a_further_state() {
    let with = |limit: &str| {
        format!(
            "{LEVER}\n[[requirements]]\nid = \"L\"\ntext = \"The place of the proof mass is known.\"\n\
             measure = \"|calibration.further.accel_lever_zz.error|\"\nlimit = \"{limit}\"\n"
        )
    };
    assert_eq!(summary(&with("4 cm"))["requirements"][0]["verdict"], "pass");
    assert_eq!(summary(&with("1 um"))["requirements"][0]["verdict"], "fail");
    // Without the state there is no such number, which is never a pass.
    let without = with("4 cm").replace("accel_lever = { estimated = \"5 cm\" }\n", "");
    assert_eq!(summary(&without)["requirements"][0]["verdict"], "inconclusive");
}

#[test]
fn what_has_no_place_for_further_states_refuses_them() {
    let other =
        LEVER.replace("duration = \"1 h\"", "duration = \"1 h\"\nestimator = \"least-squares\"");
    let message = refused(&other);
    assert!(
        message.contains("procedure.calibration.further") && message.contains("\"kalman\""),
        "{message}"
    );
    let fmu = format!("{LEVER}\n[endpoint]\nuri = \"fmu:calibrator.fmu\"\n");
    let message = refused(&fmu);
    assert!(message.contains("endpoint.uri") && message.contains("\"in-process\""), "{message}");
    let both = LEVER
        .replace("{ estimated = \"5 cm\" }", "{ estimated = \"5 cm\", considered = \"1 cm\" }");
    assert!(refused(&both).contains("accel_lever"), "{}", refused(&both));
    let zero = LEVER.replace("{ estimated = \"5 cm\" }", "{ estimated = \"0 cm\" }");
    assert!(refused(&zero).contains("accel_lever.estimated"), "{}", refused(&zero));
    let swaying = LEVER.replace("[screening]", "[motion]\nkind = \"dockside\"\n\n[screening]").replace(
        "[procedure.calibration.further]",
        "[procedure.calibration.aiding]\nsway = \"coloured\"\n\n[procedure.calibration.further]",
    );
    assert!(refused(&swaying).contains("sway"), "{}", refused(&swaying));

    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), LEVER).unwrap();
    for (arguments, said) in [
        (vec!["design", "s.toml"], "procedure.calibration.further"),
        (vec!["fmu", "build", "--scenario", "s.toml", "--out", "f"], "further"),
    ] {
        let output = program(&arguments).current_dir(folder.path()).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(said), "{arguments:?}: {message}");
    }
    // Errors for which the Plant has no parameter.
    let plant = LEVER
        .replace("[procedure.calibration.further]\naccel_lever = { estimated = \"5 cm\" }\ngravity_anomaly = { considered = \"30 ug\" }\n", "")
        .replace("further = {}", "g_states = false")
        .replace("[imu]", "[site]\ndeflection_north = \"5 arcsec\"\n\n[imu]");
    std::fs::write(folder.path().join("s.toml"), plant).unwrap();
    let mut build = program(&["fmu", "build", "--scenario", "s.toml", "--out", "f"]);
    let output = build.current_dir(folder.path()).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("gravity disturbance"), "{message}");
    // The baseline isn't in the archive: its states are no obstacle.
    let baseline = LEVER
        .replace("[procedure.calibration.further]\naccel_lever = { estimated = \"5 cm\" }\ngravity_anomaly = { considered = \"30 ug\" }\n", "")
        .replace("further = {}", "further = { accel_lever = { estimated = \"5 cm\" } }");
    let scenario = Scenario::parse(&baseline, "s.toml", Path::new("."), &[]).unwrap();
    assert!(scenario.has_further_states(Method::Baseline));
    std::fs::write(folder.path().join("s.toml"), baseline).unwrap();
    let mut build = program(&["fmu", "build", "--scenario", "s.toml", "--out", "f"]);
    let output = build.current_dir(folder.path()).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{message}");
    assert!(folder.path().join("f/calibrator_s.csv").is_file());
}

/// An instrument that warms up by 5 K in half an hour.
const WARM: &str = r#"schema = 1
seed = 3

[imu]
rate = "50 Hz"

[imu.extensions.temperature]
ramp = "10 K/h"
plateau = "5 K"

[imu.extensions.drawn]
gyro_bias_temperature = { normal = "0.001 deg/h/K" }
gyro_scale_temperature = { normal = "5 ppm/K" }
accel_bias_temperature = { normal = "10 ug/K" }
accel_scale_temperature = { normal = "5 ppm/K" }

[screening]
gate = "off"
drift = "off"

[procedure.calibration]
duration = "1 h"

[procedure.calibration.further]
gyro_bias_temperature = { estimated = "0.001 deg/h/K" }
gyro_scale_temperature = { estimated = "5 ppm/K" }
accel_bias_temperature = { estimated = "10 ug/K" }
accel_scale_temperature = { estimated = "5 ppm/K" }

[baseline]
further = {}
"#;

#[test]
fn temperature_coefficients_are_found_as_well_as_was_predicted() {
    let run = summary(WARM);
    let further = run["calibration"]["further"].as_object().unwrap();
    assert_eq!(further.len(), 12);
    for (name, score) in further {
        assert!(score["normalized"].as_f64().unwrap().abs() < 4.0, "{name}: {score}");
    }
    let worst = |of: &Value| of["worst_normalized_error"].as_f64().unwrap();
    let (estimated, ignored) = (&run["calibration"], &run["baseline"]["calibration"]);
    assert!(worst(estimated) < 4.5 && worst(ignored) > 10.0, "{estimated} {ignored}");
    // A table has no place for them.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), WARM).unwrap();
    let done = program(&["run", "s.toml", "--out", "out"]).current_dir(folder.path()).output();
    assert_eq!(done.unwrap().status.code(), Some(0));
    assert!(!folder.path().join("out/calibration.octcal").exists());
    // The resolved scenario, with the drawn values as given ones, is the same instrument.
    let mut again = program(&["run", "out/scenario.toml", "--out", "again", "--json"]);
    let again = again.current_dir(folder.path()).output().unwrap();
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(again["stream_hash"], run["stream_hash"]);

    let scenario = Scenario::parse(WARM, "s.toml", Path::new("."), &[]).unwrap();
    let before = perfect::run(&scenario, Method::Primary).unwrap().further.unwrap();
    let predicted = json(folder.path(), &["observe", "s.toml", "--ensemble", "--json"]);
    for (index, name) in FURTHER_NAMES.iter().enumerate().filter(|(_, n)| further.contains_key(**n))
    {
        let unit = octant_sample::further::FurtherGroup::of(index).unwrap().si_per_unit();
        let sigma = further[*name]["sigma"].as_f64().unwrap();
        assert!((before.sigma[index] / unit / sigma - 1.0).abs() < 0.01, "{name}");
        let states = predicted[0]["states"].as_array().unwrap();
        let state = states.iter().find(|state| state["name"] == *name).unwrap();
        let [believed, achieved] = ["believed", "sigma"].map(|key| state[key].as_f64().unwrap());
        assert!((believed / sigma - 1.0).abs() < 0.01, "{name}: {believed} {sigma}");
        // Scale factors are drawn from less than the filter's prior, and each knows the other better for it.
        assert!((0.8..1.001).contains(&(achieved / believed)), "{name}: {achieved} {believed}");
    }
}

#[test]
fn temperature_that_nobody_tells_is_refused() {
    let on =
        "[procedure.calibration.further]\naccel_bias_temperature = { considered = \"1 ug/K\" }\n";
    let of =
        |text: &str| format!("schema = 1\n[procedure.calibration]\nduration = \"1 h\"\n{text}");
    let reference = of(&format!("{on}temperature_reference_c = 25.0\n"));
    let said = refused(&reference);
    assert!(said.contains("expected 20, its temperature at the start"), "{said}");
    assert!(Scenario::parse(&reference.replace("25.0", "20.0"), "s", Path::new(""), &[]).is_ok());
    let drawn = of("[imu.extensions.drawn]\ngyro_scale_temperature = { normal = \"1 ppm/K\" }\n");
    let said = refused(&drawn);
    assert!(said.contains("imu.extensions.drawn.gyro_scale_temperature"), "{said}");
    assert!(said.contains("expected [imu.extensions.temperature]"), "{said}");
    let both = of(&format!("{on}gimbal_angles = {{}}\n"));
    assert!(refused(&both).contains("expected one of the two"));

    // A recording of a run has samples alone.
    let folder = tempfile::tempdir().unwrap();
    let text = "schema = 1\n[imu]\nrate = \"50 Hz\"\n[record]\nsamples = \"full\"\n[procedure.calibration]\nduration = \"60 s\"\nstops = [{}]\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    std::fs::write(folder.path().join("replay.toml"), format!("{text}{on}")).unwrap();
    let run = |arguments: &[&str]| {
        let output = program(arguments).current_dir(folder.path()).output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (_, said) = run(&["run", "s.toml", "--out", "out"]);
    let source = "replay:out/recording.mcap";
    let (status, refused) = run(&["run", "replay.toml", "--source", source, "--out", "again"]);
    assert_eq!(status, Some(4), "{refused} {said}");
    assert!(
        refused.contains("failed to tell the filter the temperature: the source has none"),
        "{refused}"
    );
}
