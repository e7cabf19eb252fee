//! Headings as ships send them, scored without a position: a file, and a line of another program.

use crate::common::program::program;
use octant_test_processes::{command, start};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write as _};
use std::path::Path;
use std::process::Stdio;

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

fn zda(t: u32) -> String {
    sentence(&format!("GPZDA,10{:02}{:02}.00,20,11,2026,00,00", t / 60, t % 60))
}

fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("out/summary.json")).unwrap()).unwrap()
}

fn score(folder: &Path, more: &[&str]) -> (Option<i32>, String) {
    let arguments = [&["score", "--out", "out", "--force"][..], more].concat();
    let ended = program(&arguments).current_dir(folder).output().unwrap();
    let said = String::from_utf8_lossy(&ended.stdout).into_owned()
        + &String::from_utf8_lossy(&ended.stderr);
    (ended.status.code(), said)
}

const REQUIRED: &str = "schema = 1
[[requirements]]
id = \"HDG-1\"
text = \"The heading stays near the surveyed one.\"
measure = \"navigation.heading_error_arcmin.max\"
limit = \"24 arcmin\"
";

#[test]
fn headings_alone_are_scored_against_a_surveyed_one() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // Errors of 0.2 and 0.3 deg: 18 arcmin at most, through north.
    let text: String = (0..600)
        .map(|t| zda(t) + &sentence(if t % 7 == 0 { "HEHDT,0.2,T" } else { "HEHDT,0.1,T" }))
        .collect();
    std::fs::write(here.join("gyro.nmea"), text).unwrap();
    std::fs::write(here.join("s.toml"), REQUIRED).unwrap();
    let arguments =
        ["--solution", "gyro.nmea", "--true-heading", "359.9 deg", "--scenario", "s.toml"];
    let surveyed = |uncertainty: &str, limit: &str| {
        let set = format!("source.trajectory.true_heading_uncertainty={uncertainty}");
        std::fs::write(here.join("s.toml"), REQUIRED.replace("24 arcmin", limit)).unwrap();
        let more = [&arguments[..], &["--set", &set]].concat();
        score(here, &more)
    };
    let (status, said) = surveyed("0.02 deg", "24 arcmin");
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("heading   max 18.000, rms "), "{said}");
    assert!(!said.contains("latitude"), "{said}");
    let found = summary(here);
    let navigation = &found["navigation"];
    for absent in
        ["latitude_error_arcmin", "radial_error_nmi", "pitch_error_arcmin", "roll_error_arcmin"]
    {
        assert!(navigation[absent].is_null(), "{absent}: {navigation}");
    }
    let max = navigation["heading_error_arcmin"]["max"].as_f64().unwrap();
    assert!((max - 18.0).abs() < 1e-6, "{max}");
    // Half a digit is 3 arcmin: 18 ± 3.2 is not surely within 21.
    let (status, said) = surveyed("0.02 deg", "21 arcmin");
    assert_eq!(status, Some(3), "{said}");
    // Without the uncertainty of the reference, half a digit alone is none.
    let (status, said) = score(here, &arguments);
    assert_eq!(status, Some(3), "{said}");
    assert!(said.contains("nobody says how uncertain its reference is"), "{said}");
    // The same again from the evidence.
    let (status, said) = surveyed("0.02 deg", "24 arcmin");
    assert_eq!(status, Some(0), "{said}");
    let verified = program(&["verify", "out"]).current_dir(here).output().unwrap();
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
    // No position is told, and none is in error.
    let exported =
        program(&["export", "out", "--to", "csv", "--tables", "navigation", "--out", "csv"]);
    let exported = { exported }.current_dir(here).output().unwrap();
    assert_eq!(exported.status.code(), Some(0), "{exported:?}");
    let table = std::fs::read_to_string(here.join("csv/navigation.csv")).unwrap();
    let mut rows = table.lines();
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let row: Vec<&str> = rows.next().unwrap().split(',').collect();
    for name in ["true_latitude_deg", "latitude_error_arcmin"] {
        let column = header.iter().position(|found| *found == name);
        assert!(column.is_none_or(|column| matches!(row[column], "" | "NaN")), "{name}: {row:?}");
    }
}

#[test]
fn the_shipped_limits_on_an_output_are_those_of_its_rates_of_turn() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let heading = |t: f64| (350.0 + 80.0 * (0.2 * t).sin()).rem_euclid(360.0);
    let clock =
        |k: u32| format!("2026-11-20T10:{:02}:{:06.3}Z", k / 600, f64::from(k % 600) / 10.0);
    let scenario = crate::architecture::root().join("fixtures/scoring/heading-output.toml");
    let scored = |late_s: f64| {
        let at = |k: u32| f64::from(k) / 10.0;
        let device: String = (0..6000)
            .map(|k| {
                let shown = heading(at(k) - late_s);
                format!("{} {}", clock(k), sentence(&format!("HEHDT,{shown:.1},T")))
            })
            .collect();
        let table: String = (0..6000)
            .map(|k| {
                let body = format!("PSXN,23,0.00,0.00,{:.3},0.00", heading(at(k)));
                format!("{} {}", clock(k), sentence(&body))
            })
            .collect();
        std::fs::write(here.join("device.nmea"), device).unwrap();
        std::fs::write(here.join("table.nmea"), table).unwrap();
        let files = ["--solution", "device.nmea", "--reference", "table.nmea", "--scenario"];
        score(here, &[&files[..], &[scenario.to_str().unwrap()]].concat())
    };
    // At up to 10 deg/s 20 ms are 0.2 deg, and 70 ms 0.7 deg; at up to 16 deg/s 70 ms are 1.1 deg.
    let (status, said) = scored(0.02);
    assert_eq!(status, Some(0), "{said}");
    let (status, said) = scored(0.07);
    assert_eq!(status, Some(1), "{said}");
    let found = summary(here);
    let verdicts: Vec<_> = (found["requirements"].as_array().unwrap().iter())
        .map(|result| (result["id"].as_str().unwrap(), result["verdict"].as_str().unwrap()))
        .collect();
    let expected =
        [("MSC116-4.3.2.1", "pass"), ("MSC116-4.3.2.4-10", "fail"), ("MSC116-4.3.2.4-20", "pass")];
    assert_eq!(verdicts, expected);
}

#[test]
fn latency_and_follow_up_are_measures_of_a_requirement() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let heading = |t: f64| (350.0 + 25.0 * (0.4 * t).sin()).rem_euclid(360.0);
    let clock =
        |k: u32| format!("2026-11-20T10:{:02}:{:06.3}Z", k / 600, f64::from(k % 600) / 10.0);
    let gyro: String = (0..1200)
        .map(|k| {
            let late = heading(f64::from(k) / 10.0 - 0.17);
            format!("{} {}", clock(k), sentence(&format!("HETHS,{late:.1},A")))
        })
        .collect();
    let table: String = (0..1200)
        .map(|k| {
            format!(
                "{} {}",
                clock(k),
                sentence(&format!("PSXN,23,0.00,0.00,{:.3},0.00", heading(f64::from(k) / 10.0)))
            )
        })
        .collect();
    std::fs::write(here.join("gyro.nmea"), gyro).unwrap();
    std::fs::write(here.join("table.nmea"), table).unwrap();
    let required = |latency: &str, follow: &str| {
        let text = format!(
            "schema = 1
[[requirements]]
id = \"OUT-1\"
text = \"It is not late.\"
measure = \"|navigation.heading_output.latency_s|\"
limit = \"{latency}\"
[[requirements]]
id = \"OUT-2\"
text = \"It follows.\"
measure = \"navigation.heading_output.follow_up_10.max_deg\"
limit = \"{follow}\"
[decision]
uncertainties = [{{ measure = \"navigation.heading_output.follow_up_10.max_deg\", uncertainty = \"0.01 deg\" }}]
"
        );
        std::fs::write(here.join("s.toml"), text).unwrap();
        score(
            here,
            &["--solution", "gyro.nmea", "--reference", "table.nmea", "--scenario", "s.toml"],
        )
    };
    let (status, said) = required("0.25 s", "2.5 deg");
    assert_eq!(status, Some(0), "{said}");
    let output = summary(here)["navigation"]["heading_output"].clone();
    let number = |path: &str| output.pointer(path).and_then(Value::as_f64).expect(path);
    assert!((number("/latency_s") - 0.17).abs() < number("/latency_uncertainty_s"), "{output}");
    assert!(number("/latency_uncertainty_s") < 0.01, "{output}");
    // 10 deg/s for 0.17 s, and a rounding.
    assert!((number("/follow_up_10/max_deg") - 1.7).abs() < 0.06, "{output}");
    assert!(number("/transmission_error_deg") < 0.06, "{output}");
    assert!(said.contains("latency 0.170 ± 0.00"), "{said}");
    assert_eq!(required("0.1 s", "2.5 deg").0, Some(1));
    assert_eq!(required("0.25 s", "1.72 deg").0, Some(3));
}

/// A program that isn't ours sends on a pseudo-terminal; the capture keeps the times of arrival.
#[test]
fn a_line_of_another_program_is_captured_and_scored() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/heading_line.py");
    let mut gyro =
        start(command("python3").args([script, "6"]).stdin(Stdio::piped()).stdout(Stdio::piped()));
    let mut line = String::new();
    BufReader::new(gyro.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    let uri = format!("serial:{}?baud=115200", line.trim());
    let arguments = ["capture", &uri, "--stamp", "--duration", "5 s", "--out", "gyro.nmea"];
    let mut capture =
        start(program(&arguments).current_dir(here).stdout(Stdio::piped()).stderr(Stdio::piped()));
    let mut said = String::new();
    BufReader::with_capacity(1, capture.stderr.as_mut().unwrap()).read_line(&mut said).unwrap();
    assert!(said.contains("listening on"), "{said}");
    gyro.stdin.as_mut().unwrap().write_all(b"go\n").unwrap();
    let ended = capture.output();
    assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    // The same heading, by the clock of this host: on a busy one a line comes late, and never early.
    let log = std::fs::read_to_string(here.join("gyro.nmea")).unwrap();
    assert!(log.starts_with("\\c:") && log.contains("\\$HEROT,0.0,A"), "{log}");
    let first_ms: u64 = log[3..].split('*').next().unwrap().parse().unwrap();
    let reference: String = (0..100)
        .map(|k| {
            let unix_s = first_ms as f64 / 1000.0 - 1.0 + f64::from(k) / 10.0;
            let heading =
                (359.0 + 15.0 * (std::f64::consts::TAU * unix_s / 8.0).sin()).rem_euclid(360.0);
            let fields = format!("c:{}", (unix_s * 1000.0).round());
            let sum = fields.bytes().fold(0, |sum, byte| sum ^ byte);
            format!(
                "\\{fields}*{sum:02X}\\{}",
                sentence(&format!("PSXN,23,0.00,0.00,{heading:.4},0.00"))
            )
        })
        .collect();
    std::fs::write(here.join("table.nmea"), reference).unwrap();
    let (status, said) = score(here, &["--solution", "gyro.nmea", "--reference", "table.nmea"]);
    assert_eq!(status, Some(0), "{said}");
    let found = summary(here);
    let output = &found["navigation"]["heading_output"];
    let latency_s = output["latency_s"].as_f64().unwrap();
    assert!((-0.01..1.0).contains(&latency_s), "{output}");
    let points = found["inputs"][0]["used"].as_u64().unwrap();
    assert!(points >= 40, "{found}");
}
