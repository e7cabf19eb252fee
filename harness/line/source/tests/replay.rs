//! Replay: a full recording gives every epoch again; others are refused or mapped.

use super::common::epochs::{push, record, truth_of};
use super::common::stream::stream;
use octant_recorder::{Policy, Recorder, RecorderOptions, Samples, StreamHash};
use octant_sample::counts::DELTA_THETA_LSB_RAD;
use octant_sample::{GimbalCommand, Status};
use octant_scenario::recorded::{
    MappedField, MappedStamp, McapMapping, RecordedQuantity, TemperatureField, TemperatureUnit,
    TimeUnit,
};
use octant_source::{Epoch, Replay, Source, SourceError};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn full() -> RecorderOptions {
    RecorderOptions {
        policy: Policy { samples: Samples::Full, ..Policy::default() },
        ..RecorderOptions::default()
    }
}

fn all(source: &mut Replay) -> Result<Vec<Epoch>, SourceError> {
    let mut epochs = Vec::new();
    let mut epoch = Epoch::default();
    while source.next(&GimbalCommand::default(), &mut epoch)? {
        epochs.push(epoch);
    }
    Ok(epochs)
}

fn write(folder: &tempfile::TempDir, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join("recording.mcap");
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn a_full_recording_gives_every_epoch_again() {
    let mut steps = stream(2500);
    for k in 700..720 {
        steps[k].faulted.sample.delta_theta[2] = 0;
    }
    steps[999].faulted.aiding = None;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.mcap");
    let mut recorder = Recorder::to_file(&path, &full()).unwrap();
    for step in &steps {
        push(&mut recorder, step).unwrap();
    }
    let summary = recorder.finish().unwrap();
    assert_eq!(summary.altered, 21);
    assert_eq!(summary.bytes, std::fs::metadata(&path).unwrap().len());

    let mut replay = Replay::open(&path, None).unwrap();
    assert_eq!(replay.samples_total(), Some(2500));
    let mut hash = StreamHash::new();
    let mut truths = 0;
    let mut epoch = Epoch::default();
    for step in &steps {
        assert!(replay.next(&GimbalCommand::default(), &mut epoch).unwrap());
        assert_eq!(epoch, step.faulted, "what reached the core, faults included");
        let recorded = replay.recorded();
        assert_eq!(recorded.clean_sample.unwrap_or(epoch.sample), step.clean.sample);
        assert_eq!(recorded.clean_aiding.unwrap_or(epoch.aiding), step.clean.aiding);
        if let Some(truth) = replay.truth() {
            assert_eq!(truth, truth_of(step));
            truths += 1;
        }
        // A core with the same outputs has the same hash.
        hash.epoch(&epoch.sample, epoch.aiding.as_ref(), &step.output);
        if let Some(parameters) = &step.parameters {
            hash.parameters(parameters);
        }
    }
    assert!(!replay.next(&GimbalCommand::default(), &mut epoch).unwrap());
    assert!(!replay.truncated());
    assert_eq!(hash.hex(), summary.stream_hash);
    assert_eq!(truths, 14, "the first epoch, twelve whole seconds and the change of mode");
    // A run is never overwritten.
    let error = Recorder::to_file(&path, &full()).unwrap_err();
    assert!(error.to_string().contains("recording.mcap"), "{error}");
}

#[test]
fn a_decimated_recording_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let (bytes, _) = record(&stream(1000), &RecorderOptions::default());
    let error = Replay::open(&write(&folder, &bytes), None).err().unwrap().to_string();
    assert!(error.contains("record.samples = \"full\""), "{error}");
    assert!(error.contains("a sample every 1 s"), "{error}");
}

#[test]
fn a_truncated_recording_is_replayed_up_to_its_last_whole_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let steps = stream(20_000);
    let (bytes, _) = record(&steps, &full());
    let path = write(&folder, &bytes[..bytes.len() * 2 / 3]);
    let mut replay = Replay::open(&path, None).unwrap();
    assert_eq!(replay.samples_total(), None, "a torn file has no summary");
    let epochs = all(&mut replay).unwrap();
    assert!(replay.truncated());
    assert!(epochs.len() > 8000 && epochs.len() < 15_000, "{}", epochs.len());
    assert!(epochs.iter().zip(&steps).all(|(epoch, step)| *epoch == step.faulted));
}

/// Writes messages as another program would.
fn foreign(path: &Path, schema: Option<(&str, &str)>, encoding: &str, messages: &[Vec<u8>]) {
    let file = std::fs::File::create(path).unwrap();
    let mut writer = mcap::WriteOptions::new()
        .compression(Some(mcap::Compression::Lz4))
        .create(std::io::BufWriter::new(file))
        .unwrap();
    let schema = schema
        .map_or(0, |(name, text)| writer.add_schema(name, "ros2msg", text.as_bytes()).unwrap());
    let other = writer.add_channel(0, "/camera", "json", &BTreeMap::new()).unwrap();
    let channel = writer.add_channel(schema, "/imu/data", encoding, &BTreeMap::new()).unwrap();
    for (i, message) in messages.iter().enumerate() {
        let header = |channel_id| mcap::records::MessageHeader {
            channel_id,
            sequence: i as u32,
            log_time: 1_000_000_000 + i as u64 * 10_000_000,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header(other), b"{}").unwrap();
        writer.write_to_known_channel(&header(channel), message).unwrap();
    }
    writer.finish().unwrap();
}

const IMU: &str = "\
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance # row major
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// Encodes `sensor_msgs/msg/Imu` in little-endian CDR, by hand from its definition.
fn imu_cdr(sec: i32, nanosec: u32, frame_id: &str, gyro: [f64; 3], accel: [f64; 3]) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(sec.to_le_bytes());
    bytes.extend(nanosec.to_le_bytes());
    bytes.extend((frame_id.len() as u32 + 1).to_le_bytes());
    bytes.extend(frame_id.as_bytes());
    bytes.push(0);
    while (bytes.len() - 4) % 8 != 0 {
        bytes.push(0);
    }
    let zeros = [0.0; 9];
    for value in [0.0, 0.0, 0.0, 1.0]
        .iter()
        .chain(&zeros)
        .chain(&gyro)
        .chain(&zeros)
        .chain(&accel)
        .chain(&zeros)
    {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

#[test]
fn a_ros_imu_topic_becomes_samples() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ros.mcap");
    let gyro = [0.1, -0.2, 0.3];
    // Frame ids of other lengths shift all following fields.
    let messages: Vec<_> = (0..5u32)
        .map(|k| imu_cdr(2, k * 10_000_000, &"imu_link"[..k as usize + 1], gyro, [0.0, 0.0, 9.8]))
        .collect();
    foreign(&path, Some(("sensor_msgs/msg/Imu", IMU)), "cdr", &messages);
    let mut replay = Replay::open(&path, Some(&McapMapping::ros_imu("/imu/data", 100.0))).unwrap();
    let epochs = all(&mut replay).unwrap();
    assert_eq!(epochs.len(), 5);
    assert_eq!(epochs[4].sample.device_time.ns, 2_040_000_000);
    assert_eq!(epochs[4].sample.status, Status::GIMBAL_INVALID);
    for axis in 0..3 {
        let sum: i64 = epochs.iter().map(|e| i64::from(e.sample.delta_theta[axis])).sum();
        let expected = gyro[axis] * 0.05 / DELTA_THETA_LSB_RAD;
        assert!((sum as f64 - expected).abs() <= 0.5, "{sum} {expected}");
    }
    // Without a mapping it isn't an octant recording.
    let error = Replay::open(&path, None).err().unwrap().to_string();
    assert!(error.contains("not a recording of octant"), "{error}");
}

#[test]
fn a_temperature_in_messages_is_read_where_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("warm.mcap");
    let message = |(k, warm): (u64, &str)| {
        format!(r#"{{"w":[1,2,3],"warm":{warm},"t":{}}}"#, k * 5_000_000).into_bytes()
    };
    let messages: Vec<_> = (1..).zip(["298.15", "299", "360"]).map(message).collect();
    foreign(&path, None, "json", &messages);
    let field = |path: &str| MappedField { path: path.into(), offset: 0.0, scale: 1.0 };
    let triad = ["w[0]", "w[1]", "w[2]"].map(field);
    let mut mapping = McapMapping {
        gyro: triad.clone(),
        accelerometer: triad,
        stamp: MappedStamp::Field {
            path: "t".into(),
            unit: TimeUnit::Nanosecond,
            nanoseconds: None,
        },
        temperature: Some(TemperatureField { path: "warm".into(), unit: TemperatureUnit::Kelvin }),
        ..McapMapping::ros_imu("/imu/data", 200.0)
    };
    let (mut epoch, command) = (Epoch::default(), GimbalCommand::default());
    let mut source = Replay::open(&path, Some(&mapping)).unwrap();
    assert!(source.next(&command, &mut epoch).unwrap());
    assert!((source.temperature_c().unwrap().unwrap() - 25.0).abs() < 1e-9);
    // A run doesn't ask.
    assert_eq!(all(&mut source).unwrap().len(), 2);
    let said = source.temperature_c().unwrap_err().to_string();
    assert!(
        said.contains(
            "warm.mcap: message 3 on /imu/data: field warm: temperature 360 K, 61.9 K from"
        ),
        "{said}"
    );
    mapping.temperature =
        Some(TemperatureField { path: "cold".into(), unit: TemperatureUnit::Kelvin });
    let said = all(&mut Replay::open(&path, Some(&mapping)).unwrap()).unwrap_err().to_string();
    assert!(said.contains("message 1 on /imu/data") && said.contains("cold"), "{said}");
}

#[test]
fn json_messages_become_samples() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("json.mcap");
    let messages: Vec<_> = (1..=3)
        .map(|k| format!(r#"{{"t":{},"w":[1,2,3],"acc":{{"x":1e-1,"y":0,"z":2}}}}"#, k * 5_000_000))
        .map(String::into_bytes)
        .collect();
    foreign(&path, None, "json", &messages);
    let field = |path: &str, scale| MappedField { path: path.into(), offset: 0.0, scale };
    let degree = std::f64::consts::PI / 180.0;
    let mut mapping = McapMapping {
        topic: "/imu/data".into(),
        accelerometer_topic: None,
        gyro: [field("w[1]", degree), field("w[0]", -degree), field("w[2]", degree)],
        accelerometer: [field("acc.x", 1.0), field("acc.y", 1.0), field("acc.z", 1.0)],
        quantity: RecordedQuantity::Rates,
        stamp: MappedStamp::Field {
            path: "t".into(),
            unit: TimeUnit::Nanosecond,
            nanoseconds: None,
        },
        nominal_rate_hz: 200.0,
        split: 1,
        gimbal: None,
        temperature: None,
    };
    let epochs = all(&mut Replay::open(&path, Some(&mapping)).unwrap()).unwrap();
    assert_eq!(epochs[2].sample.device_time.ns, 15_000_000);
    let expected = (2.0 * degree * 0.005 / DELTA_THETA_LSB_RAD).round() as i32;
    assert_eq!(epochs[0].sample.delta_theta[0], expected);
    assert!(epochs[0].sample.delta_theta[1] < 0);

    // The messages were logged every 10 ms.
    (mapping.stamp, mapping.nominal_rate_hz) = (MappedStamp::LogTime, 100.0);
    let epochs = all(&mut Replay::open(&path, Some(&mapping)).unwrap()).unwrap();
    assert_eq!(epochs[1].sample.device_time.ns, 1_010_000_000);

    let error = |mapping: &McapMapping| {
        all(&mut Replay::open(&path, Some(mapping)).unwrap()).unwrap_err().to_string()
    };
    mapping.gyro[0].path = "w[7]".into();
    let found = error(&mapping);
    assert!(found.contains("message 1 on /imu/data: field w[7] is missing"), "{found}");
    mapping.gyro[0].path = "acc".into();
    let found = error(&mapping);
    assert!(found.contains("expected a number"), "{found}");
    mapping.topic = "/imu".into();
    let found = error(&mapping);
    assert!(found.contains("no topic \"/imu\"; the file has /camera, /imu/data"), "{found}");
}

#[test]
fn messages_that_are_cut_or_of_a_wild_schema_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.mcap");
    let whole = imu_cdr(1, 0, "imu", [0.0; 3], [0.0; 3]);
    let mapping = McapMapping::ros_imu("/imu/data", 100.0);
    let error = |schema: &str, message: &[u8]| {
        foreign(&path, Some(("sensor_msgs/msg/Imu", schema)), "cdr", &[message.to_vec()]);
        all(&mut Replay::open(&path, Some(&mapping)).unwrap()).unwrap_err().to_string()
    };
    for length in 0..whole.len() {
        let found = error(IMU, &whole[..length]);
        assert!(found.contains("message 1 on /imu/data"), "{found}");
    }
    let found = error("Loop a\n===\nMSG: sensor_msgs/Loop\nLoop a\n", &whole);
    assert!(found.contains("messages in messages"), "{found}");
    let found = error("Empty[4294967295] a\n===\nMSG: sensor_msgs/Empty\nuint8[0] b\n", &whole);
    assert!(found.contains("fields in one message"), "{found}");
    let found = error("uint8[4294967295] a\n", &whole);
    assert!(found.contains("message ends"), "{found}");
    let found = error("Vector a\n", &whole);
    assert!(found.contains("no definition of sensor_msgs/Vector"), "{found}");
    let found = error("float64[x] a\n", &whole);
    assert!(found.contains("line 1: found \"float64[x]\""), "{found}");
}
