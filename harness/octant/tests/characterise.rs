//! `octant characterise`: a recording of a run at rest, its files, and input that it refuses.

use crate::common::program::{ended, octant_in};

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
