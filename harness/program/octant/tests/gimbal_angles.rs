//! Gimbal angles as measurements, from the scenario to the summary.

use crate::common::program::program;
use octant_observe::perfect;
use octant_sample::further::{DRIVING_COUNT, FURTHER_NAMES};
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario};
use serde_json::Value;
use std::path::Path;

/// Gimbals with every error that the seed draws, and a filter that estimates each. The screen for jumps takes noise of
/// the encoders in a move for an edge and opens the attitude, which the perfect instrument of `octant observe` lacks: off.
const GIMBALS: &str = r#"schema = 1
title = "gimbals"
seed = 3

[imu]
rate = "50 Hz"

[turntable]
encoder_error = "0 arcsec"
encoder_noise = "1 arcsec"
encoder_zero = ["15 arcsec", "-5 arcsec"]
mounting = ["0 arcsec", "10 arcsec", "20 arcsec"]

[turntable.drawn]
mounting = { normal = "60 arcsec" }
non_orthogonality = { normal = "20 arcsec" }
eccentricity = { normal = "10 arcsec" }

[screening]
jumps = "off"

[procedure.calibration]
duration = "1 h"

[procedure.calibration.further.gimbal_angles]
sigma = "1 arcsec"
mounting = { estimated = "60 arcsec" }
non_orthogonality = { estimated = "20 arcsec" }
eccentricity = { estimated = "10 arcsec" }
"#;

fn parsed(text: &str) -> Scenario {
    Scenario::parse(text, "s.toml", Path::new("."), &[]).unwrap()
}

fn refused(text: &str) -> String {
    Scenario::parse(text, "s.toml", Path::new("."), &[]).unwrap_err().to_string()
}

fn summary(text: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let mut run = program(&["run", "s.toml", "--out", "out", "--json"]);
    let output = run.current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"))
}

/// The errors of the gimbals are found; `octant observe` has said how well; and how much better the gyros' scale factors are by them.
#[test]
fn errors_of_the_gimbals_are_in_the_summary_and_as_observed() {
    let (without, table) = GIMBALS.split_once("\n[procedure.calibration.further").unwrap();
    assert!(table.starts_with(".gimbal_angles]"));
    let summary = summary(GIMBALS);
    let further = summary["calibration"]["further"].as_object().unwrap();
    let names: Vec<&str> = further.keys().map(String::as_str).collect();
    let mut expected = FURTHER_NAMES[DRIVING_COUNT..].to_vec();
    expected.sort_unstable();
    assert_eq!(names, expected);
    let scenario = parsed(GIMBALS);
    let truth = scenario.true_further(&DrawnValues::of(&scenario, &Seeded(3)));
    let found = perfect::run(&scenario, Method::Primary).unwrap();
    for (index, name) in FURTHER_NAMES.iter().enumerate().skip(DRIVING_COUNT) {
        let score = &further[*name];
        let arcsec = octant_earth::units::ARCSEC;
        let of_truth = score["true"].as_f64().unwrap() * arcsec;
        assert!((of_truth - truth[index].unwrap()).abs() < 1e-12, "{name}");
        assert!(score["normalized"].as_f64().unwrap().abs() < 4.0, "{name}: {score}");
        let before = found.further.unwrap().sigma[index] / arcsec;
        assert!((before / score["sigma"].as_f64().unwrap() - 1.0).abs() < 0.01, "{name}: {before}");
    }
    let plain = perfect::run(&parsed(without), Method::Primary).unwrap();
    for (index, name) in NAMES.iter().enumerate() {
        let unit = ParameterGroup::of(index).si_per_unit();
        let sigma = summary["calibration"]["parameters"][*name]["sigma"].as_f64().unwrap();
        let before = found.parameters[index] / unit;
        assert!((before / sigma - 1.0).abs() < 0.01, "{name}: {before} {sigma}");
        println!(
            "{name:12} σ {:.4e} without angles, {before:.4e} with",
            plain.parameters[index] / unit
        );
        assert!(
            before < 1.001 * plain.parameters[index] / unit,
            "angles can't take knowledge away"
        );
    }
    // A move that the angles measure shows a scale factor at once.
    let largest = |all: &[f64]| {
        all[ParameterGroup::GyroScale.range()]
            .iter()
            .fold(0.0f64, |largest, sigma| largest.max(*sigma))
    };
    assert!(largest(&found.parameters) < 0.6 * largest(&plain.parameters));
}

/// An encoder that slips refuses the calibration, and says why.
#[test]
fn a_slip_of_an_encoder_refuses_the_calibration() {
    let slip = format!(
        "{GIMBALS}\n[[faults]]\nid = \"slip\"\nkind = \"encoder-slip\"\ngimbal = \"roll\"\nangle = \"0.05 deg\"\n\
         trigger = {{ at = \"2000 s\" }}\n"
    );
    let summary = summary(&slip);
    let text = summary.to_string();
    assert!(text.contains("gimbal angles are measurements and contradict the gyros"), "{text}");
}

#[test]
fn a_resolved_scenario_has_the_gimbals_that_were_drawn() {
    let scenario = parsed(GIMBALS);
    let draws = DrawnValues::of(&scenario, &Seeded(7));
    let resolved = scenario.to_resolved_toml(7, &draws);
    assert!(!resolved.contains("drawn]"), "{resolved}");
    let again = parsed(&resolved);
    let (plant, same) =
        (scenario.plant(7, &draws), again.plant(7, &DrawnValues::of(&again, &Seeded(7))));
    let [a, b] = [&plant, &same].map(|plant| {
        let (table, errors) = (&plant.turntable, &plant.turntable.errors);
        let mut all = vec![table.non_orthogonality_rad, errors.encoder_noise_rad];
        all.extend(errors.mounting_rad);
        all.extend(errors.encoder_zero_rad);
        all.extend(errors.eccentricity_rad.as_flattened());
        all
    });
    for (index, (a, b)) in a.iter().zip(&b).enumerate() {
        assert!(*a != 0.0 && (a - b).abs() < 1e-15, "{index}: {a} {b}");
    }
}

#[test]
fn what_has_no_place_for_gimbal_angles_refuses_them() {
    let ship = GIMBALS.replace("[imu]", "[motion]\nkind = \"dockside\"\n\n[imu]");
    let message = refused(&ship);
    assert!(message.contains("gimbal_angles") && message.contains("\"static\""), "{message}");
    let fmu = format!("{GIMBALS}\n[endpoint]\nuri = \"fmu:calibrator.fmu\"\n");
    let message = refused(&fmu);
    assert!(message.contains("endpoint.uri") && message.contains("\"in-process\""), "{message}");
    let zero = GIMBALS.replace("sigma = \"1 arcsec\"", "sigma = \"0 arcsec\"");
    assert!(refused(&zero).contains("gimbal_angles.sigma"), "{}", refused(&zero));
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), GIMBALS).unwrap();
    let (plain, _) = GIMBALS.split_once("\n[procedure.calibration.further").unwrap();
    std::fs::write(folder.path().join("p.toml"), plain).unwrap();
    for (arguments, said) in [
        (vec!["observe", "s.toml", "--ensemble"], "gimbal_angles"),
        (vec!["design", "s.toml"], "procedure.calibration.further"),
        (vec!["fmu", "build", "--scenario", "s.toml", "--out", "f"], "further"),
        (vec!["fmu", "build", "--scenario", "p.toml", "--out", "f"], "mounting"),
    ] {
        let output = program(&arguments).current_dir(folder.path()).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(said), "{arguments:?}: {message}");
    }
}
