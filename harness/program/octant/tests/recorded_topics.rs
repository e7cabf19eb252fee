//! Topics for other tools in recordings: they are those of an export, and change nothing else.

use crate::common::epochs::{PERIOD_NS, record};
use crate::common::program::{ended, json, octant_in};
use crate::common::stream::stream;
use octant_recorder::message::Topic;
use octant_recorder::reader::{Epochs, Item, Recording, read_bytes};
use octant_recorder::{Policy, RecorderOptions, Samples};
use octant_sample::Mode;
use octant_views::about::About;
use octant_views::publishing;
use octant_views::solution::NavigationErrors;
use std::collections::BTreeMap;
use std::path::Path;

const LOCKSTEP: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/lockstep.toml");

/// Topics of the standard messages in a recording.
const STANDARD: [&str; 5] =
    ["/imu/data", "/fix", "/error/position", "/error/velocity", "/error/attitude"];

/// Messages on topics that are none of the recorder's own: log time and bytes, by topic.
fn further(bytes: &[u8]) -> BTreeMap<String, Vec<(u64, Vec<u8>)>> {
    let mut found: BTreeMap<String, Vec<(u64, Vec<u8>)>> = BTreeMap::new();
    for message in mcap::MessageStream::new(bytes).unwrap() {
        let message = message.unwrap();
        if Topic::from_name(&message.channel.topic).is_none() {
            let of = found.entry(message.channel.topic.clone()).or_default();
            of.push((message.log_time, message.data.to_vec()));
        }
    }
    found
}

/// Runs a scenario in a folder.
fn run(folder: &Path, scenario: &str, words: &[&str]) {
    ended(octant_in(folder, &[&["run", scenario], words].concat()), 0);
}

/// Messages of the recorder's own topics, as text, without the covariances.
fn own(path: &Path) -> Vec<String> {
    let mut recording = Recording::open(path).unwrap();
    let mut all = Vec::new();
    while let Some((time_ns, item)) = recording.next_item().unwrap() {
        if !matches!(item, Item::Covariance(..)) {
            all.push(format!("{time_ns} {item:?}"));
        }
    }
    all
}

/// Number `index` of a message whose fields after the header are numbers, for a frame of three letters
/// or of eight.
fn number(message: &[u8], first: usize, index: usize) -> f64 {
    let at = first + 8 * index;
    f64::from_le_bytes(message[at..at + 8].try_into().unwrap())
}

const WITH_FAULTS: &str = r#"
schema = 1
title = "a minute with faults"
[procedure.alignment]
method = "given"
[procedure.calibration]
duration = "60 s"
stops = [{ azimuth = "0 deg", roll = "0 deg" }, { azimuth = "90 deg", roll = "0 deg" }]
[procedure.navigation]
duration = "30 s"
[record]
topics_period = "2.5 s"
[[faults]]
id = "spike-1"
kind = "spike"
channels = "gyro x"
amplitude = "1000 deg/h"
trigger = { position = 2, after = "3 s" }
duration = "20 samples"
[[faults]]
id = "gone"
kind = "dropout"
trigger = { at = "12.25 s" }
duration = "100 samples"
"#;

#[test]
fn a_recording_has_the_messages_of_its_export() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("faults.toml"), WITH_FAULTS).unwrap();
    for (scenario, name, status) in [(LOCKSTEP, "lockstep", 0), ("faults.toml", "faults", 3)] {
        let output = octant_in(folder.path(), &["run", scenario, "--out", name]);
        assert!([0, status].contains(&output.status.code().unwrap()), "{output:?}");
        let out = format!("{name}.mcap");
        let words = ["export", name, "--to", "rosbag-mcap", "--out", &out];
        ended(octant_in(folder.path(), &words), 0);
        let recording = folder.path().join(name).join("recording.mcap");
        let recorded = further(&std::fs::read(recording).unwrap());
        let exported = further(&std::fs::read(folder.path().join(&out)).unwrap());
        for (topic, messages) in &recorded {
            let of_export = &exported[topic];
            // Octant's own messages are JSON in a recording and CDR in a bag, where `ros_published` and the rig of exports compare
            // their numbers: here their times are.
            let is_standard = STANDARD.contains(&topic.as_str());
            for message in messages {
                let is_same = |other: &&(u64, Vec<u8>)| {
                    if is_standard { *other == message } else { other.0 == message.0 }
                };
                let same = of_export.iter().filter(is_same).count();
                assert!(same >= 1, "{name}, {topic} at {} ns", message.0);
            }
            assert!(messages.len() <= of_export.len());
        }
        for topic in STANDARD {
            assert!(recorded[topic].len() > 20, "{name}, {topic}");
        }
        for topic in ["state", "error", "gimbals", "nis", "faults", "parameters"] {
            assert!(recorded.contains_key(&format!("/octant/{topic}")), "{name}, {topic}");
        }
    }
}

#[test]
fn without_them_the_run_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), LOCKSTEP, &["--out", "with", "--set", "record.topics_period=\"1 s\""]);
    run(folder.path(), LOCKSTEP, &["--out", "without", "--set", "record.topics=\"off\""]);
    let at = |name: &str, file: &str| folder.path().join(name).join(file);
    let [with, without] = ["with", "without"].map(|name| at(name, "recording.mcap"));
    assert_eq!(further(&std::fs::read(&without).unwrap()), BTreeMap::new());
    assert_eq!(own(&with), own(&without));
    let [first, second] = ["with", "without"].map(|name| json(&at(name, "summary.json")));
    assert_eq!(first["stream_hash"], second["stream_hash"]);
    // The settings differ, in these keys, and nothing else does.
    let (diff, _) = ended(octant_in(folder.path(), &["diff", "with", "without"]), 1);
    assert!(diff.contains("stream: the same, stream hash"), "{diff}");
    let words = |words: &[&str]| ended(octant_in(folder.path(), words), 0).0;
    for name in ["with", "without"] {
        words(&["replay", &format!("{name}/recording.mcap")]);
        words(&["verify", name]);
    }
    let score = |name: &str| words(&["score", &format!("{name}/recording.mcap"), "--json"]);
    assert_eq!(score("with").replace("with/", ""), score("without").replace("without/", ""));
}

#[test]
fn they_come_on_their_grid_and_when_the_mode_changes() {
    let steps = stream(200 * 60);
    for samples in [Samples::Decimated, Samples::Full] {
        let options = RecorderOptions {
            policy: Policy { samples, ..Policy::default() },
            publishing: Some(publishing(about(), 10_000_000_000)),
            ..RecorderOptions::default()
        };
        let (bytes, summary) = record(&steps, &options);
        let found = further(&bytes);
        // The first epoch, the change of mode 5 ms after 30 s, and then the first at or after each 10 s.
        let wanted: Vec<u64> = [PERIOD_NS, 10_000_000_000, 20_000_000_000, 30_000_000_000]
            .into_iter()
            .chain([6001 * PERIOD_NS, 40_000_000_000, 50_000_000_000, 60_000_000_000])
            .collect();
        let times = |topic: &str| found[topic].iter().map(|(at, _)| *at).collect::<Vec<_>>();
        for topic in STANDARD.iter().chain(&["/octant/state", "/octant/error", "/octant/gimbals"]) {
            assert_eq!(times(topic), wanted, "{topic}, {samples:?}");
        }
        assert_eq!(times("/octant/faults"), [0]);
        assert_eq!(times("/octant/parameters").last(), Some(&60_000_000_000));
        // The recorder's own topics are what they are without.
        let (plain, without) = record(&steps, &RecorderOptions { publishing: None, ..options });
        assert_eq!(further(&plain), BTreeMap::new());
        assert_eq!(summary.messages, without.messages);
        assert_eq!(summary.stream_hash, without.stream_hash);
        assert_eq!(read_bytes(&bytes).unwrap().messages, read_bytes(&plain).unwrap().messages);
    }
}

/// Description of the streams of these tests: 200 Hz.
fn about() -> About {
    About { sample_period_ns: Some(PERIOD_NS), ..About::default() }
}

#[test]
fn a_recording_with_them_is_read_up_to_a_cut_at_any_byte() {
    let options = RecorderOptions {
        publishing: Some(publishing(about(), 1_000_000)),
        epochs_per_block: 100,
        policy: Policy { samples: Samples::Full, period_ns: 50_000_000, ..Policy::default() },
        ..RecorderOptions::default()
    };
    let (bytes, _) = record(&stream(300), &options);
    assert!(further(&bytes)["/fix"].len() > 20);
    let (mut readable, mut most) = (0, 0);
    for length in 0..bytes.len() {
        let Ok(contents) = read_bytes(&bytes[..length]) else {
            assert_eq!(readable, 0, "cut at {length}: the head was there before");
            continue;
        };
        assert!(contents.truncated, "cut at {length} of {}", bytes.len());
        let messages: u64 = contents.messages.values().sum();
        assert!(messages >= most);
        (most, readable) = (messages, readable + 1);
    }
    assert_eq!(most, read_bytes(&bytes).unwrap().messages.values().sum::<u64>());
}

/// An hour of calibration and a minute of navigation: the filter's covariance is in the messages, and
/// the errors are as large as it says.
#[test]
fn covariances_are_those_of_the_filter_and_fit_the_errors() {
    let folder = tempfile::tempdir().unwrap();
    let text = "schema = 1\n[imu]\nrate = \"20 Hz\"\n[procedure.calibration]\npositions = \"eight\"\n\
                duration = \"1 h\"\n[procedure.navigation]\nduration = \"1 min\"\n";
    std::fs::write(folder.path().join("hour.toml"), text).unwrap();
    run(folder.path(), "hour.toml", &["--out", "run"]);
    let path = folder.path().join("run/recording.mcap");
    let mut covariances = BTreeMap::new();
    let (mut sum, mut count) = (0.0, 0.0);
    let mut epochs = Epochs::new(Recording::open(&path).unwrap());
    while let Some(epoch) = epochs.next_epoch().unwrap() {
        let Some(covariance) = epoch.covariance else { continue };
        let (output, truth) = (epoch.output.unwrap(), epoch.truth.unwrap());
        assert_eq!(output.mode, Mode::Calibrating);
        covariances.insert(epoch.time_ns, covariance);
        let errors = NavigationErrors::of(&output, &truth);
        let diagonal = [0, 3, 5].map(|i| covariance.velocity_m2ps2[i]);
        for (error, variance) in errors.velocity_ned_mps.into_iter().zip(diagonal) {
            sum += error * error / variance;
            count += 1.0;
        }
        // Both are of the solution after the measurement, in whose 1 mm/s the velocity is known.
        assert!(diagonal.iter().all(|variance| *variance < 1e-6), "{diagonal:?}");
    }
    // Every ten seconds until the one at whose end the core navigates. The first epoch has no reference.
    assert_eq!(covariances.len(), 359);
    // Expected 1. If ten messages in a row count as one, 108 independent squares have a mean with a
    // standard deviation of 0.14.
    let mean = sum / count;
    assert!(
        (mean - 1.0).abs() < 4.0 * 0.14,
        "mean square of velocity errors over variance: {mean}"
    );

    let found = further(&std::fs::read(&path).unwrap());
    let mut known = 0;
    for (time_ns, message) in &found["/fix"] {
        // Encapsulation, stamp 8, frame 4 + 4, status 1 and service 2, three numbers from byte 24 on.
        let matrix: [f64; 9] = std::array::from_fn(|i| number(message, 4 + 24, 3 + i));
        let kind = message[4 + 24 + 12 * 8];
        match covariances.get(time_ns) {
            Some(covariance) => {
                let [nn, ne, nd, ee, ed, dd] = covariance.position_m2;
                assert_eq!((kind, matrix), (3, [ee, ne, -ed, ne, nn, -nd, -ed, -nd, dd]));
                known += 1;
            }
            None => assert_eq!((kind, matrix), (0, [0.0; 9])),
        }
    }
    assert_eq!(known, 359);
    for (time_ns, message) in &found["/imu/data"] {
        // Encapsulation, stamp 8, frame 4 + 9 up to byte 24; four numbers of the orientation.
        let matrix: [f64; 9] = std::array::from_fn(|i| number(message, 4 + 24, 4 + i));
        let wanted = covariances.get(time_ns).map_or([0.0; 9], |covariance| {
            let [nn, ne, nd, ee, ed, dd] = covariance.attitude_rad2;
            [ee, ne, -ed, ne, nn, -nd, -ed, -nd, dd]
        });
        assert_eq!(matrix, wanted, "at {time_ns} ns");
    }
}
