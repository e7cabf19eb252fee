//! `octant rare`: its files, its exit statuses, and what it does with nonsense.

use crate::common::program::program;
use std::path::Path;
use std::process::Output;

const SCENARIO: &str = include_str!("../../../../fixtures/scenarios/rare.toml");
/// The error of g_zz exceeds two and a half σ with a probability of 0.0124.
const FREQUENT: &str = "requirements=[{ id = \"G-1\", text = \"Small.\", \
    measure = \"|calibration.parameters.g_zz.error|\", limit = \"0.00125 deg/h/g\" }]";
const FEW: [&str; 6] = ["--runs", "2000", "--error", "0.2", "--set", FREQUENT];

fn rare(folder: &Path, arguments: &[&str]) -> Output {
    program(&["rare"]).args(arguments).current_dir(folder).output().unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&[&*output.stdout, &*output.stderr].concat()).into_owned()
}

#[test]
fn the_answer_the_failing_run_and_the_journal() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("rare.toml"), SCENARIO).unwrap();
    let with = |more: &[&str]| {
        let arguments = [&["rare.toml"], &FEW[..], more].concat();
        rare(folder.path(), &arguments)
    };
    let below = with(&["--below", "0.1", "--out", "found"]);
    assert_eq!(below.status.code(), Some(0), "{}", words(&below));
    assert!(words(&below).contains("shown to be at or below 0.100"), "{}", words(&below));
    // The other questions take the runs of the journal, on one thread too.
    let above = with(&["--below", "1e-3", "--out", "found", "--jobs", "1"]);
    assert_eq!(above.status.code(), Some(1), "{}", words(&above));
    let between = with(&["--below", "0.0124", "--out", "found"]);
    assert_eq!(between.status.code(), Some(3), "{}", words(&between));
    let read =
        |name: &str| std::fs::read_to_string(folder.path().join("found").join(name)).unwrap();
    let found: serde_json::Value = serde_json::from_str(&read("rare.json")).unwrap();
    assert_eq!((&found["schema"], &found["shown"]), (&1.into(), &true.into()), "{found}");
    // --error 0.2 is reached before all of --runs 2000 are made.
    assert!(found["runs"].as_u64() < Some(1000), "{found}");
    let [low, high] = [0, 1].map(|end| found["interval"][end].as_f64().unwrap());
    assert!(low <= 0.012_419 && 0.012_419 <= high, "{low} {high}");
    // The failing run fails by the same margin.
    let seed = found["most_probable"]["seed"].to_string();
    let run = program(&["run", "found/failing.toml", "--seed", &seed, "--out", "run"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(1), "{}", words(&run));
    let summary = std::fs::read_to_string(folder.path().join("run/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["requirements"][0]["margin"], found["most_probable"]["margin"]);
    // An edited journal is refused.
    let journal = read("rare.jsonl");
    std::fs::write(
        folder.path().join("found/rare.jsonl"),
        journal.replacen(",true]", ",false]", 1),
    )
    .unwrap();
    let edited = with(&["--below", "0.1", "--out", "found"]);
    assert_eq!(edited.status.code(), Some(2), "{}", words(&edited));
    assert!(words(&edited).contains("the checksum doesn't fit"), "{}", words(&edited));
}

#[test]
fn nonsense_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("rare.toml"), SCENARIO).unwrap();
    let refused = |arguments: &[&str], expected: &str| {
        let output = rare(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", words(&output));
        assert!(words(&output).contains(expected), "{arguments:?}: {}", words(&output));
    };
    refused(&["rare.toml", "--below", "0"], "expected a probability above 0 and below 1");
    refused(&["rare.toml", "--below", "NaN"], "expected a probability above 0 and below 1");
    refused(&["rare.toml", "--runs", "5"], "100..=10000000");
    refused(&["rare.toml", "--requirement", "G-2"], "G-1");
    refused(&["rare.toml", "--protection", "--parameters", "gyro_bia_x"], "gyro_bias_x");
    refused(&["rare.toml", "--protection", "--below", "1e-3"], "cannot be used with");
    refused(&["rare.toml", "--parameters", "gyro_bias_x"], "--protection");
    refused(
        &["rare.toml", "--set", "realtime.pace=\"clock\""],
        "found a run by the clock, expected realtime.pace",
    );
}
