//! Text of rates with missing rows: a calibration at rest publishes what it publishes without the gaps. Text without
//! times: all who read the run are told.

use crate::common::program::{ends, json};
use std::fmt::Write;
use std::path::Path;

/// Rate of the rows, Hz.
const RATE_HZ: u64 = 50;
/// Lost rows: four gaps of one second.
const GAPS_S: [u64; 4] = [120, 160, 200, 240];

const SCENARIO: &str = "schema = 1
[site]
latitude = \"30.5 deg\"
longitude = \"114 deg\"
[imu]
rate = \"50 Hz\"
[procedure.alignment]
method = \"inertial\"
[procedure.calibration]
duration = \"11 min\"
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }]
[source]
uri = \"text:unit.csv\"
[source.reference]
kind = \"static\"
[source.text]
header = true
delimiter = \"comma\"
time_column = \"t\"
time_unit = \"s\"
[source.text.gyro]
x = \"gx\"
y = \"gy\"
z = \"gz\"
unit = \"rad/s\"
quantity = \"rate\"
[source.text.accelerometer]
x = \"ax\"
y = \"ay\"
z = \"az\"
unit = \"m/s^2\"
quantity = \"rate\"
";

/// Rates of an instrument without errors that stands level and heads north, and white noise of a fixed sequence.
fn rows(has_gaps: bool) -> String {
    const EARTH_RATE_RADPS: f64 = 7.292_115e-5;
    let latitude_rad = 30.5_f64.to_radians();
    let (sine, cosine) = latitude_rad.sin_cos();
    let true_rates = [EARTH_RATE_RADPS * cosine, 0.0, -EARTH_RATE_RADPS * sine, 0.0, 0.0, -9.79];
    let mut state = 1_u64;
    let mut uniform = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut text = String::from("t,gx,gy,gz,ax,ay,az\n");
    for row in 0..RATE_HZ * 700 {
        // Drawn for lost rows too, so that the others are the same rows.
        let noise: [f64; 6] = std::array::from_fn(|axis| {
            // A sum of four uniform numbers has a standard deviation of 1/√3.
            let sum = uniform() + uniform() + uniform() + uniform();
            sum * 3_f64.sqrt() * if axis < 3 { 1e-6 } else { 1e-3 }
        });
        if has_gaps && GAPS_S.contains(&(row / RATE_HZ)) {
            continue;
        }
        write!(text, "{:.3}", row as f64 / RATE_HZ as f64).unwrap();
        for (rate, noise) in true_rates.iter().zip(noise) {
            write!(text, ",{:.12e}", rate + noise).unwrap();
        }
        text.push('\n');
    }
    text
}

/// Runs the rows; returns the estimates with their σ, and what the terminal was told.
fn calibrated(folder: &Path, name: &str, has_gaps: bool) -> (Vec<(String, f64, f64)>, String) {
    let folder = folder.join(name);
    std::fs::create_dir(&folder).unwrap();
    let (scenario, out) = (folder.join("s.toml"), folder.join("out"));
    std::fs::write(folder.join("unit.csv"), rows(has_gaps)).unwrap();
    std::fs::write(&scenario, SCENARIO).unwrap();
    let (_, told) = ends(&["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()], 0);
    let summary = json(&out.join("summary.json"));
    assert_eq!(summary["calibration"]["refused"], serde_json::Value::Null, "{summary}");
    let parameters = summary["calibration"]["parameters"].as_object().unwrap();
    let parameters = parameters.iter().map(|(name, value)| {
        let number = |key: &str| value[key].as_f64().unwrap();
        (name.clone(), number("estimate"), number("sigma"))
    });
    (parameters.collect(), told)
}

#[test]
fn four_gaps_of_a_second_move_no_parameter() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, told) = calibrated(folder.path(), "whole", false);
    assert!(told.contains("unit.csv: 33000 rows read, all used\n"), "{told}");
    let (gaps, told) = calibrated(folder.path(), "gaps", true);
    assert!(
        told.contains(
            "missing: 200 rows in 4 gaps, the longest 1 s, the first before line 6002, after the one of 119.98 s; the core \
             bridges it"
        ),
        "{told}"
    );
    let summary = json(&folder.path().join("gaps/out/summary.json"));
    let account = &summary["inputs"][0];
    assert_eq!((&account["read"], &account["used"]), (&32_800.into(), &32_800.into()), "{account}");
    assert_eq!(account["missing"][0]["count"], 200, "{account}");
    let manifest = json(&folder.path().join("gaps/out/manifest.json"));
    assert_eq!(manifest["bench"]["readings"]["missing"], 200, "{manifest}");
    for ((name, whole, sigma), (_, gaps, _)) in whole.iter().zip(&gaps) {
        let moved = (gaps - whole).abs() / sigma;
        // A gap in a dwell is bridged by the known rest, and four seconds of 660 are lost.
        assert!(moved < 0.3, "{name} moved by {moved:.2} sigma");
    }
    let (_, bias, sigma) = gaps.iter().find(|(name, ..)| name == "gyro_bias_x").unwrap();
    assert!((bias / sigma).abs() < 4.0, "{bias} ± {sigma} deg/h, true 0");
}

/// Rows without a time.
const UNTIMED: &str = "schema = 1
[imu]
rate = \"50 Hz\"
[procedure.alignment]
method = \"given\"
[procedure.navigation]
duration = \"1 s\"
rotation = \"none\"
[source]
uri = \"text:unit.txt\"
[source.text]
time_column = \"none\"
rate = \"50 Hz\"
[source.text.gyro]
x = 1
y = 2
z = 3
[source.text.accelerometer]
x = 4
y = 5
z = 6
";

#[test]
fn rows_without_a_time_have_their_number_over_the_rate_and_all_who_read_it_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let (scenario, out) = (folder.path().join("s.toml"), folder.path().join("out"));
    std::fs::write(folder.path().join("unit.txt"), "1e-5 0 0 0 0 9.81\n".repeat(60)).unwrap();
    let run = ["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()];
    std::fs::write(&scenario, UNTIMED).unwrap();
    ends(&run, 0);
    let expected =
        "no time stamps: the time is assumed, not measured, the row\u{2019}s number over 50 Hz"
            .replace('\u{2019}', "'");
    let manifest = json(&out.join("manifest.json"));
    assert_eq!(manifest["inputs"][0]["time"], expected.as_str(), "{manifest}");
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.replace("&#39;", "'").contains(&expected));
    // The rate has to be written, and a time can't be a measured value.
    for (from, to, expected) in [
        (
            "rate = \"50 Hz\"\n[source.text.gyro]",
            "[source.text.gyro]",
            "source.text.rate: missing, expected the rate of the rows: time_column is \"none\", and the time of a \
             row is its number over the rate",
        ),
        (
            "time_column = \"none\"\n",
            "",
            "source.text.time_column: found a column of a gyro or accelerometer, expected one of times, or \"none\" with \
             source.text.rate",
        ),
        (
            "time_column = \"none\"\n",
            "time_column = 5\n",
            "source.text.time_column: found a column of a gyro or accelerometer",
        ),
    ] {
        std::fs::write(&scenario, UNTIMED.replacen(from, to, 1)).unwrap();
        let (_, said) = ends(&run, 2);
        assert!(said.contains(expected), "{said}");
    }
}
