//! `octant faults sweep`, `minimise` and `describe` as a user runs them.

use crate::common::program::{ends, octant};
use octant_faults::catalogue::Acts;
use octant_faults::kinds;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Writes the ten-minute lock-step scenario without its navigation, with more at the end.
fn scenario(folder: &Path, more: &str) -> PathBuf {
    let text = include_str!("../../../../fixtures/scenarios/lockstep.toml");
    let (calibration, _) = text.split_once("[procedure.navigation]").unwrap();
    let path = folder.join("s.toml");
    std::fs::write(&path, format!("{calibration}{more}")).unwrap();
    path
}

#[track_caller]
fn succeeds(arguments: &[&str]) -> String {
    ends(arguments, 0).0
}

/// Returns the message of a refusal; its exit status is that of bad input.
#[track_caller]
fn refused(arguments: &[&str]) -> String {
    let output = octant(arguments);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
    assert!(output.stdout.is_empty());
    error
}

const SPIKE: &str = "[[faults]]\nid = \"spike-1\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
                     amplitude = \"1000 deg/h\"\ntrigger = { at = \"3 min\" }\n\
                     duration = \"20 samples\"\n";
const AMPLITUDES: &str = "amplitude=1 deg/h, 100 deg/h, 10000 deg/h";
const DURATIONS: &str = "duration=1 samples, 20 samples";

#[test]
fn a_sweep_is_the_same_to_the_last_byte_whatever_runs_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(folder.path(), SPIKE);
    let sweep = |jobs: &str| {
        let out = folder.path().join(jobs);
        let (path, place) = (path.to_str().unwrap(), out.to_str().unwrap());
        let over = ["--over", DURATIONS, "--over", AMPLITUDES];
        let common = ["faults", "sweep", path, "--jobs", jobs, "--out", place];
        let text = succeeds(&[&common[..], &over].concat());
        let json = std::fs::read(out.join("sweep.json")).unwrap();
        (text, json, out)
    };
    let (one, two) = (sweep("1"), sweep("2"));
    assert_eq!(one.1, two.1);
    assert_eq!(one.0, two.0);
    let json: Value = serde_json::from_slice(&one.1).unwrap();
    let cells = json["cells"].as_array().unwrap();
    let at = |cell: &Value| {
        cell["at"].as_array().unwrap().iter().map(|i| i.as_u64().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(
        cells.iter().map(at).collect::<Vec<_>>(),
        [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]
    );
    let sigma = |cell: &Value| cell["worst_shift_sigma"].as_f64().unwrap();
    assert!(cells.iter().all(|cell| cell["fired"] == true && sigma(cell).is_finite()));
    // A hundred times the angle gives a hundred times the shift, as long as nothing is screened.
    assert!(sigma(&cells[3]) > sigma(&cells[0]), "{cells:?}");

    // The table has a line for each cell, with the same numbers.
    let mut csv = csv::Reader::from_path(two.2.join("sweep.csv")).unwrap();
    let header = csv.headers().unwrap().clone();
    assert_eq!(
        header.iter().take(4).collect::<Vec<_>>(),
        ["duration", "amplitude", "fired", "worst_parameter"]
    );
    let rows: Vec<csv::StringRecord> = csv.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), cells.len());
    let column = header.iter().position(|name| name == "worst_shift_sigma").unwrap();
    for (row, cell) in rows.iter().zip(cells) {
        assert_eq!(row[column].parse::<f64>().unwrap(), sigma(cell));
    }
    assert_eq!((&rows[4][0], &rows[4][1]), ("20 samples", "100 deg/h"));

    // The map is complete both in its own file and in the page.
    let svg = std::fs::read_to_string(one.2.join("sweep.svg")).unwrap();
    let drawn = roxmltree::Document::parse(&svg).unwrap();
    let cells_drawn = drawn.descendants().filter(|n| n.attribute("class") == Some("heat")).count();
    assert_eq!(cells_drawn, cells.len());
    let page = std::fs::read_to_string(one.2.join("sweep.html")).unwrap();
    assert!(page.contains("octant faults sweep") && page.contains("10000 deg/h"));
}

#[test]
fn a_sweep_that_can_t_be_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(folder.path(), SPIKE);
    let path = path.to_str().unwrap();
    let sweep = |more: &[&str]| refused(&[&["faults", "sweep", path], more].concat());
    let said = sweep(&["--over", "amplitud=1 deg/h"]);
    assert!(said.contains("amplitud: unknown key, did you mean \"amplitude\"?"), "{said}");
    let said = sweep(&["--over", "amplitude=1 deg/h, 5 m"]);
    assert!(said.contains("\"5 m\"") && said.contains("expected an angular rate"), "{said}");
    let said = sweep(&["--over", "amplitude"]);
    assert!(said.contains("expected KEY=VALUE,VALUE"), "{said}");
    let said = sweep(&["--over", AMPLITUDES, "--fault", "spike"]);
    assert!(said.contains("unknown fault \"spike\", did you mean \"spike-1\"?"), "{said}");
    let two = format!("{SPIKE}{}", SPIKE.replace("spike-1", "spike-2"));
    let other = folder.path().join("two");
    std::fs::create_dir(&other).unwrap();
    let path = scenario(&other, &two);
    let said = refused(&["faults", "sweep", path.to_str().unwrap(), "--over", AMPLITUDES]);
    assert!(
        said.contains("several faults (spike-1, spike-2), expected one of them with --fault"),
        "{said}"
    );
}

/// Four faults, of which the first and the third together move a bias beyond the limit: 100 µg
/// each, with a limit of 150 µg.
const FOUR: &str = r#"
[[faults]]
id = "step-1"
kind = "bias-step"
channels = "accelerometer x"
amplitude = "100 ug"
trigger = { at = "0 s" }

[[faults]]
id = "lost"
kind = "aiding-lost"
loss = "100 %"
trigger = { at = "100 s" }
duration = "3 s"

[[faults]]
id = "step-2"
kind = "bias-step"
channels = "accelerometer x"
amplitude = "100 ug"
trigger = { at = "0 s" }

[[faults]]
id = "noise"
kind = "noise-gain"
channels = "gyro y"
gain = "120 %"
trigger = { at = "200 s" }
duration = "10 s"

[[requirements]]
id = "BIAS"
text = "The bias moves by less than 150 µg."
measure = "|counterfactual.parameters.accel_bias_x.shift|"
limit = "150 ug"
"#;

#[test]
fn minimise_finds_the_two_faults_that_break_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(folder.path(), FOUR);
    let (run, again) = (folder.path().join("run"), folder.path().join("again"));
    let [run_name, again_name] = [&run, &again].map(|path| path.to_str().unwrap());
    let output = octant(&["run", path.to_str().unwrap(), "--out", run_name]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));

    let text = succeeds(&["faults", "minimise", run_name]);
    assert!(text.contains("requirement BIAS fails"), "{text}");
    assert!(text.contains("smallest set: step-1, step-2\n"), "{text}");
    let json = std::fs::read_to_string(run.join("minimise.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["faults"], serde_json::json!(["step-1", "lost", "step-2", "noise"]));
    assert_eq!(json["minimal"], serde_json::json!(["step-1", "step-2"]));
    let trail = json["trail"].as_array().unwrap();
    let outcome = |set: &[u64]| {
        let step = trail.iter().find(|step| step["faults"] == serde_json::json!(set));
        step.map(|step| step["outcome"].as_str().unwrap())
    };
    assert_eq!(outcome(&[0, 1, 2, 3]), Some("breaks"));
    assert_eq!(outcome(&[]), Some("holds"));
    assert_eq!(outcome(&[0, 2]), Some("breaks"));
    // Each of the two alone passes: the set is the smallest.
    assert_eq!((outcome(&[0]), outcome(&[2])), (Some("holds"), Some("holds")));

    // The remaining faults run, and fail in the same way.
    let smallest = run.join("minimised.toml");
    let output = octant(&["run", smallest.to_str().unwrap(), "--out", again_name, "--json"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let ids: Vec<&str> =
        summary["faults"].as_array().unwrap().iter().map(|f| f["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["step-1", "step-2"]);
    assert_eq!(summary["requirements"][0]["verdict"], "fail");

    // A run without a failure has nothing to minimise.
    let said = refused(&["faults", "minimise", run_name, "--requirement", "BIOS"]);
    assert!(said.contains("unknown requirement \"BIOS\", did you mean \"BIAS\"?"), "{said}");
}

#[test]
fn a_picture_of_nothing_is_refused() {
    let said = refused(&["faults", "describe", "spyke", "--picture", "x.svg"]);
    assert!(said.contains("unknown kind of fault \"spyke\", did you mean \"spike\"?"), "{said}");
    // Faults of the wire, of the host and of a supply alter no sample that could be drawn.
    for kind in
        kinds::all().filter(|kind| matches!(kind.acts, Acts::Wire | Acts::Host | Acts::Power))
    {
        let said = refused(&["faults", "describe", kind.name, "--picture", "x.svg"]);
        assert!(said.contains("to draw a picture"), "{said}");
    }
}
