//! The program itself against a hostile unit: exit status, and all files of the folder.

use super::unit::{HONEST, Over, SCENARIO, Served, Turn, Twist, scenario};
use crate::common::program::{json, octant_in};

fn run(name: &str, answer: fn(&mut Turn<'_>), status: i32) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{SCENARIO}[record]\nsamples = \"full\"\n");
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let served = Served::new(Over::Udp, &scenario(""), Twist { answer, ..HONEST });
    let endpoint = ["--endpoint", served.uri.as_str()];
    let arguments = [&["run", "s.toml", "--out", name][..], &endpoint].concat();
    let output = octant_in(folder.path(), &arguments);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(status), "{said}");
    (folder, said)
}

#[test]
fn a_navigation_that_is_nan_fails_with_all_its_evidence() {
    let nan = |turn: &mut Turn<'_>| {
        if turn.k > 1100 {
            turn.output.navigation.latitude_rad = f64::NAN;
        }
    };
    let (folder, said) = run("nan", nan, 1);
    let reason =
        "the answer to sample 1101: navigation.latitude_rad is NaN, expected a number from";
    assert!(said.contains(reason), "{said}");
    // Under the name of a finished run: the fail is its result.
    let run = folder.path().join("nan");
    for file in [
        "scenario.toml",
        "recording.mcap",
        "summary.json",
        "junit.xml",
        "report.html",
        "manifest.json",
    ] {
        assert!(run.join(file).is_file(), "{file}");
    }
    let summary = json(&run.join("summary.json"));
    assert_eq!(summary["verdict"], "fail");
    assert_eq!(summary["findings"][0]["about"], "unit");
    // The earlier part of the run is in the summary.
    assert_eq!(summary["done"]["calibration_s"], 20.0);
    let navigated_s = summary["done"]["navigation_s"].as_f64().unwrap();
    assert!((navigated_s - 2.0).abs() < 0.1, "{navigated_s}");
    for text in ["junit.xml", "report.html"] {
        let text = std::fs::read_to_string(run.join(text)).unwrap();
        assert!(text.contains("navigation.latitude_rad is NaN"), "{text}");
    }
    // The recording contains it too, and scoring it gives the same.
    let recording = run.join("recording.mcap");
    let scored = octant_in(folder.path(), &["score", recording.to_str().unwrap()]);
    assert_eq!(scored.status.code(), Some(1), "{}", String::from_utf8_lossy(&scored.stdout));
}

#[test]
fn what_fell_short_is_told_everywhere() {
    let done = |turn: &mut Turn<'_>| {
        if turn.k == 1050 {
            turn.output.mode = octant_sample::Mode::Done;
        }
    };
    let (folder, said) = run("short", done, 3);
    let short = "navigation: planned 10 s, done 1 s";
    assert!(said.contains(short), "{said}");
    for file in ["summary.json", "junit.xml", "report.html"] {
        let text = std::fs::read_to_string(folder.path().join("short").join(file)).unwrap();
        assert!(text.contains(short), "{file}: {text}");
    }
    let summary = json(&folder.path().join("short/summary.json"));
    assert_eq!(summary["planned"]["navigation_s"], 10.0);
    assert_eq!(summary["done"]["navigation_s"], 1.0);
}
