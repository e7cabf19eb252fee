//! `octant characterise`: a recording of a run at rest, its files, and input that it refuses.

use crate::common::program::{ended, octant_in};
use octant_instruments::{AnyEncoder, Protocol, Reading, Stamp, StampClock};
use octant_random::stream::Triad;
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};
use std::fmt::Write as _;

const AT_REST: &str = "schema = 1\ntitle = \"at rest\"\n[imu]\nrate = \"50 Hz\"\n[procedure.calibration]\n\
    duration = \"4 min\"\nname = \"one attitude\"\nstops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }]\n\
    [record]\nsamples = \"full\"\n";

#[test]
fn a_run_at_rest_is_characterised_and_its_instrument_runs() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("rest.toml"), AT_REST).unwrap();
    let call = |arguments: &[&str], status| ended(octant_in(here, arguments), status);
    octant_in(here, &["run", "rest.toml", "--out", "rest"]);
    let files = ["--imu", "imu.toml", "--html", "page.html"];
    let (out, _) = call(&[&["characterise", "rest"][..], &files].concat(), 0);
    assert!(out.contains("240 s at 50 Hz, 240 s at rest in 1 stretch"), "{out}");
    assert!(out.contains("simulated twin, seed 1"), "{out}");
    let page = std::fs::read_to_string(here.join("page.html")).unwrap();
    assert!(
        page.starts_with("<!DOCTYPE html>")
            && !page.contains("http://")
            && !page.contains("src=\"https")
    );
    // Files stay as they are without --force.
    let (_, said) = call(&[&["characterise", "rest"][..], &files].concat(), 2);
    assert!(said.contains("imu.toml: it exists"), "{said}");
    call(&["run", "imu.toml", "--set", "procedure.calibration.duration=1 h", "--out", "twin"], 0);
    let (out, _) = call(&["characterise", "rest/recording.mcap", "--no-twin", "--json"], 0);
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&json["schema"], &json["twin"]), (&1.into(), &serde_json::Value::Null));
}

#[test]
fn what_is_no_recording_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("plant.toml"), AT_REST).unwrap();
    std::fs::write(here.join("noise.mcap"), [7u8; 300]).unwrap();
    for (recording, words) in [
        ("plant.toml", "its source.uri is the plant"),
        ("noise.mcap", "noise.mcap"),
        ("missing.csv", "missing.csv"),
        ("missing", "missing"),
    ] {
        let (_, said) = ended(octant_in(here, &["characterise", recording]), 2);
        assert!(said.contains(words), "{recording}: {said}");
    }
}

/// Columns of another program's names, its axes forward, right and down for a body of forward, left and up.
const NAMED: &str = "
[source]
uri = \"text:unit.csv\"
[source.reference]
kind = \"static\"
[source.text]
delimiter = \"comma\"
header = true
time_column = \"device_time_s\"
[source.text.gyro]
x = \"GyroXCalib\"
y = \"GyroYCalib\"
z = \"GyroZCalib\"
unit = \"rad\"
quantity = \"increment\"
axes = [\"x\", \"-y\", \"-z\"]
[source.text.accelerometer]
x = \"AccelYCalib\"
y = \"AccelXCalib\"
z = \"AccelZCalib\"
unit = \"m/s\"
quantity = \"increment\"
axes = [\"y\", \"x\", \"z\"]
";

#[test]
fn channels_have_the_names_of_the_files_columns() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("rest.toml"), AT_REST).unwrap();
    octant_in(here, &["run", "rest.toml", "--out", "rest"]);
    octant_in(here, &["export", "rest", "--to", "csv", "--tables", "samples", "--out", "csv"]);
    let mut text = std::fs::read_to_string(here.join("csv/samples.csv")).unwrap();
    for axis in ["x", "y", "z"] {
        let capital = axis.to_uppercase();
        text = text
            .replacen(&format!("delta_theta_{axis}_rad"), &format!("Gyro{capital}Calib"), 1)
            .replacen(&format!("delta_velocity_{axis}_mps"), &format!("Accel{capital}Calib"), 1);
    }
    std::fs::write(here.join("unit.csv"), text).unwrap();
    std::fs::write(here.join("unit.toml"), format!("{AT_REST}{NAMED}")).unwrap();
    let call = |arguments: &[&str], status| ended(octant_in(here, arguments), status);
    let (out, _) = call(&["characterise", "unit.toml", "--html", "page.html"], 0);
    let lines: Vec<&str> = out.lines().collect();
    // Body x is the instrument's x; its accelerometer x is the instrument's y, whose key names the column of x.
    for words in [
        "gyro x, y, z: columns of the file",
        "x: GyroXCalib",
        "y: −GyroYCalib",
        "z: −GyroZCalib",
        "x: AccelXCalib",
        "y: AccelYCalib",
        "z: AccelZCalib",
        "gyro_y (−GyroYCalib) ",
        "accelerometer_x (AccelXCalib) ",
    ] {
        assert!(lines.iter().any(|line| line.contains(words)), "{words}: {out}");
    }
    let page = std::fs::read_to_string(here.join("page.html")).unwrap();
    for words in
        [">y (−GyroYCalib)<", "<td>gyro_z (−GyroZCalib)</td>", "Gyro x (GyroXCalib), deg/h"]
    {
        assert!(page.contains(words), "{words}");
    }
    // One legend for the small charts of a section: in each of them it would leave no room for the title.
    assert_eq!(page.matches("<span class=\"legend\">").count(), 2);
    let (out, _) = call(&["characterise", "unit.toml", "--no-twin", "--json"], 0);
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    let names =
        ["GyroXCalib", "−GyroYCalib", "−GyroZCalib", "AccelXCalib", "AccelYCalib", "AccelZCalib"];
    assert_eq!(json["names_in_file"], serde_json::json!(names));
    // A table of octant export has the names of the channels, and they aren't repeated.
    let (out, _) = call(&["characterise", "csv/samples.csv", "--no-twin"], 0);
    assert!(!out.contains("columns of the file") && !out.contains("delta_theta"), "{out}");
}

/// Scenario of a unit at rest whose gyro x follows its temperature.
const WARM: &str = "schema = 1
[imu]
rate = \"50 Hz\"
[procedure.calibration]
duration = \"4 min\"
name = \"one attitude\"
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }]
[source]
uri = \"text:warm.csv\"
[source.reference]
kind = \"static\"
[source.text]
delimiter = \"comma\"
header = true
time_column = \"t\"
temperature_column = \"warm\"
temperature_unit = \"K\"
gyro = { x = \"wx\", y = \"wy\", z = \"wz\" }
accelerometer = { x = \"ax\", y = \"ay\", z = \"az\" }
";

/// Rates and temperature, °C, of a unit at rest for 300 s: 1e-5 rad/s/K in gyro x.
fn warm() -> impl Iterator<Item = (f64, [f64; 6], f64)> {
    let normals = ["gyro", "accelerometer"].map(|name| Triad::new(3, name));
    (1..=15_000u64).map(move |k| {
        let t_s = k as f64 / 50.0;
        let temperature = 25.0 + 5.0 * (t_s / 20.0).sin();
        let [w, f] = normals.each_ref().map(|normal| normal.at(k));
        let rates = [
            1e-5 * (temperature - 25.0) + 1e-5 * w[0],
            1e-5 * w[1],
            1e-5 * w[2],
            1e-3 * f[0],
            1e-3 * f[1],
            9.8 + 1e-3 * f[2],
        ];
        (t_s, rates, temperature)
    })
}

#[test]
fn a_temperature_in_a_text_and_in_an_instruments_bytes_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let mut text = "t,wx,wy,wz,ax,ay,az,warm\n".to_owned();
    let (mut bytes, mut encoder) = (Vec::new(), AnyEncoder::new(Protocol::Xsens));
    for (number, (t_s, rates, temperature)) in (1..).zip(warm()) {
        let rates_of = rates.map(|rate| format!("{rate:e}")).join(",");
        let _ = writeln!(text, "{t_s:.2},{rates_of},{:.3}", temperature + 273.15);
        let ns = number * 20_000_000;
        let counts =
            |at: usize, lsb: f64| [0, 1, 2].map(|k| (rates[at + k] * 0.02 / lsb).round() as i32);
        let sample = Sample {
            sequence: number,
            device_time: DeviceTime { ns },
            delta_theta: counts(0, octant_sample::counts::DELTA_THETA_LSB_RAD),
            delta_velocity: counts(3, octant_sample::counts::DELTA_VELOCITY_LSB_MPS),
            gimbal: GimbalAngles::default(),
            status: Status::empty(),
        };
        let reading = Reading {
            stamp: Some(Stamp { ns, clock: StampClock::Startup }),
            interval_s: Some(0.02),
            temperature_c: Some(temperature as f32),
            ..Reading::of_sample(&sample)
        };
        bytes.extend(encoder.encode(&reading).unwrap());
    }
    std::fs::write(here.join("warm.csv"), &text).unwrap();
    std::fs::write(here.join("unit.bin"), bytes).unwrap();
    std::fs::write(here.join("warm.toml"), WARM).unwrap();
    let (head, _) = WARM.split_once("[source.text]").unwrap();
    let log =
        head.replace("text:warm.csv", "log:unit.bin") + "[source.log]\nprotocol = \"xsens\"\n";
    std::fs::write(here.join("log.toml"), log).unwrap();
    for scenario in ["warm.toml", "log.toml"] {
        let call = ["characterise", scenario, "--json", "--imu", "imu.toml", "--force"];
        let (out, _) = ended(octant_in(here, &call), 0);
        let json: serde_json::Value = serde_json::from_str(&out).unwrap();
        let fit = &json["temperature"]["channels"][0];
        let [low, high] = [0, 1].map(|end| fit["interval"][end].as_f64().unwrap());
        assert!(low < 1e-5 && 1e-5 < high && high - low < 1e-6, "{scenario}: {fit}");
        assert_eq!(json["temperature"]["channels"].as_array().unwrap().len(), 6);
        let imu = std::fs::read_to_string(here.join("imu.toml")).unwrap();
        assert!(imu.contains("[imu.extensions.temperature]\nramp = "), "{imu}");
        // A filter may refuse an instrument that warms up; the scenario is read all the same.
        let hour = ["--set", "procedure.calibration.duration=1 h", "--out", "twin", "--force"];
        let run = octant_in(here, &[&["run", "imu.toml"][..], &hour].concat());
        assert!(matches!(run.status.code(), Some(0 | 1)), "{run:?}");
    }
    let (out, _) = ended(octant_in(here, &["characterise", "warm.toml", "--no-twin"]), 0);
    assert!(out.contains("degC, bias per kelvin, [interval of 95 %]"), "{out}");
    std::fs::write(here.join("warm.csv"), text.replacen(",298.", ",25.", 1)).unwrap();
    let (_, said) = ended(octant_in(here, &["characterise", "warm.toml"]), 2);
    assert!(
        said.contains("warm.csv: line 2: column 8: temperature 25.")
            && said.contains("expected 173.15 to 473.15 K"),
        "{said}"
    );
    let call = ["characterise", "warm.toml", "--set", "source.text.temperature_column=cold"];
    let (_, said) = ended(octant_in(here, &call), 2);
    assert!(said.contains("warm.csv: line 1: no column \"cold\", found t, wx"), "{said}");
}

#[test]
fn a_scenario_needs_only_the_columns() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("rest.toml"), AT_REST).unwrap();
    octant_in(here, &["run", "rest.toml", "--out", "rest"]);
    octant_in(here, &["export", "rest", "--to", "csv", "--tables", "samples", "--out", "csv"]);
    let columns = "schema = 1\n[imu]\nrate = \"50 Hz\"\n[source]\nuri = \"text:csv/samples.csv\"\n[source.text]\n\
        delimiter = \"comma\"\nheader = true\ntime_column = \"device_time_s\"\n[source.text.gyro]\n\
        x = \"delta_theta_x_rad\"\ny = \"delta_theta_y_rad\"\nz = \"delta_theta_z_rad\"\nunit = \"rad\"\n\
        quantity = \"increment\"\n[source.text.accelerometer]\nx = \"delta_velocity_x_mps\"\n\
        y = \"delta_velocity_y_mps\"\nz = \"delta_velocity_z_mps\"\nunit = \"m/s\"\nquantity = \"increment\"\n";
    let reference = "[source.reference]\nkind = \"static\"\n";
    let calibration = "[procedure.calibration]\nduration = \"1 h\"\n";
    let terms = |text: String| {
        std::fs::write(here.join("unit.toml"), text).unwrap();
        let arguments = ["characterise", "unit.toml", "--no-twin", "--json"];
        let (out, _) = ended(octant_in(here, &arguments), 0);
        let json: serde_json::Value = serde_json::from_str(&out).unwrap();
        json["analysis"].clone()
    };
    let alone = terms(columns.to_owned());
    assert!(alone.is_object(), "{alone}");
    for more in [reference, calibration, "[procedure.navigation]\n"] {
        assert_eq!(terms(format!("{columns}{more}")), alone, "{more}");
    }
}
