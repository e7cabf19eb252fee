//! Noise of the sensors at rest: in the summary of every run, of the size that the instrument has, drawn in
//! the report.

use crate::common::program::{ended, json, octant_in};
use octant_run::{StreamKeeping, assemble, run_method};
use octant_scenario::{Method, Scenario};
use serde_json::Value;
use std::f64::consts::{LN_2, PI};
use std::path::Path;

/// Two hours of calibration in three positions, and half an hour of navigation with rotation, at 50 Hz.
const TURNING: &str = r#"
schema = 1
title = "noise at rest"
seed = 5
[imu]
rate = "50 Hz"
[imu.extensions]
gyro_quantization = "0.01 arcsec"
accel_bias_instability = "8 ug"
[procedure.calibration]
duration = "2 h"
stops = [
    { azimuth = "0 deg", roll = "0 deg" },
    { azimuth = "0 deg", roll = "90 deg" },
    { azimuth = "90 deg", roll = "90 deg" },
]
[procedure.navigation]
duration = "30 min"
rotation = "sixteen"
"#;

fn run(folder: &Path, name: &str, text: &str, more: &[&str]) -> Value {
    let file = format!("{name}.toml");
    std::fs::write(folder.join(&file), text).unwrap();
    let run = [&["run", &file, "--out", name], more].concat();
    ended(octant_in(folder, &run), 0);
    json(&folder.join(name).join("summary.json"))
}

fn numbers(row: &Value) -> Vec<f64> {
    row.as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect()
}

/// Rows of an axis.
fn series(summary: &Value, sensor: &str, axis: &str) -> Vec<Vec<f64>> {
    let rows = &summary["allan_deviation"][sensor][axis]["series"];
    rows.as_array().unwrap().iter().map(numbers).collect()
}

#[test]
fn the_noise_of_a_run_is_that_of_its_instrument() {
    let folder = tempfile::tempdir().unwrap();
    let summary = run(folder.path(), "turning", TURNING, &[]);
    let allan = &summary["allan_deviation"];
    assert_eq!((&allan["sample_period_s"], &allan["base_moves"]), (&0.02.into(), &false.into()));
    // Three dwells of the calibration; of the navigation six of five minutes, the first of which goes on
    // from the last one of the calibration if the rotation begins where that ends.
    let stretches = allan["stretches"].as_u64().unwrap();
    assert!((8..=9).contains(&stretches), "{stretches}");
    let [at_rest_s, longest_s] = ["at_rest_s", "longest_s"].map(|key| allan[key].as_f64().unwrap());
    assert!((8700.0..9000.0 - 2.0 * 8.0).contains(&at_rest_s), "{at_rest_s} s");
    assert!((2380.0..2800.0).contains(&longest_s), "{longest_s} s");

    // deg/h and µg, from the definitions of IEEE Std 952.
    let gyro = |tau: f64| {
        let walk = 0.0007 * 60.0 / tau.sqrt();
        let quantization = 3.0f64.sqrt() * 0.01 / 12.0f64.sqrt() / tau;
        (walk * walk + quantization * quantization).sqrt()
    };
    let accelerometer = |tau: f64| (2500.0 / tau + 2.0 * LN_2 / PI * 64.0).sqrt();
    for axis in ["x", "y", "z"] {
        let truths: [(&str, &dyn Fn(f64) -> f64); 2] =
            [("gyro", &gyro), ("accelerometer", &accelerometer)];
        for (sensor, truth) in truths {
            let rows = series(&summary, sensor, axis);
            assert!(rows.len() >= 15, "{} octaves", rows.len());
            for row in &rows {
                let [tau, deviation, low, high, freedom] = row[..] else { panic!("{row:?}") };
                assert!(low < deviation && deviation < high, "{row:?}");
                // Five standard errors of a deviation; a process of the bias instability of 2 s is the
                // shortest, so that the floor is lower before.
                let bound = 5.0 / (2.0 * freedom).sqrt() + 0.02;
                if freedom > 40.0 {
                    let ratio = deviation / truth(tau);
                    assert!((ratio - 1.0).abs() < bound, "{sensor} {axis}, {tau} s: {ratio}");
                }
            }
        }
        let terms = |sensor: &str, term: &str| allan[sensor][axis]["terms"][term].clone();
        for (sensor, term, truth, unit) in [
            ("gyro", "random_walk", 0.0007, "deg/sqrt(h)"),
            ("gyro", "quantization", 0.01 / 12.0f64.sqrt(), "arcsec"),
            ("accelerometer", "random_walk", 50.0, "ug/sqrt(Hz)"),
            ("accelerometer", "bias_instability", 8.0, "ug"),
        ] {
            let found = terms(sensor, term);
            assert_eq!(found["unit"], unit);
            assert!((found["true"].as_f64().unwrap() / truth - 1.0).abs() < 1e-9, "{found}");
            let [estimate, low, high] =
                ["estimate", "low", "high"].map(|key| found[key].as_f64().unwrap());
            // Twice the interval of 95 %: four standard errors.
            let (down, up) = (estimate - low, high - estimate);
            assert!((estimate - 2.0 * down..=estimate + 2.0 * up).contains(&truth), "{found}");
        }
        let ramp = terms("gyro", "rate_ramp");
        assert_eq!((&ramp["true"], &ramp["unit"]), (&0.0.into(), &"deg/h/h".into()));
    }

    let page = std::fs::read_to_string(folder.path().join("turning/report.html")).unwrap();
    for title in ["Gyro x, deg/h", "Accelerometer z, ug"] {
        assert!(page.contains(&format!("aria-label=\"{title}\"")), "{title}");
    }
    let (said, _) =
        ended(octant_in(folder.path(), &["report", "turning", "--out", "again.html"]), 0);
    let again = std::fs::read_to_string(folder.path().join("again.html")).unwrap();
    let section = |page: &str, id: &str| -> String {
        let page = page.split(&format!("id=\"{id}\"")).nth(1).unwrap();
        page.split("</section>").next().unwrap().to_owned()
    };
    assert_eq!(section(&page, "noise"), section(&again, "noise"), "{said}");
}

/// The series before faults is that of the twin, bit for bit, as long as no fault moves the gimbals.
#[test]
fn faults_do_not_get_into_the_noise() {
    let folder = tempfile::tempdir().unwrap();
    let fault = "[[faults]]\nid = \"noisy\"\nkind = \"noise-gain\"\nchannels = \"gyro\"\ngain = \"300 %\"\n\
                 trigger = { at = \"10 min\" }\nduration = \"1 min\"\n";
    let plain = TURNING.replace("\"2 h\"", "\"40 min\"").replace("\"30 min\"", "\"5 min\"");
    let clean = run(folder.path(), "clean", &plain, &[]);
    let faulted = run(folder.path(), "faulted", &format!("{plain}{fault}"), &[]);
    assert_ne!(clean["stream_hash"], faulted["stream_hash"]);
    assert_eq!(clean["allan_deviation"], faulted["allan_deviation"]);
    assert!(!clean["allan_deviation"].is_null());
}

#[test]
fn on_a_ship_the_deviation_is_that_of_the_motion() {
    let folder = tempfile::tempdir().unwrap();
    let text = "schema = 1\n[imu]\nrate = \"20 Hz\"\n[motion]\nkind = \"dockside\"\n\
                [procedure.calibration]\nduration = \"1 h\"\n";
    let summary = run(folder.path(), "ship", text, &[]);
    let allan = &summary["allan_deviation"];
    assert_eq!(allan["base_moves"], true);
    for sensor in ["gyro", "accelerometer"] {
        assert_eq!(allan[sensor]["x"]["terms"], Value::Object(Default::default()));
        assert!(allan[sensor]["x"]["misfit"].is_null());
    }
    // The roll of 3° in 8 s is a thousand times the noise.
    let rows = series(&summary, "gyro", "x");
    let at_3_s = rows.iter().find(|row| (row[0] - 3.2).abs() < 0.1).unwrap();
    assert!(at_3_s[1] > 1000.0, "{at_3_s:?}");
    let page = std::fs::read_to_string(folder.path().join("ship/report.html")).unwrap();
    assert!(page.contains("The base may move.") && !page.contains("Noise terms"));
}

/// Cases of campaigns have no report of their own.
#[test]
fn a_run_without_a_report_keeps_none_of_it() {
    let text = TURNING.replace("\"2 h\"", "\"40 min\"").replace("\"30 min\"", "\"5 min\"");
    let scenario = Scenario::parse(&text, "turning.toml", Path::new(""), &[]).unwrap();
    let one = |keeping: StreamKeeping<'_>| {
        let run = run_method(&scenario, Method::Primary, 5, keeping, &Default::default()).unwrap();
        assemble(&scenario, 5, run, None).unwrap().summary
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("recording.mcap");
    let (case, kept) = (one(StreamKeeping::HashAlone), one(StreamKeeping::File(&file)));
    assert_eq!(case.stream_hash, kept.stream_hash);
    assert_eq!(case.allan_deviation, None);
    assert!(kept.allan_deviation.is_some());
    assert!(case.calibration.unwrap().sigma_hours.is_empty());
    let kept = kept.calibration.unwrap();
    assert!((350..=402).contains(&kept.sigma_hours.len()), "{}", kept.sigma_hours.len());
}

/// The σ over the calibration begins below the prior and ends with that of the solution.
#[test]
fn the_sigma_of_the_filter_ends_with_that_of_the_solution() {
    let folder = tempfile::tempdir().unwrap();
    let text = TURNING.replace("\"2 h\"", "\"40 min\"").replace("\"30 min\"", "\"5 min\"");
    let summary = run(folder.path(), "turning", &text, &[]);
    let calibration = &summary["calibration"];
    let rows: Vec<Vec<f64>> =
        calibration["sigma_hours"].as_array().unwrap().iter().map(numbers).collect();
    assert!(rows.windows(2).all(|pair| pair[0][0] < pair[1][0]), "hours go forward");
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    let names = [
        "heading_arcmin",
        "pitch_arcmin",
        "roll_arcmin",
        "velocity_north_mps",
        "velocity_east_mps",
    ];
    for (column, name) in names.into_iter().enumerate() {
        let sigma = |solution: &Value| solution[name]["sigma"].as_f64().unwrap();
        let (prior, end) =
            (sigma(&summary["alignment"]["solution"]), sigma(&calibration["solution"]));
        assert!(first[column + 1] <= prior * 1.001, "{name}: {first:?}, prior {prior}");
        // The last row may be six seconds before the end.
        assert!((last[column + 1] / end - 1.0).abs() < 0.05, "{name}: {last:?}, {end} at the end");
    }
    let page = std::fs::read_to_string(folder.path().join("turning/report.html")).unwrap();
    assert!(page.contains("±σ of the filter"));
    ended(octant_in(folder.path(), &["report", "turning", "--out", "again.html"]), 0);
    let again = std::fs::read_to_string(folder.path().join("again.html")).unwrap();
    assert_eq!(page.matches("±σ of the filter").count(), again.matches("±σ of the filter").count());
}
