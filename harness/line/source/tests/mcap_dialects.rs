//! MCAP files of other programs: messages of ROS 1, definitions in IDL, two topics, files that are cut off.

use octant_sample::counts::DELTA_THETA_LSB_RAD;
use octant_sample::{GimbalCommand, Sample};
use octant_scenario::recorded::{MappedField, MappedStamp, McapMapping, TimeUnit};
use octant_source::{Epoch, Replay, Source};
use std::collections::BTreeMap;
use std::path::Path;

/// `sensor_msgs/Imu` as `mcap convert` takes it out of a bag of ROS 1.
const ROS1_IMU: &str = "\
# This is a message to hold data from an IMU
Header header

geometry_msgs/Quaternion orientation
float64[9] orientation_covariance # Row major about x, y, z axes

geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance

geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
================================================================================
MSG: std_msgs/Header
# Standard metadata
uint32 seq
time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
";

/// `sensor_msgs/msg/Imu` as `rosidl_adapter` writes it, with what it contains.
const IDL_IMU: &str = r#"================================================================================
IDL: sensor_msgs/msg/Imu
// generated from rosidl_adapter/resource/msg.idl.em
// with input from sensor_msgs/msg/Imu.msg
// generated code does not contain a copyright notice

#include "geometry_msgs/msg/Quaternion.idl"
#include "std_msgs/msg/Header.idl"

module sensor_msgs {
  module msg {
    typedef double double__9[9];
    @verbatim (language="comment", text=
      "This is a message to hold data from an IMU (Inertial Measurement Unit)" "\n"
      "Accelerations should be in m/s^2 (not in g's); // no \"comment\" here")
    struct Imu {
      std_msgs::msg::Header header;

      geometry_msgs::msg::Quaternion orientation;

      @verbatim (language="comment", text=
        "Row major about x, y, z axes")
      double__9 orientation_covariance;

      geometry_msgs::msg::Vector3 angular_velocity;

      double__9 angular_velocity_covariance;

      @unit (value="m/s^2")
      geometry_msgs::msg::Vector3 linear_acceleration;

      double__9 linear_acceleration_covariance;
    };
  };
};
================================================================================
IDL: geometry_msgs/msg/Quaternion
module geometry_msgs {
  module msg {
    struct Quaternion {
      @default (value=0.0)
      double x;
      @default (value=0.0)
      double y, z;
      @default (value=1.0)
      double w;
    };
  };
};
================================================================================
IDL: geometry_msgs/msg/Vector3
module geometry_msgs { module msg {
    /* Three of them,
       in free space. */
    struct Vector3 { double x; double y; double z; };
}; };
================================================================================
IDL: std_msgs/msg/Header
module std_msgs {
  module msg {
    struct Header {
      builtin_interfaces::msg::Time stamp;
      string frame_id;
    };
  };
};
================================================================================
IDL: builtin_interfaces/msg/Time
module builtin_interfaces {
  module msg {
    struct Time {
      int32 sec;
      uint32 nanosec;
    };
  };
};
"#;

/// Channel of a file: topic, encoding, and name, encoding and text of its schema.
type Channel<'a> = (&'a str, &'a str, Option<(&'a str, &'a str, &'a str)>);

/// Writes messages, each on a channel, with its log time in ms.
fn write(path: &Path, channels: &[Channel<'_>], messages: &[(usize, u64, Vec<u8>)]) {
    let file = std::fs::File::create(path).unwrap();
    let mut writer = mcap::Writer::new(std::io::BufWriter::new(file)).unwrap();
    let ids: Vec<u16> = channels
        .iter()
        .map(|(topic, encoding, schema)| {
            let schema = schema.map_or(0, |(name, encoding, text)| {
                writer.add_schema(name, encoding, text.as_bytes()).unwrap()
            });
            writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap()
        })
        .collect();
    for (sequence, (channel, log_ms, message)) in (0..).zip(messages) {
        let log_time = log_ms * 1_000_000;
        let channel_id = ids[*channel];
        let header =
            mcap::records::MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, message).unwrap();
    }
    writer.finish().unwrap();
}

fn all(path: &Path, mapping: &McapMapping) -> (Vec<Sample>, Replay, Option<String>) {
    let mut found = Vec::new();
    let mut epoch = Epoch::default();
    let mut replay = Replay::open(path, Some(mapping)).unwrap();
    loop {
        match replay.next(&GimbalCommand::default(), &mut epoch) {
            Ok(true) => found.push(epoch.sample),
            Ok(false) => return (found, replay, None),
            Err(error) => return (found, replay, Some(error.to_string())),
        }
    }
}

const GYRO: [f64; 3] = [0.1, -0.2, 0.3];

/// Checks that samples at 100 Hz have these rates.
fn check(samples: &[Sample]) {
    for axis in 0..3 {
        let sum: i64 = samples.iter().map(|sample| i64::from(sample.delta_theta[axis])).sum();
        let expected = GYRO[axis] * 0.01 * samples.len() as f64 / DELTA_THETA_LSB_RAD;
        assert!((sum as f64 - expected).abs() <= 1.0, "{sum} {expected}");
    }
}

fn doubles(bytes: &mut Vec<u8>, values: &[f64]) {
    values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
}

/// Bytes of `sensor_msgs/Imu` in ROS 1: without padding.
fn ros1_imu(number: u32, frame_id: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    for word in [number, 2, number * 10_000_000, frame_id.len() as u32] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(frame_id.as_bytes());
    doubles(&mut bytes, &[0.0, 0.0, 0.0, 1.0]);
    doubles(&mut bytes, &[0.0; 9]);
    doubles(&mut bytes, &GYRO);
    doubles(&mut bytes, &[0.0; 9]);
    doubles(&mut bytes, &[0.0, 0.0, 9.8]);
    doubles(&mut bytes, &[0.0; 9]);
    bytes
}

/// Bytes of `sensor_msgs/msg/Imu` in ROS 2.
fn ros2_imu(number: u32, frame_id: &str) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    for word in [2, number * 10_000_000, frame_id.len() as u32 + 1] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(frame_id.as_bytes());
    bytes.push(0);
    while (bytes.len() - 4) % 8 != 0 {
        bytes.push(0);
    }
    bytes.extend(&ros1_imu(number, "")[16..]);
    bytes
}

fn mapping(stamp: [&str; 2]) -> McapMapping {
    let [path, nanoseconds] = stamp.map(str::to_owned);
    let stamp = MappedStamp::Field { path, unit: TimeUnit::Second, nanoseconds: Some(nanoseconds) };
    McapMapping { stamp, ..McapMapping::ros_imu("/imu/data", 100.0) }
}

#[test]
fn messages_of_ros_1_and_definitions_in_idl_become_samples() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("imu.mcap");
    for (encoding, schema, message, stamp) in [
        (
            "ros1",
            ("sensor_msgs/Imu", "ros1msg", ROS1_IMU),
            ros1_imu as fn(u32, &str) -> Vec<u8>,
            ["header.stamp.sec", "header.stamp.nsec"],
        ),
        (
            "cdr",
            ("sensor_msgs/msg/Imu", "ros2idl", IDL_IMU),
            ros2_imu,
            ["header.stamp.sec", "header.stamp.nanosec"],
        ),
    ] {
        // Names of other lengths shift all that follows.
        let messages: Vec<_> =
            (0..8_u32).map(|k| (0, 0, message(k, &"imu_link"[..k as usize]))).collect();
        write(&path, &[("/imu/data", encoding, Some(schema))], &messages);
        let (samples, _, error) = all(&path, &mapping(stamp));
        assert_eq!((samples.len(), error), (8, None), "{encoding}");
        assert_eq!(samples[7].device_time.ns - samples[0].device_time.ns, 70_000_000);
        check(&samples);
        // A message that is cut off, at each of its bytes.
        let whole = message(1, "imu");
        for length in 0..whole.len() {
            write(
                &path,
                &[("/imu/data", encoding, Some(schema))],
                &[(0, 0, whole[..length].into())],
            );
            let said = all(&path, &mapping(stamp)).2.unwrap();
            assert!(said.contains("message 1 on /imu/data: message "), "{said}");
        }
    }
}

#[test]
fn a_schema_that_does_not_belong_to_its_encoding_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("imu.mcap");
    let said = |encoding: &str, schema: Option<(&str, &str, &str)>| {
        write(&path, &[("/imu/data", encoding, schema)], &[(0, 0, ros2_imu(1, ""))]);
        all(&path, &mapping(["header.stamp.sec", "header.stamp.nanosec"])).2.unwrap()
    };
    for (encoding, schema, expected) in [
        (
            "cdr",
            Some(("a/Imu", "ros1msg", ROS1_IMU)),
            "has a schema in \"ros1msg\", expected ros2msg or ros2idl",
        ),
        (
            "ros1",
            Some(("a/Imu", "ros2msg", ROS1_IMU)),
            "has a schema in \"ros2msg\", expected ros1msg",
        ),
        ("ros1", None, "topic /imu/data has no schema, expected ros1msg"),
        ("protobuf", None, "topic /imu/data is in protobuf, expected json, cdr or ros1"),
    ] {
        let found = said(encoding, schema);
        assert!(found.contains(expected), "{found}");
    }
    for (text, expected) in [
        ("struct Imu { union U u; };", "line 1: union can't be read"),
        ("struct Imu {\n wstring a; };", "line 2: wstring can't be read"),
        ("struct Imu : Base { double a; };", "structure Imu has a base"),
        ("struct Imu { Other a; };", "the schema has no definition of Other"),
        ("struct Imu { double a[N]; };", "found bound \"N\", expected a number or a constant"),
        ("module a { struct Imu { double b; };", "the text ends within a module"),
        ("typedef A B; typedef B A; struct Imu { A a; };", "typedefs in a row"),
        ("struct Imu { double a[100000][100000]; };", "elements, expected 1048576 at most"),
        ("interface Imu {};", "found \"interface\", expected module"),
        ("struct Imu { double a }; ", "found '}', expected ';'"),
        ("@a(b struct", "an annotation has no end"),
    ] {
        let found = said("cdr", Some(("Imu", "ros2idl", text)));
        assert!(found.contains(expected), "{text}: {found}");
    }
    let deep = format!("{}struct Imu {{ double a; }};", "module a {".repeat(100));
    let found = said("cdr", Some(("Imu", "ros2idl", &deep)));
    assert!(found.contains("more than 32 modules"), "{found}");
}

#[test]
fn a_damaged_definition_is_an_error_or_another_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("imu.mcap");
    for (encoding, form, text, stamp) in [
        ("cdr", "ros2idl", IDL_IMU, ["header.stamp.sec", "header.stamp.nanosec"]),
        ("ros1", "ros1msg", ROS1_IMU, ["header.stamp.sec", "header.stamp.nsec"]),
    ] {
        let mut errors = 0;
        for at in (0..text.len()).step_by(5) {
            for inserted in ["", "{", "}", "<", "[9]", "\"", "/*", ":", "@", "é", "999999999999"] {
                let damaged = format!("{}{inserted}{}", &text[..at], &text[at + 1..]);
                let schema = ("sensor_msgs/msg/Imu", form, damaged.as_str());
                let message = if encoding == "cdr" { ros2_imu(1, "a") } else { ros1_imu(1, "a") };
                write(&path, &[("/imu/data", encoding, Some(schema))], &[(0, 0, message)]);
                errors += u32::from(all(&path, &mapping(stamp)).2.is_some());
            }
        }
        assert!(errors > 500, "{errors}");
    }
}

#[test]
fn constants_enumerations_and_arrays_in_idl_have_their_sizes() {
    let text = "module p { module msg {
        const long N = 2;
        module Imu_Constants { const string NAME = \"a; b\"; const uint8 LOW = 1; };
        enum Kind { @value(3) A, B };
        typedef sequence<float, 4> Floats;
        typedef double Matrix[N][3];
        @final struct Imu {
            Kind kind; octet o; unsigned long long t; Floats floats; Matrix m[N];
            sequence<Part> parts; boolean b; long long last; string<5> text; short s;
        };
        struct Part { int8 a; unsigned short b; };
    }; };";
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(3_u32.to_le_bytes());
    bytes.push(9);
    bytes.extend([0; 3]);
    bytes.extend(2_000_000_000_u64.to_le_bytes());
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend(0.5_f32.to_le_bytes());
    bytes.extend(0.25_f32.to_le_bytes());
    // Twelve doubles behind an alignment to eight: 4 + 4 + 8 + 4 + 8 = 28.
    bytes.extend([0; 4]);
    (0..12).for_each(|k| bytes.extend(f64::from(k).to_le_bytes()));
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend([1, 0, 7, 0, 2, 0, 8, 0]);
    bytes.push(1);
    bytes.extend([0; 3]);
    bytes.extend((-5_i64).to_le_bytes());
    bytes.extend([2, 0, 0, 0, b'x', 0]);
    bytes.extend((-3_i16).to_le_bytes());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("imu.mcap");
    let schema = ("p/msg/Imu", "ros2idl", text);
    write(&path, &[("/imu/data", "cdr", Some(schema))], &[(0, 0, bytes)]);
    let field = |path: &str| MappedField { path: path.into(), offset: 0.0, scale: 1e-3 };
    let mapping = McapMapping {
        gyro: ["m[7]", "parts[1].b", "last"].map(field),
        accelerometer: ["kind", "floats[1]", "s"].map(field),
        stamp: MappedStamp::Field {
            path: "t".into(),
            unit: TimeUnit::Nanosecond,
            nanoseconds: None,
        },
        ..McapMapping::ros_imu("/imu/data", 100.0)
    };
    let (samples, _, error) = all(&path, &mapping);
    assert_eq!(error, None);
    let found = samples[0];
    let counts =
        |values: [f64; 3], lsb: f64| values.map(|value| (value * 1e-5 / lsb).round() as i32);
    assert_eq!(found.delta_theta, counts([7.0, 8.0, -5.0], 2f64.powi(-36)));
    assert_eq!(found.delta_velocity, counts([3.0, 0.25, -3.0], 2f64.powi(-30)));
}

/// Message with a stamp in ms and three numbers.
fn json(ms: u64, values: [f64; 3]) -> Vec<u8> {
    format!(r#"{{"t":{ms},"v":{values:?}}}"#).into_bytes()
}

fn two_topics() -> McapMapping {
    let field = |path: &str| MappedField { path: path.into(), offset: 0.0, scale: 1.0 };
    McapMapping {
        accelerometer_topic: Some("/accel".into()),
        gyro: ["v[0]", "v[1]", "v[2]"].map(field),
        accelerometer: ["v[2]", "v[1]", "v[0]"].map(field),
        stamp: MappedStamp::Field {
            path: "t".into(),
            unit: TimeUnit::Millisecond,
            nanoseconds: None,
        },
        ..McapMapping::ros_imu("/gyro", 100.0)
    }
}

#[test]
fn two_topics_are_joined_by_equal_stamps_and_the_rest_is_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.mcap");
    let channels: [Channel<'_>; 2] = [("/gyro", "json", None), ("/accel", "json", None)];
    let mut messages = Vec::new();
    for k in 1..=200_u64 {
        // Accelerometers are logged before the gyros, and begin earlier and end later.
        if k != 50 {
            messages.push((1, k, json(10 * k, [9.8, 0.5, -0.25])));
        }
        if (3..=195).contains(&k) && k != 70 && k != 71 {
            messages.push((0, k, json(10 * k, GYRO)));
        }
    }
    write(&path, &channels, &messages);
    let (samples, replay, error) = all(&path, &two_topics());
    assert_eq!((samples.len(), error), (190, None));
    check(&samples);
    let force: f64 = samples.iter().map(|sample| f64::from(sample.delta_velocity[2])).sum();
    assert!((force * 2f64.powi(-30) - 9.8 * 0.01 * 190.0).abs() < 1e-8);
    let account = &replay.accounts()[0];
    assert_eq!((account.read(), account.used_count()), (190 + 1 + 9, 190));
    assert_eq!((account.left_out_count(), account.missing_count()), (10, 3));
    let lines = account.lines().join("\n");
    assert!(
        lines.contains(
            "1 messages on /gyro without one of the same stamp on /accel, the first message 48"
        ),
        "{lines}"
    );
    assert!(
        lines.contains(
            "9 messages on /accel without one of the same stamp on /gyro, the first message 1"
        ),
        "{lines}"
    );
}

#[test]
fn topics_without_equal_stamps_and_stamps_that_go_back_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.mcap");
    let channels: [Channel<'_>; 2] = [("/gyro", "json", None), ("/accel", "json", None)];
    let at =
        |k: u64, late: u64| [(0, k, json(10 * k, GYRO)), (1, k, json(10 * k + late, [0.0; 3]))];
    let apart: Vec<_> = (1..=20).flat_map(|k| at(k, 4)).collect();
    write(&path, &channels, &apart);
    let said = all(&path, &two_topics()).2.unwrap();
    assert!(
        said.contains("20 messages on /gyro and 20 messages on /accel, of which no two have the same stamp: the nearest two are 4 ms apart"),
        "{said}"
    );
    let mut back: Vec<_> = (1..=20).flat_map(|k| at(k, 0)).collect();
    back.swap(10, 12);
    write(&path, &channels, &back);
    let said = all(&path, &two_topics()).2.unwrap();
    assert!(
        said.contains(
            "message 7 on /gyro: stamp 60000000 ns is not after the one before, 70000000 ns"
        ),
        "{said}"
    );
    let other = McapMapping { accelerometer_topic: Some("/acc".into()), ..two_topics() };
    let said = all(&path, &other).2.unwrap();
    assert!(said.contains("no topic \"/acc\"; the file has /accel, /gyro"), "{said}");
}

#[test]
fn a_file_that_is_cut_off_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.mcap");
    let schema = ("sensor_msgs/msg/Imu", "ros2idl", IDL_IMU);
    let messages: Vec<_> = (0..400_u32).map(|k| (0, 0, ros2_imu(k, "a"))).collect();
    write(&path, &[("/imu/data", "cdr", Some(schema))], &messages);
    let bytes = std::fs::read(&path).unwrap();
    // The file has one chunk, and before its end there is no topic.
    for length in [8, 9, 40, 200] {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let said = all(&path, &mapping(["header.stamp.sec", "header.stamp.nanosec"])).2.unwrap();
        assert!(
            said.contains("cut.mcap: the file is truncated: it ends before its index"),
            "{said}"
        );
        assert!(!said.contains("the file has none"), "{said}");
    }
    // Behind it nothing but the index is missing.
    std::fs::write(&path, &bytes[..bytes.len() - 30]).unwrap();
    let (samples, replay, error) =
        all(&path, &mapping(["header.stamp.sec", "header.stamp.nanosec"]));
    assert_eq!((samples.len(), error), (400, None));
    assert!(replay.cut_short().unwrap().ends_with("cut.mcap ends in the middle of a recording"));
}

#[test]
fn bags_in_other_containers_are_told_with_what_converts_them() {
    let folder = tempfile::tempdir().unwrap();
    for (begins, expected) in [
        (&b"#ROSBAG V2.0\n"[..], "found a bag of ROS 1, expected MCAP: write `mcap convert"),
        (
            b"SQLite format 3\0",
            "found a bag of ROS 2 in SQLite, expected MCAP: write `mcap convert",
        ),
    ] {
        let path = folder.path().join("bag");
        std::fs::write(&path, [begins, &[0; 100]].concat()).unwrap();
        let said = Replay::open(&path, Some(&two_topics())).err().unwrap().to_string();
        assert!(said.contains(expected), "{said}");
    }
}
