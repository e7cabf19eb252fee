//! Attacks on the inputs of a run, without any unit: truncated recordings, removed requirements.

use super::unit::{SCENARIO, check, scenario, summary_of};
use super::{Ends, Row, open};
use octant_base::control::Control;
use octant_run::assemble;
use octant_run::{StreamKeeping, run_as_far_as_it_goes};
use octant_scenario::{Method, Scenario};
use octant_score::summary::Summary;
use std::path::{Path, PathBuf};

/// Makes a full recording of the scenario, cut to `thousandths` of its bytes.
fn recorded(folder: &Path, seconds: u32, thousandths: usize) -> PathBuf {
    let path = folder.join("recording.mcap");
    let text = SCENARIO.replace("\"10 s\"", &format!("\"{seconds} s\""));
    let text = text.split("[[requirements]]").next().unwrap().to_owned();
    let text = text + "[record]\nsamples = \"full\"\n";
    let full = Scenario::parse(&text, "full.toml", Path::new(""), &[]).unwrap();
    let recording = StreamKeeping::File(&path);
    run_as_far_as_it_goes(&full, Method::Primary, full.seed, recording, &Control::default())
        .unwrap();
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() * thousandths / 1000]).unwrap();
    path
}

/// Runs the recorded samples.
fn replayed(recording: &Path, navigation: &str) -> Result<Summary, String> {
    let source = format!("source.uri=replay:{}", recording.display());
    // The true errors of recorded samples aren't known.
    let parts: Vec<&str> = SCENARIO.split("[[requirements]]").collect();
    let text = parts[..2].join("[[requirements]]");
    let text = text.replace("duration = \"10 s\"\n", navigation);
    let replay = Scenario::parse(&text, "replay.toml", Path::new(""), &[source]);
    summary_of(&replay.map_err(|error| error.to_string()).unwrap())
}

const CUT: Ends = open("ends in the middle of a recording");
const SHORT: Ends = open("navigation: planned 10 s, done 4 s");
const OPEN: Ends = open("navigation: planned 10 s, done");
const INTERRUPTED: Ends = open("interrupted after");

/// Returns the rows of the table.
pub fn rows() -> Vec<Row> {
    let row = |about, ends| Row { group: "bench", about, over: "in process", ends };
    vec![
        row("is given a recording that was cut at half of its bytes", CUT),
        row("is given a recording of 4 s of navigation for one of 10 s", SHORT),
        row("is given a recording cut at half of its bytes, and navigates until it ends", OPEN),
        row("is interrupted before its first answer", INTERRUPTED),
    ]
}

#[test]
fn a_whole_recording_passes() {
    let folder = tempfile::tempdir().unwrap();
    let recording = recorded(folder.path(), 10, 1000);
    for navigation in ["duration = \"10 s\"\n", ""] {
        let summary = replayed(&recording, navigation).unwrap();
        assert_eq!(summary.verdict.exit_code(), 0, "{:?}", summary.reasons);
        let done = summary.done.unwrap();
        assert_eq!((done.navigation_s, done.stops), (Some(10.0), Some(2)));
    }
}

#[test]
fn recordings_that_are_cut_show_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let cut = recorded(folder.path(), 10, 500);
    check("cut", &CUT, replayed(&cut, "duration = \"10 s\"\n"));
    check("cut, until its end", &OPEN, replayed(&cut, ""));
    std::fs::remove_file(&cut).unwrap();
    let short = recorded(folder.path(), 4, 1000);
    check("short", &SHORT, replayed(&short, "duration = \"10 s\"\n"));
}

#[test]
fn an_interrupted_run_says_what_it_did() {
    let scenario = scenario("");
    let control = Control::default();
    control.cancel.store(true, std::sync::atomic::Ordering::Relaxed);
    // By the clock, the control is checked with every sample.
    let mut scenario = scenario;
    scenario.realtime.by_clock = true;
    let run = run_as_far_as_it_goes(&scenario, Method::Primary, 3, StreamKeeping::None, &control)
        .unwrap();
    let summary = assemble(&scenario, 3, run, None).unwrap().summary;
    assert_eq!(summary.calibration.as_ref().unwrap().duration_h, 0.0, "what was done, not planned");
    check("interrupted", &INTERRUPTED, Ok(summary));
}
