//! The bytes of a unit whose frames a description has: run, characterised, and refused. The bytes are those of
//! fixtures/golden/described.py, which knows the units' documents and not the descriptions.

use crate::common::program::{ends, json};
use octant_test_processes::command;
use std::path::{Path, PathBuf};

const PLANT: &str = "schema = 1
title = \"a unit\"
[imu]
rate = \"200 Hz\"
[procedure.alignment]
method = \"given\"
[procedure.navigation]
duration = \"30 s\"
rotation = \"none\"
[record]
samples = \"full\"
";

/// Table `samples` of a run, by its columns of increments.
fn samples(folder: &Path, run: &str) -> Vec<[f64; 6]> {
    let (run, out) = (folder.join(run), folder.join(format!("{run}-csv")));
    let export = ["export", run.to_str().unwrap(), "--to", "csv", "--tables", "samples", "--out"];
    ends(&[&export[..], &[out.to_str().unwrap()]].concat(), 0);
    let text = std::fs::read_to_string(out.join("samples.csv")).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let names = ["x", "y", "z"].map(|axis| format!("delta_theta_{axis}_rad"));
    let velocities = ["x", "y", "z"].map(|axis| format!("delta_velocity_{axis}_mps"));
    let columns: Vec<usize> = names
        .iter()
        .chain(&velocities)
        .map(|name| header.iter().position(|column| column == name).unwrap())
        .collect();
    lines
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            std::array::from_fn(|index| fields[columns[index]].parse().unwrap())
        })
        .collect()
}

/// Simulates a unit and writes what it sends in a format: the samples, and the scenario's file.
fn unit(folder: &Path, format: &str, description: &str) -> (Vec<[f64; 6]>, PathBuf) {
    let plant = folder.join("plant.toml");
    std::fs::write(&plant, PLANT).unwrap();
    let out = folder.join("plant");
    ends(&["run", plant.to_str().unwrap(), "--out", out.to_str().unwrap(), "--force"], 0);
    let sent = samples(folder, "plant");
    assert_eq!(sent.len(), 6000);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/described.py");
    let made = command("python3")
        .arg(script)
        .arg(format)
        .args([folder.join("plant-csv/samples.csv"), folder.join("unit.bin")])
        .status()
        .unwrap();
    assert!(made.success());
    let scenario = folder.join("s.toml");
    let source = format!(
        "[source]\nuri = \"log:unit.bin\"\n[source.log]\nprotocol = \"described\"\ndescription = \"{description}\"\n"
    );
    std::fs::write(&scenario, format!("{PLANT}{source}")).unwrap();
    (sent, scenario)
}

fn near(sent: &[[f64; 6]], found: &[[f64; 6]], margin: impl Fn(usize, f64) -> f64) {
    assert_eq!(sent.len(), found.len());
    for (sent, found) in sent.iter().zip(found) {
        for axis in 0..6 {
            let margin = margin(axis, sent[axis].abs());
            let apart = (sent[axis] - found[axis]).abs();
            assert!(apart <= margin, "axis {axis}: {} {} {margin:e}", sent[axis], found[axis]);
        }
    }
}

/// Sums of the columns from the first row to each.
fn sums(rows: &[[f64; 6]]) -> Vec<[f64; 6]> {
    let mut sum = [0.0; 6];
    let add = |row: &[f64; 6]| {
        sum = std::array::from_fn(|axis| sum[axis] + row[axis]);
        sum
    };
    rows.iter().map(add).collect()
}

/// Size of a count of a sample: rad for gyros, m/s for accelerometers.
fn count(axis: usize) -> f64 {
    if axis < 3 { 2f64.powi(-36) } else { 2f64.powi(-30) }
}

#[test]
fn samples_that_python_encoded_come_back_within_the_resolution_of_their_format() {
    for (format, description) in
        [("kvh", "kvh-1775-rate"), ("stim", "stim300-rate"), ("words", "ln-100-like")]
    {
        let folder = tempfile::tempdir().unwrap();
        let (sent, scenario) = unit(folder.path(), format, description);
        let out = folder.path().join("out");
        ends(&["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()], 0);
        let found = samples(folder.path(), "out");
        match format {
            // Floats of 32 bits, and the two roundings to a count.
            "kvh" => near(&sent, &found, |axis, value| value * 2f64.powi(-23) + 1.5 * count(axis)),
            // Half of a count of the unit over 5 ms.
            "stim" => near(&sent, &found, |axis, _| {
                let half = if axis < 3 {
                    0.5 * 2f64.powi(-14) * std::f64::consts::PI / 180.0
                } else {
                    0.5 * 2f64.powi(-19) * 9.806_65
                };
                0.005 * half + 1.5 * count(axis)
            }),
            // Half of a pulse in the sum, which the unit carries.
            _ => near(&sums(&sent), &sums(&found), |axis, _| {
                let half = if axis < 3 {
                    0.05 / 3600.0 * std::f64::consts::PI / 180.0
                } else {
                    0.5 * 2f64.powi(-12)
                };
                half + 6000.0 * 1e-17 + 2.0 * count(axis)
            }),
        }
        let manifest = json(&out.join("manifest.json"));
        let said = manifest["bench"]["instrument"].as_str().unwrap();
        let expected =
            format!("6000 readings, 0 other frames of protocol described as {description}");
        assert!(said.contains(&expected), "{said}");
        assert_eq!(manifest["bench"]["readings"]["missing"], 0);
    }
}

#[test]
fn damage_is_skipped_a_torn_end_is_inconclusive_and_other_bytes_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let (_, scenario) = unit(folder.path(), "kvh", "own.toml");
    let own = folder.path().join("own.toml");
    let ready = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../devices/instruments/descriptions/kvh-1775-rate.toml"
    );
    let text = std::fs::read_to_string(ready).unwrap();
    std::fs::write(&own, &text).unwrap();
    let (file, out) = (folder.path().join("unit.bin"), folder.path().join("out"));
    let run = ["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap(), "--force"];
    let whole = std::fs::read(&file).unwrap();
    // Ten damaged frames and noise between others are gaps of as many samples; 29 s are asked for.
    let mut damaged = whole.clone();
    for number in 0..10 {
        damaged[(100 + 7 * number) * 36 + 20] ^= 1;
    }
    damaged.splice(36_000..36_000, [0x55; 100]);
    std::fs::write(&file, &damaged).unwrap();
    let short = ["--set", "procedure.navigation.duration=\"29 s\""];
    ends(&[&run[..], &short].concat(), 0);
    let manifest = json(&out.join("manifest.json"));
    assert_eq!(manifest["bench"]["readings"]["missing"], 10);
    let said = manifest["bench"]["instrument"].as_str().unwrap();
    assert!(said.contains("10 frames with a wrong checksum"), "{said}");
    // The description is evidence beside the bytes.
    let inputs: Vec<&str> = manifest["inputs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|i| i["file"].as_str().unwrap())
        .collect();
    assert!(inputs.iter().any(|input| input.ends_with("own.toml")), "{inputs:?}");
    // An end within a frame.
    std::fs::write(&file, &whole[..whole.len() / 2 + 10]).unwrap();
    let (said, _) = ends(&run, 3);
    assert!(said.contains("unit.bin ends with 10 bytes of an incomplete frame"), "{said}");
    // Another unit's description, and bytes that are none.
    std::fs::write(&file, &whole).unwrap();
    let wrong = |description: &str| {
        let set = format!("source.log.description={description}");
        ends(&[&run[..], &["--set", &set]].concat(), 2).1
    };
    let said = wrong("ln-100-like");
    assert!(
        said.contains("unit.bin: it has no reading: ")
            && said.contains("216000 bytes belong to no frame"),
        "{said}"
    );
    let said = wrong("kvh-1775");
    assert!(
        said.contains("source.log.description: found \"kvh-1775\"; did you mean \"kvh-1775-"),
        "{said}"
    );
    let said = wrong("none.toml");
    assert!(said.contains("none.toml: "), "{said}");
    // A checksum of other parameters fits no frame.
    std::fs::write(
        &own,
        text.replace("init = 0xFFFFFFFF", "init = 0").replace("check = 0x0376E6E7\n", ""),
    )
    .unwrap();
    let (_, said) = ends(&run, 2);
    assert!(
        said.contains("0 readings") && said.contains("6000 frames with a wrong checksum"),
        "{said}"
    );
    std::fs::write(&own, text.replace("type = \"f32\"", "type = \"f23\"")).unwrap();
    let (_, said) = ends(&run, 2);
    assert!(
        said.contains("own.toml:31: frame[0].field[0].type: found \"f23\"; expected one of: i8,"),
        "{said}"
    );
    std::fs::write(&file, [0x55; 5000]).unwrap();
    std::fs::write(&own, text).unwrap();
    let (_, said) = ends(&run, 2);
    assert!(said.contains("5000 bytes belong to no frame of this protocol"), "{said}");
}

#[test]
fn a_described_unit_is_characterised() {
    let folder = tempfile::tempdir().unwrap();
    let (_, scenario) = unit(folder.path(), "kvh", "kvh-1775-rate");
    let long = std::fs::read_to_string(&scenario).unwrap().replace("30 s", "10 min");
    let plant = long.split("[source]").next().unwrap();
    std::fs::write(folder.path().join("long.toml"), plant).unwrap();
    let out = folder.path().join("long");
    ends(
        &["run", folder.path().join("long.toml").to_str().unwrap(), "--out", out.to_str().unwrap()],
        0,
    );
    samples(folder.path(), "long");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/described.py");
    let table = folder.path().join("long-csv/samples.csv");
    let made = command("python3")
        .arg(script)
        .arg("kvh")
        .args([&table, &folder.path().join("unit.bin")])
        .status();
    assert!(made.unwrap().success());
    std::fs::write(&scenario, &long).unwrap();
    let told = |of: &str| {
        let (out, _) = ends(&["characterise", of, "--no-twin", "--json"], 0);
        serde_json::from_str::<serde_json::Value>(&out).unwrap()
    };
    let of_log = told(scenario.to_str().unwrap());
    let of_table = told(table.to_str().unwrap());
    for c in 0..6 {
        let value = |of: &serde_json::Value| {
            of["analysis"]["channels"][c]["deviations"][0]["allan"]["deviation"].as_f64().unwrap()
        };
        let (a, b) = (value(&of_log), value(&of_table));
        assert!((a / b - 1.0).abs() < 1e-4, "channel {c}: {a} {b}");
    }
    assert_eq!(of_log["names_in_file"], serde_json::Value::Null);
    std::fs::write(&scenario, format!("{long}axes = \"y -x z\"\n")).unwrap();
    let of_log = told(scenario.to_str().unwrap());
    let axes = ["y of the unit", "−x of the unit", "z of the unit"];
    let names = serde_json::json!([axes, axes].concat());
    assert_eq!(of_log["names_in_file"], names);
}
