//! Messages of MCAP files, whole and damaged.

use super::rest::{COUNT, RATE_HZ, Rest, readings, scenario};
use super::table::{Case, Counts, Ends, Parameters, Part};
use std::collections::BTreeMap;
use std::io::Cursor;

const FILE: &str = "unit.mcap";
const SOURCE: &str = "uri = \"replay:unit.mcap\"
[source.mcap]
topic = \"/imu\"
[source.mcap.gyro]
x = \"w[0]\"
y = \"w[1]\"
z = \"w[2]\"
unit = \"rad/s\"
quantity = \"rate\"
[source.mcap.accelerometer]
x = \"f[0]\"
y = \"f[1]\"
z = \"f[2]\"
unit = \"m/s^2\"
quantity = \"rate\"
";
/// Setting for stamps in the messages.
const STAMPS: [&str; 2] = ["source.mcap.time_field=t", "source.mcap.time_unit=ns"];

/// Settings for increments.
const INCREMENTS: [&str; 4] = [
    "source.mcap.gyro.unit=rad",
    "source.mcap.gyro.quantity=increment",
    "source.mcap.accelerometer.unit=\"m/s\"",
    "source.mcap.accelerometer.quantity=increment",
];

/// A message: log time, ns, topic, and content.
struct Message {
    log_ns: u64,
    topic: &'static str,
    data: Vec<u8>,
}

/// A JSON message of a reading, logged at a time, ns, with a stamp, ns.
fn json(row: &Rest, log_ns: u64, stamp_ns: u64) -> Message {
    let [gx, gy, gz, ax, ay, az] = row.values;
    let data =
        format!("{{\"t\":{stamp_ns},\"w\":[{gx:e},{gy:e},{gz:e}],\"f\":[{ax:e},{ay:e},{az:e}]}}");
    Message { log_ns, topic: "/imu", data: data.into_bytes() }
}

fn ns(time_s: f64) -> u64 {
    (time_s * 1e9).round() as u64
}

/// Messages with stamps and log times of functions of number and true time, s.
fn messages(stamp_s: impl Fn(u64, f64) -> f64, log_s: impl Fn(u64, f64) -> f64) -> Vec<Message> {
    let rows = readings(RATE_HZ, COUNT).into_iter().zip(0..);
    rows.map(|(row, k)| json(&row, ns(log_s(k, row.time_s)), ns(stamp_s(k, row.time_s)))).collect()
}

fn regular() -> Vec<Message> {
    messages(|_, t| t, |_, t| t)
}

/// A file of these messages, with one channel for each topic.
fn file(messages: &[Message], encoding: &str, options: mcap::WriteOptions) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = options.create(&mut bytes).unwrap();
    let mut channels = BTreeMap::new();
    for (sequence, message) in messages.iter().enumerate() {
        let channel_id = *channels.entry(message.topic).or_insert_with(|| {
            writer.add_channel(0, message.topic, encoding, &BTreeMap::new()).unwrap()
        });
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: sequence as u32,
            log_time: message.log_ns,
            publish_time: message.log_ns,
        };
        writer.write_to_known_channel(&header, &message.data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

fn plain(messages: &[Message]) -> Vec<u8> {
    file(messages, "json", mcap::WriteOptions::new().compression(None))
}

/// A file whose first half is a chunk of its own, cut off behind it.
fn half_then_torn(messages: &[Message]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().compression(None).create(&mut bytes).unwrap();
    let channel_id = writer.add_channel(0, "/imu", "json", &BTreeMap::new()).unwrap();
    let (first, rest) = messages.split_at(messages.len() / 2);
    for half in [first, rest] {
        for Message { log_ns, data, .. } in half {
            let (log_time, publish_time) = (*log_ns, *log_ns);
            let header =
                mcap::records::MessageHeader { channel_id, sequence: 0, log_time, publish_time };
            writer.write_to_known_channel(&header, data).unwrap();
        }
        writer.flush().unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let mut bytes = bytes.into_inner();
    bytes.truncate(bytes.len() * 3 / 5);
    bytes
}

struct Mcap {
    part: Part,
    scenario: String,
}

impl Mcap {
    fn new() -> Self {
        let mut mcap = Self { part: Part::new("MCAP"), scenario: scenario(SOURCE) };
        let clean = mcap.row(
            "regular, times of the log",
            &plain(&regular()),
            &[],
            Counts::used(COUNT),
            Ends::Pass,
        );
        mcap.part.clean = Some(clean);
        mcap
    }

    fn row(
        &mut self,
        holds: &str,
        content: &[u8],
        set: &[&str],
        counts: Counts,
        ends: Ends,
    ) -> Parameters {
        let files: [(&str, &[u8]); 2] = [("s.toml", self.scenario.as_bytes()), (FILE, content)];
        let counts: &[_] = if matches!(ends, Ends::Refused(_)) { &[] } else { &[(FILE, counts)] };
        let input = if set.contains(&STAMPS[0]) { "messages with stamps" } else { "messages" };
        self.part.run(&Case { input, holds, files: &files, set, counts, ends })
    }

    fn refused(&mut self, holds: &str, content: &[u8], set: &[&str], words: &'static str) {
        self.row(holds, content, set, Counts::default(), Ends::Refused(words));
    }
}

/// Gyros and accelerometers on two topics, with stamps of the accelerometers that are late by so much.
fn apart(late_ns: u64, has_force: impl Fn(u64) -> bool) -> Vec<u8> {
    let mut both = Vec::new();
    for (row, k) in readings(RATE_HZ, COUNT).into_iter().zip(0..) {
        let stamp_ns = ns(row.time_s);
        both.push(json(&row, stamp_ns, stamp_ns));
        if has_force(k) {
            let force = json(&row, stamp_ns, stamp_ns + late_ns);
            both.push(Message { topic: "/accel", ..force });
        }
    }
    plain(&both)
}

fn two_topics(mcap: &mut Mcap) {
    let set = [&STAMPS[..], &["source.mcap.accelerometer.topic=/accel"]].concat();
    mcap.row("two topics", &apart(0, |_| true), &set, Counts::used(COUNT), Ends::Pass);
    mcap.row(
        "two topics, one message without a partner",
        &apart(0, |k| k != 1000),
        &set,
        Counts::used(COUNT - 1).left_out(1).missing(1),
        Ends::Pass,
    );
    mcap.refused(
        "two topics, stamps 1 ms apart",
        &apart(1_000_000, |_| true),
        &set,
        "of which no two have the same stamp: the nearest two are 1 ms apart",
    );
}

#[test]
fn messages_of_mcap() {
    let mut mcap = Mcap::new();
    let used = Counts::used;
    let whole = plain(&regular());
    mcap.row("regular", &whole, &STAMPS, used(COUNT), Ends::Pass);
    let options = mcap::WriteOptions::new()
        .compression(Some(mcap::Compression::Zstd))
        .chunk_size(Some(65_536));
    mcap.row(
        "chunks compressed with zstd",
        &file(&regular(), "json", options),
        &[],
        used(COUNT),
        Ends::Pass,
    );
    // Other topics are none of the messages.
    let mut many = Vec::new();
    for message in regular() {
        many.push(Message { log_ns: message.log_ns, topic: "/fix", data: b"{}".to_vec() });
        many.push(message);
    }
    mcap.row("messages of another topic between them", &plain(&many), &[], used(COUNT), Ends::Pass);
    // Jitter.
    let jitter = |k: u64, t: f64| t + if k.is_multiple_of(2) { 4e-3 } else { -4e-3 };
    mcap.row(
        "log times that jitter by ±4 ms",
        &plain(&messages(|_, t| t, jitter)),
        &[],
        used(11).repaired(COUNT - 11),
        Ends::Pass,
    );
    mcap.row(
        "log times that jitter by ±4 ms",
        &plain(&messages(|_, t| t, jitter)),
        &STAMPS,
        used(COUNT),
        Ends::Pass,
    );
    let burst = |k: u64, t: f64| t + 0.02 * (7 - k % 8) as f64;
    let blind = Ends::Inconclusive("stamps scatter so much that a missing message can't be seen");
    mcap.row(
        "logged in bursts of eight",
        &plain(&messages(|_, t| t, burst)),
        &[],
        used(11).repaired(COUNT - 11),
        blind,
    );
    mcap.row(
        "logged in bursts of eight",
        &plain(&messages(|_, t| t, burst)),
        &STAMPS,
        used(COUNT),
        Ends::Pass,
    );
    // Clocks.
    for ppm in [100.0, -100.0, 500.0, -500.0] {
        let name = format!(
            "a clock {} by {} ppm against the log",
            if ppm > 0.0 { "fast" } else { "slow" },
            f64::abs(ppm)
        );
        let stamp = |_: u64, t: f64| 10.0 + (t - 10.0) * (1.0 + ppm * 1e-6);
        mcap.row(&name, &plain(&messages(stamp, |_, t| t)), &STAMPS, used(COUNT), Ends::Pass);
    }
    // Increments, which the clock's error makes wrong rates of.
    let increments: Vec<&str> = STAMPS.iter().chain(&INCREMENTS).copied().collect();
    let with_clock = |ppm: f64| {
        let rows = readings(RATE_HZ, COUNT).into_iter().map(|row| {
            let values = row.values.map(|rate| rate / RATE_HZ);
            let stamp_s = 10.0 + (row.time_s - 10.0) * (1.0 + ppm * 1e-6);
            json(&Rest { values, ..row }, ns(row.time_s), ns(stamp_s))
        });
        plain(&rows.collect::<Vec<_>>())
    };
    mcap.row("increments", &with_clock(0.0), &increments, used(COUNT), Ends::Pass);
    for ppm in [100.0, -100.0, 500.0, -500.0] {
        let name = format!(
            "increments, a clock {} by {} ppm against the log",
            if ppm > 0.0 { "fast" } else { "slow" },
            f64::abs(ppm)
        );
        mcap.row(
            &name,
            &with_clock(ppm),
            &increments,
            used(COUNT),
            Ends::Inconclusive("its clock is "),
        );
    }
    for set in [&[][..], &STAMPS] {
        for (lost, name) in [(1, "one message lost"), (50, "1 s lost"), (250, "5 s lost")] {
            let mut some = regular();
            some.drain(1000..1000 + lost);
            let ends = if lost < 250 {
                Ends::Pass
            } else {
                Ends::Inconclusive("the calibration was refused for the samples that it lacks")
            };
            mcap.row(
                name,
                &plain(&some),
                set,
                used(COUNT - lost as u64).missing(lost as u64),
                ends,
            );
        }
        let mut some = regular();
        some.drain(1000..1400);
        let ends = Ends::Inconclusive("unit.mcap has gaps: 400 messages missing");
        mcap.row("8 s lost", &plain(&some), set, used(COUNT - 400).missing(400), ends);
        let back = |k: u64, t: f64| if k >= 1000 { t - 5.0 } else { t };
        mcap.refused(
            "the clock goes back by 5 s",
            &plain(&messages(back, back)),
            set,
            "message 1001 on /imu: the clock goes back from ",
        );
        let slow = |k: u64, t: f64| t + 0.02 * k as f64;
        mcap.refused(
            "25 Hz, and the scenario says 50 Hz",
            &plain(&messages(slow, slow)),
            set,
            "messages come at 25 Hz by their stamps, expected 50 Hz",
        );
        let zero = |_: u64, _: f64| 0.0;
        mcap.refused("all times 0", &plain(&messages(zero, zero)), set, "");
    }
    let mut twice = regular();
    for k in [2000, 1000] {
        let again = Message { data: twice[k].data.clone(), ..twice[k] };
        twice.insert(k, again);
    }
    mcap.row("two messages twice", &plain(&twice), &STAMPS, used(COUNT).left_out(2), Ends::Pass);
    // Damage. A file that is cut off has its whole chunks.
    let all = regular();
    let torn = half_then_torn(&all);
    mcap.row(
        "cut off in the middle of a chunk",
        &torn,
        &[],
        used(COUNT / 2),
        Ends::Inconclusive("unit.mcap ends in the middle of a recording"),
    );
    mcap.refused(
        "cut off within the first chunk",
        &whole[..whole.len() / 2],
        &[],
        "the file is truncated",
    );
    let mut flipped = file(
        &regular(),
        "json",
        mcap::WriteOptions::new().compression(None).chunk_size(Some(65_536)),
    );
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    mcap.refused("a bit of a chunk flipped", &flipped, &[], "");
    let with = |k: usize, data: &[u8]| {
        let mut some = regular();
        some[k].data = data.to_vec();
        plain(&some)
    };
    mcap.refused(
        "a field missing in one message",
        &with(1000, b"{\"w\":[0,0],\"f\":[0,0,-9.8]}"),
        &[],
        "message 1001 on /imu: field w[2] is missing",
    );
    mcap.refused(
        "null in a message",
        &with(1000, b"{\"w\":[0,0,null],\"f\":[0,0,-9.8]}"),
        &[],
        "message 1001 on /imu: ",
    );
    mcap.refused(
        "a text in a message",
        &with(1000, b"{\"w\":[0,0,\"0\"],\"f\":[0,0,-9.8]}"),
        &[],
        "message 1001 on /imu: ",
    );
    mcap.refused(
        "a message that isn't JSON",
        &with(1000, b"{\"w\":[0"),
        &[],
        "message 1001 on /imu: ",
    );
    mcap.refused(
        "no such topic",
        &whole,
        &["source.mcap.topic=/imu/data"],
        "no topic \"/imu/data\"; the file has /imu",
    );
    mcap.refused(
        "the topic without messages",
        &plain(&[Message { log_ns: 1, topic: "/fix", data: b"{}".to_vec() }]),
        &[],
        "no topic \"/imu\"; the file has /fix",
    );
    mcap.refused(
        "messages of another encoding",
        &file(&regular(), "protobuf", mcap::WriteOptions::new().compression(None)),
        &[],
        "topic /imu is in protobuf, expected json, cdr or ros1",
    );
    two_topics(&mut mcap);
    mcap.refused("a bag of ROS 1", b"#ROSBAG V2.0\n0123456789", &[], "found a bag of ROS 1");
    mcap.refused(
        "a bag in SQLite",
        b"SQLite format 3\0 0123",
        &[],
        "found a bag of ROS 2 in SQLite",
    );
    mcap.refused("an empty file", &[], &[], "");
    mcap.refused("text", b"t,gx,gy,gz\n", &[], "");
    mcap.part.finish(30);
}
