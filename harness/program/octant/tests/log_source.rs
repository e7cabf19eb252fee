//! The bytes that an instrument sent, as a file: run, characterised, and refused.

use crate::common::program::{ends, json};
use octant_instruments::{AnyEncoder, Protocol, Reading, Stamp, StampClock};
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};
use std::path::Path;

const SCENARIO: &str = "schema = 1
[imu]
rate = \"200 Hz\"
[procedure.alignment]
method = \"given\"
[procedure.navigation]
duration = \"1 s\"
rotation = \"none\"
[source]
uri = \"log:unit.bin\"
[source.log]
protocol = \"xsens\"
";

/// Writes what a unit at rest sends in a second and more, without the readings that were lost.
fn unit(folder: &Path, protocol: Protocol, lost: std::ops::Range<u64>) {
    let mut encoder = AnyEncoder::new(protocol);
    let mut bytes = Vec::new();
    for number in (1..=220).filter(|number| !lost.contains(number)) {
        let ns = number * 5_000_000;
        let sample = Sample {
            sequence: number,
            device_time: DeviceTime { ns },
            delta_theta: [21_000, 0, 12_000],
            delta_velocity: [0, 0, -52_650_000],
            gimbal: GimbalAngles::default(),
            status: Status::empty(),
        };
        let stamp = Some(Stamp { ns, clock: StampClock::Startup });
        let reading = Reading { stamp, interval_s: Some(0.005), ..Reading::of_sample(&sample) };
        bytes.extend(encoder.encode(&reading).unwrap());
    }
    std::fs::write(folder.join("unit.bin"), bytes).unwrap();
}

#[test]
fn a_log_is_run_and_its_gaps_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("s.toml");
    std::fs::write(&scenario, SCENARIO).unwrap();
    unit(folder.path(), Protocol::Xsens, 50..60);
    let out = folder.path().join("out");
    let run = ["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()];
    ends(&run, 0);
    let manifest = json(&out.join("manifest.json"));
    let bench = &manifest["bench"];
    assert_eq!(bench["readings"]["missing"], 10, "{bench}");
    let said = bench["instrument"].as_str().unwrap();
    assert!(said.contains("unit.bin: ") && said.contains(" readings, 0 other frames"), "{said}");
    // The file is evidence, as any recording is.
    assert!(manifest.to_string().contains("unit.bin"), "{manifest}");
    // Samples that would stand for the wrong times.
    let again = [&run[..], &["--force"]].concat();
    let (_, said) = ends(&[&again[..], &["--set", "imu.rate=\"100 Hz\""]].concat(), 2);
    assert!(said.contains("unit.bin: readings are 5.0000 ms apart, 200.0 Hz"), "{said}");
    // An end in the middle of a frame, before the run has all of its samples.
    let bytes = std::fs::read(folder.path().join("unit.bin")).unwrap();
    std::fs::write(folder.path().join("unit.bin"), &bytes[..bytes.len() / 2 + 3]).unwrap();
    let (said, _) = ends(&again, 3);
    assert!(said.contains("of an incomplete frame"), "{said}");
}

#[test]
fn what_is_no_log_of_the_protocol_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("s.toml");
    unit(folder.path(), Protocol::Sbg, 0..0);
    let out = folder.path().join("out");
    let run = ["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()];
    for (from, to, expected) in [
        ("", "", "it has no reading: "),
        ("[source.log]\nprotocol = \"xsens\"\n", "", "source.log: missing, expected the protocol"),
        ("\"xsens\"", "\"dbc\"", "source.log.protocol: found \"dbc\""),
        ("unit.bin", "none.bin", "none.bin"),
        ("log:unit.bin", "udp:7000", "source.log: without effect: source.uri is not log:FILE"),
    ] {
        std::fs::write(&scenario, SCENARIO.replace(from, to)).unwrap();
        let (_, said) = ends(&run, 2);
        assert!(said.contains(expected), "{to}: {said}");
    }
}
