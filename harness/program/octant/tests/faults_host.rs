//! Faults of the host, as a user runs them: starved processors, a full disk, a stalled recorder.

use crate::common::program::{json, program};
use octant_base::control::Control;
use octant_recorder::Event;
use octant_recorder::reader::{self, Item};
use octant_run::{MethodError, SetupError};
use octant_run::{StreamKeeping, run_method};
use octant_scenario::{Method, Scenario};
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};

const SECONDS: &str = "schema = 1\ntitle = \"a host\"\n[procedure.alignment]\nmethod = \"given\"\n\
    [procedure.navigation]\nduration = \"DURATION\"\n[imu]\nrate = \"RATE\"\n\
    [record]\nsamples = \"full\"\n[realtime]\noverrun = \"10 s\"\n";

fn text(duration: &str, rate: &str, faults: &str) -> String {
    format!("{}{faults}", SECONDS.replace("DURATION", duration).replace("RATE", rate))
}

fn fault(kind: &str, at: &str, more: &str) -> String {
    format!("[[faults]]\nid = \"f\"\nkind = \"{kind}\"\ntrigger = {{ at = \"{at}\" }}\n{more}\n")
}

/// Runs a scenario into `here/NAME`, and returns its exit status and its output.
fn run(here: &Path, name: &str, text: &str, more: &[&str]) -> (Option<i32>, String) {
    let file = here.join(format!("{name}.toml"));
    std::fs::write(&file, text).unwrap();
    let output = program(&["run"])
        .args([&file, Path::new("--out"), &here.join(name)])
        .args(more)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), said)
}

/// Returns the number of samples of a recording up to its end or tear, and its events of kind
/// `host`: scheduling and time.
fn recorded(path: &Path) -> (u64, Vec<(String, f64)>) {
    let mut recording = reader::Recording::open(path).unwrap();
    let (mut samples, mut events) = (0, Vec::new());
    while let Some((_, item)) = recording.next_item().unwrap() {
        match item {
            Item::Sample(_) => samples += 1,
            Item::Event(Event::Host { scheduling, taken_s, .. }) => {
                events.push((scheduling, taken_s))
            }
            _ => {}
        }
    }
    (samples, events)
}

#[test]
fn a_disk_that_is_full_ends_the_run_as_a_real_one_does() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for (name, duration, at, onset, more) in [
        ("free", "10 min", "5 min", 60_001, &[][..]),
        ("clock", "2 s", "1 s", 201, &["--realtime"][..]),
    ] {
        let text = text(duration, "200 Hz", &fault("host-disk-full", at, ""));
        let (status, said) = run(here, name, &text, more);
        assert_eq!(status, Some(4), "{said}");
        assert!(said.contains("the run broke off; the recorded part is in "), "{said}");
        let partial = here.join(format!("{name}.partial"));
        let summary = json(&partial.join("summary.json"));
        assert_eq!(summary["verdict"], "error");
        let reason = summary["reasons"][0].as_str().unwrap();
        let (before, after) = reason.split_once(": write the recording after ").unwrap();
        assert!(before.starts_with("after "), "{reason}");
        #[cfg(target_os = "linux")]
        assert!(after.ends_with(" bytes: No space left on device (os error 28)"), "{reason}");
        // The file has the length in the error message, and is readable.
        let written: u64 = after.split(' ').next().unwrap().parse().unwrap();
        let recording = partial.join("recording.mcap");
        assert_eq!(recording.metadata().unwrap().len(), written);
        let (samples, _) = recorded(&recording);
        assert!(samples < onset, "{samples} samples, and the disk was full from {onset} on");
        // The queue holds 1024 samples, an open chunk about 2000.
        assert!(name == "clock" || samples > 50_000, "{samples} samples");
        let receipt = &summary["faults"][0];
        assert_eq!(
            (&receipt["armed"], &receipt["fired"]),
            (&Value::Bool(true), &Value::Bool(true))
        );
        assert_eq!(
            (receipt["firings"].as_u64(), receipt["samples_altered"].as_u64()),
            (Some(1), Some(1))
        );
        assert_eq!(receipt["first_sample"].as_u64(), Some(onset));
    }
}

#[test]
fn a_recorder_that_stands_still_is_waited_for_in_simulated_time() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let (status, said) = run(here, "plain", &text("10 s", "200 Hz", ""), &[]);
    assert_eq!(status, Some(0), "{said}");
    let stalled = text("10 s", "200 Hz", &fault("host-recorder-stalled", "2 s", "pause = \"1 s\""));
    let began = Instant::now();
    let (status, said) = run(here, "stalled", &stalled, &[]);
    assert!(began.elapsed() >= Duration::from_secs(1), "it stood still");
    assert_eq!(status, Some(0), "{said}");
    let [plain, summary] =
        ["plain", "stalled"].map(|name| json(&here.join(name).join("summary.json")));
    assert_eq!(summary["stream_hash"], plain["stream_hash"]);
    assert_eq!(summary["navigation"], plain["navigation"]);
    assert_eq!(summary["faults"][0]["fired"], true);
    assert_eq!(summary["faults"][0]["first_sample"], 401);
    assert_eq!(recorded(&here.join("stalled/recording.mcap")).0, 2000);
}

#[test]
fn a_recorder_that_stands_still_loses_samples_by_the_clock() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // At 5 kHz the queue is full after 1.8 s. The parameters change every second, also during the
    // stall.
    let turning =
        "[procedure.calibration]\nduration = \"3 s\"\nstops = [{}, { azimuth = \"1 deg\" }]\n";
    let stalled = fault("host-recorder-stalled", "0.5 s", "pause = \"3 s\"");
    let text = text("1.5 s", "5 kHz", &format!("{turning}{stalled}"));
    let (status, said) = run(here, "long", &text, &["--realtime"]);
    assert_eq!(status, Some(3), "{said}");
    let summary = json(&here.join("long/summary.json"));
    assert_eq!(summary["verdict"], "inconclusive");
    let dropped = summary["pacing"]["dropped_records"].as_u64().unwrap();
    let reason = format!("{dropped} steps found no room on their way to the recorder");
    let reasons = summary["reasons"].as_array().unwrap();
    assert!(reasons.iter().any(|r| r.as_str().unwrap().starts_with(&reason)), "{reasons:?}");
    assert_eq!(summary["pacing"]["frames"], 22_500);
    assert_eq!(summary["faults"][0]["first_sample"], 2501);
    let (samples, _) = recorded(&here.join("long/recording.mcap"));
    assert!(dropped > 0 && samples + dropped >= 22_500, "{samples} recorded, {dropped} dropped");
    assert!(samples < 22_500);
    // A stall that the queue can absorb.
    let text = text.replace("5 kHz", "200 Hz").replace("\"3 s\" }", "\"0.5 s\" }");
    let (status, said) =
        run(here, "short", &text.replace("pause = \"3 s\"", "pause = \"0.5 s\""), &["--realtime"]);
    assert_eq!(status, Some(0), "{said}");
    let summary = json(&here.join("short/summary.json"));
    assert_eq!(summary["pacing"]["dropped_records"], 0);
    assert_eq!(summary["stream_hash"], summary["counterfactual"]["twin_stream_hash"]);
}

#[test]
fn starved_processors_make_samples_late() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let starved = fault("host-cpu-starved", "0.3 s", "length = \"300 ms\"");
    let text =
        text("1 s", "200 Hz", &starved).replace("overrun = \"10 s\"", "overrun = \"100 ms\"");
    let (status, said) = run(here, "starved", &text, &["--realtime"]);
    let summary = json(&here.join("starved/summary.json"));
    assert_eq!(summary["faults"][0]["fired"], true);
    assert_eq!(summary["faults"][0]["first_sample"], 61);
    // The results are the same as without the fault.
    assert_eq!(summary["stream_hash"], summary["counterfactual"]["twin_stream_hash"]);
    let (samples, events) = recorded(&here.join("starved/recording.mcap"));
    assert_eq!((samples, events.len()), (200, 1));
    let (scheduling, taken_s) = &events[0];
    assert!(*taken_s > 0.0, "{events:?}");
    let manifest = json(&here.join("starved/manifest.json"));
    if manifest["realtime"]["scheduling"]["outcome"] != "granted" {
        assert!(scheduling.starts_with("no SCHED_FIFO"), "{scheduling}");
        return;
    }
    assert_eq!(scheduling, "SCHED_FIFO with priority 80");
    assert_eq!(status, Some(3), "{said}");
    // The thread had no processor for 300 ms, and the sample after the onset was due after 5 ms.
    let latest_us = summary["pacing"]["lateness_us"]["max"].as_f64().unwrap();
    assert!(latest_us > 100e3, "{latest_us} us");
    let reason = |i: usize| summary["reasons"][i].as_str().unwrap();
    assert!(reason(0).starts_with("the bench failed at 0.305 s: a sample left "), "{}", reason(0));
    assert!(reason(1).starts_with("the bench was late: "), "{}", reason(1));
    // Nothing after the violation counts.
    assert!(summary["done"]["navigation_s"].as_f64().unwrap() < 0.31, "{summary}");
}

#[test]
fn where_nothing_would_happen_it_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for (kind, more, place, reason) in [
        (
            "host-cpu-starved",
            "",
            "f.toml:15:8",
            "makes samples late that leave by the clock, and these don't: expected realtime.pace = \
             \"clock\", or `octant run --realtime`",
        ),
        (
            "host-disk-full",
            "repeat = \"every time\"",
            "f.toml:17:10",
            "ends the run: the disk stays full, expected no repetition",
        ),
        ("host-recorder-stalled", "pause = \"0 s\"", "f.toml:17:9", "a time above 0 s is expected"),
    ] {
        let (status, said) =
            run(here, "f", &text("1 s", "200 Hz", &fault(kind, "0.5 s", more)), &[]);
        assert_eq!(status, Some(2), "{said}");
        assert!(said.contains(place) && said.contains(reason), "{said}");
        assert!(!here.join("f.partial").exists());
    }
    // A run without a file, or without a recorder.
    for (kind, expected) in [
        ("host-disk-full", "it happens to the file of a recording, and this run writes none"),
        ("host-recorder-stalled", "it happens to the thread of a recorder, and this run has none"),
    ] {
        let text = text("1 s", "200 Hz", &fault(kind, "0.5 s", ""));
        let scenario = Scenario::parse(&text, "s.toml", here, &[]).unwrap();
        for recording in [StreamKeeping::Hash, StreamKeeping::HashAlone, StreamKeeping::None] {
            let control = Control::default();
            match run_method(&scenario, Method::Primary, 1, recording, &control) {
                Err(MethodError::Setup(SetupError::Fault { id, reason })) => {
                    assert_eq!((id.as_str(), reason.as_str()), ("f", expected));
                }
                other => panic!("{kind}: {other:?}"),
            }
        }
    }
}
