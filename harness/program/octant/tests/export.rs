//! `octant export`: every number of a recording in every format, and what it refuses.

use crate::common::epochs::{Step, push};
use crate::common::program::{ended, json, octant_in};
use crate::common::stream::stream;
use octant_recorder::{Policy, Recorder, RecorderOptions, Samples};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Half a minute at 200 Hz in a folder of its own, with one altered sample.
fn recorded(samples: Samples) -> (tempfile::TempDir, Vec<Step>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.mcap");
    let policy = Policy { samples, ..Policy::default() };
    let options =
        RecorderOptions { policy, scenario: "schema = 1\n".into(), ..RecorderOptions::default() };
    let mut recorder = Recorder::to_file(&path, &options).unwrap();
    let mut steps = stream(6000);
    steps[999].faulted.sample.delta_theta = [1, 2, 3];
    for step in &steps {
        push(&mut recorder, step).unwrap();
    }
    recorder.finish().unwrap();
    (folder, steps)
}

fn export(folder: &Path, words: &[&str], status: i32) -> (String, String) {
    let words = [&["export", "recording.mcap"], words].concat();
    ended(octant_in(folder, &words), status)
}

/// Columns of a CSV file by name.
fn read_csv(path: PathBuf) -> BTreeMap<String, Vec<String>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for record in reader.records() {
        for (name, field) in names.iter().zip(record.unwrap().iter()) {
            columns.entry(name.clone()).or_default().push(field.to_owned());
        }
    }
    columns
}

#[test]
fn csv_has_every_sample_and_output_to_the_last_bit() {
    let (folder, steps) = recorded(Samples::Full);
    let (files, notes) = export(folder.path(), &["--to", "csv", "--out", "x"], 0);
    assert_eq!(files.lines().count(), 7, "{files}");
    assert!(notes.contains("faults: the recording has no rows"), "{notes}");
    let samples = read_csv(folder.path().join("x/samples.csv"));
    let navigation = read_csv(folder.path().join("x/navigation.csv"));
    assert_eq!(samples["time_s"].len(), steps.len());
    let bits = |text: &str| text.parse::<f64>().unwrap().to_bits();
    for (i, step) in steps.iter().enumerate() {
        let sample = &step.faulted.sample;
        let theta = f64::from(sample.delta_theta[2]) * DELTA_THETA_LSB_RAD;
        let velocity = f64::from(sample.delta_velocity[0]) * DELTA_VELOCITY_LSB_MPS;
        assert_eq!(bits(&samples["delta_theta_z_rad"][i]), theta.to_bits());
        assert_eq!(bits(&samples["delta_velocity_x_mps"][i]), velocity.to_bits());
        assert_eq!(samples["clean_sequence"][i].is_empty(), i != 999);
        let height = step.output.navigation.height_m;
        assert_eq!(bits(&navigation["height_m"][i]), height.to_bits());
        assert_eq!(navigation["nis"][i].is_empty(), step.output.nis.is_nan());
    }
    // Truth is recorded once a second, and so are the errors.
    let with_truth = |name: &str| navigation[name].iter().filter(|text| !text.is_empty()).count();
    assert!((30..40).contains(&with_truth("true_latitude_deg")));
    assert_eq!(with_truth("true_latitude_deg"), with_truth("latitude_error_arcmin"));
    let about = json(&folder.path().join("x/export.json"));
    assert_eq!(about["version"], 1);
    assert_eq!(about["tables"][0]["columns"][0]["unit"], "s");
}

#[test]
fn parquet_has_the_numbers_and_their_units() {
    let (folder, steps) = recorded(Samples::Full);
    export(folder.path(), &["--to", "parquet", "--out", "x", "--tables", "navigation"], 0);
    let file = std::fs::File::open(folder.path().join("x/navigation.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let metadata = reader.metadata().file_metadata();
    let value = |key: &str| {
        let pairs = metadata.key_value_metadata().unwrap();
        pairs.iter().find(|pair| pair.key == key).unwrap().value.clone().unwrap()
    };
    assert_eq!(value("octant.export"), "1");
    let columns: Value = serde_json::from_str(&value("octant.columns")).unwrap();
    let place = columns.as_array().unwrap().iter().position(|c| c["name"] == "latitude_deg");
    let place = place.unwrap();
    assert_eq!(columns[place]["unit"], "deg");
    assert!(value("ARROW:schema").starts_with("/////"), "the marker of a message");
    let rows = reader.get_row_iter(None).unwrap();
    let latitudes: Vec<f64> = rows.map(|row| row.unwrap().get_double(place).unwrap()).collect();
    let wanted: Vec<f64> =
        steps.iter().map(|step| step.output.navigation.latitude_rad.to_degrees()).collect();
    assert_eq!(latitudes, wanted);
}

#[test]
fn a_coarser_step_keeps_rows_with_their_own_time() {
    let (folder, _) = recorded(Samples::Full);
    let words = ["--to", "csv", "--out", "x", "--tables", "samples", "--every", "2.5 s"];
    export(folder.path(), &words, 0);
    let times = read_csv(folder.path().join("x/samples.csv")).remove("time_s").unwrap();
    // The first sample, then those at the multiples up to 30 s.
    assert_eq!(times.len(), 13, "{times:?}");
    assert_eq!((times[0].as_str(), times[1].as_str(), times[12].as_str()), ("0.005", "2.5", "30"));
}

#[test]
fn mat_kml_and_rosbag_are_files_of_their_kind() {
    let (folder, steps) = recorded(Samples::Decimated);
    let at = |name: &str| folder.path().join(name);
    export(folder.path(), &["--to", "mat", "--out", "x.mat"], 0);
    let bytes = std::fs::read(at("x.mat")).unwrap();
    assert_eq!(&bytes[124..128], [0, 1, b'I', b'M']);
    // Variables follow one another to the end of the file: each is a matrix with its length.
    let (mut place, mut variables) = (128, 0);
    while place < bytes.len() {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(word(place), 14);
        place += 8 + word(place + 4);
        variables += 1;
    }
    assert_eq!(place, bytes.len());
    // All tables but that of the faults, units and origin.
    assert_eq!(variables, 6 + 2);

    export(folder.path(), &["--to", "kml", "--out", "x.kml"], 0);
    let text = std::fs::read_to_string(at("x.kml")).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let count = |name: &str| document.descendants().filter(|n| n.tag_name().name() == name).count();
    assert_eq!(count("when"), count("coord"));
    assert_eq!(count("Track"), 2);
    assert_eq!(
        document.root_element().tag_name().namespace(),
        Some("http://www.opengis.net/kml/2.2")
    );

    export(folder.path(), &["--to", "rosbag-mcap", "--out", "x.mcap"], 0);
    let bytes = std::fs::read(at("x.mcap")).unwrap();
    let mut topics: BTreeMap<String, u64> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        // A reader of bags takes no other.
        assert_eq!(message.channel.message_encoding, "cdr");
        assert_eq!(message.channel.schema.as_ref().unwrap().encoding, "ros2msg");
        *topics.entry(message.channel.topic.clone()).or_default() += 1;
        if message.channel.topic == "/imu/data" {
            assert_eq!(message.channel.schema.as_ref().unwrap().name, "sensor_msgs/msg/Imu");
            // Encapsulation, header 8 + 4 + 9 (filled up to 24), 4 + 9 + 3 + 9 + 3 + 9 numbers.
            assert_eq!(message.data.len(), 4 + 24 + 37 * 8);
        }
    }
    assert_eq!(topics["/imu/data"], topics["/fix"], "{topics:?}");
    for topic in ["/error/position", "/truth/fix", "/octant/error", "/octant/parameters"] {
        assert!(topics.contains_key(topic), "{topic}: {topics:?}");
    }
    assert!(steps.len() > 1);
}

#[test]
fn a_recording_that_was_cut_is_exported_up_to_its_end() {
    let (folder, _) = recorded(Samples::Full);
    let path = folder.path().join("recording.mcap");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let (_, notes) = export(folder.path(), &["--to", "csv", "--out", "x"], 0);
    assert!(notes.contains("recording.mcap: the recording is truncated after"), "{notes}");
    let rows = read_csv(folder.path().join("x/samples.csv"))["time_s"].len();
    assert!((100..6000).contains(&rows), "{rows}");
    assert_eq!(json(&folder.path().join("x/export.json"))["recording"]["truncated"], true);
}

#[test]
fn mistakes_are_told_and_nothing_is_overwritten() {
    let (folder, _) = recorded(Samples::Decimated);
    for (words, told) in [
        (&["--to", "xlsx"][..], "unknown format \"xlsx\""),
        (&["--to", "parquett"], "parquet"),
        (&["--to", "csv", "--tables", "sample"], "samples"),
        (&["--to", "kml", "--tables", "samples"], "kml has no tables"),
        (&["--to", "csv", "--every", "0 s"], "more than 0 s"),
        (&["--to", "csv", "--every", "1 m"], "expected a time"),
        (&["--to", "csv", "--tables", "faults"], "no rows"),
    ] {
        let (_, error) = export(folder.path(), words, 2);
        assert!(error.contains(told), "{words:?}: {error}");
    }
    std::fs::write(folder.path().join("x.kml"), "mine").unwrap();
    let (_, error) = export(folder.path(), &["--to", "kml", "--out", "x.kml"], 2);
    assert!(error.contains("x.kml: it is there already; --force replaces it"), "{error}");
    assert_eq!(std::fs::read_to_string(folder.path().join("x.kml")).unwrap(), "mine");
    export(folder.path(), &["--to", "kml", "--out", "x.kml", "--force"], 0);
    std::fs::write(folder.path().join("other.mcap"), "no recording").unwrap();
    let (_, error) = ended(octant_in(folder.path(), &["export", "other.mcap", "--to", "csv"]), 2);
    assert!(error.contains("other.mcap"), "{error}");
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().flatten().collect();
    let is_new = |name: &std::ffi::OsStr| name.to_string_lossy().ends_with(".new");
    assert!(!left.iter().any(|entry| is_new(&entry.file_name())), "{left:?}");
}
