//! Random damage of recordings and logs: each unit that the file has is in the account once, and the samples are those of the
//! units that were used.

use octant_account::Account;
use octant_instruments::{AnyEncoder, Axes, MeasuredTriad, Protocol, Reading, Stamp, StampClock};
use octant_sample::GimbalCommand;
use octant_scenario::recorded::{
    AxisColumn, Delimiter, MappedField, MappedStamp, McapMapping, RecordedColumn, RecordedQuantity,
    TextFiles, TextMapping, TimeColumn, TimeUnit,
};
use octant_scenario::{FileName, InstrumentLog, Speaks};
use octant_source::{Epoch, LogSource, Replay, Source, TextSource};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Number of files of each kind.
const FILES: u64 = 120;
const RATE_HZ: f64 = 100.0;
const PERIOD_NS: u64 = 10_000_000;

/// Fixed sequence of whole numbers.
struct Random(u64);

impl Random {
    /// Number below a limit.
    fn below(&mut self, limit: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }

    /// True once in so many times.
    fn once_in(&mut self, times: u64) -> bool {
        self.below(times) == 0
    }
}

/// A unit of a file: its stamp, ns, and its counter.
#[derive(Clone, Copy, Debug)]
struct Unit {
    stamp_ns: u64,
    number: u64,
}

/// Units with damage of all kinds: lost ones, single and in gaps, ones that are there twice or late, and stamps that jitter.
fn damaged(random: &mut Random) -> Vec<Unit> {
    let count = 20 + random.below(600);
    let jitter_ns = [0, 0, 100_000, 4_000_000][random.below(4) as usize];
    let [lost, twice, late] = [0; 3].map(|_: u64| 20 + random.below(400));
    let mut units = Vec::new();
    let mut gap = 0;
    for k in 0..count {
        if random.once_in(300) {
            gap = 1 + random.below(100);
        }
        if gap > 0 || random.once_in(lost) {
            gap = u64::saturating_sub(gap, 1);
            continue;
        }
        let stamp_ns = 1_000_000_000 + k * PERIOD_NS + random.below(1 + jitter_ns);
        let unit = Unit { stamp_ns, number: k + 1 };
        units.extend(std::iter::repeat_n(unit, if random.once_in(twice) { 2 } else { 1 }));
    }
    for k in 1..units.len() {
        if random.once_in(late) {
            units.swap(k - 1, k);
        }
    }
    // A clock that is set, or a unit that restarts.
    if random.once_in(10) && !units.is_empty() {
        let from = random.below(units.len() as u64) as usize;
        units[from..].iter_mut().for_each(|unit| unit.stamp_ns -= 900_000_000);
    }
    units
}

/// Reads a source to its end or error; returns the number of samples, whether it came to the end, and the account.
fn read(source: &mut dyn Source) -> (u64, bool, Account) {
    let mut epoch = Epoch::default();
    let mut samples = 0;
    loop {
        match source.next(&GimbalCommand::default(), &mut epoch) {
            Ok(true) => samples += 1,
            ended => return (samples, ended.is_ok(), source.accounts().remove(0)),
        }
    }
}

/// Checks accounts of files with random damage. `write` writes the units and returns their source, with the number of units
/// that it wrote.
fn sums_hold(name: &str, write: impl Fn(&Path, &[Unit], &mut Random) -> (Box<dyn Source>, u64)) {
    let folder = tempfile::tempdir().unwrap();
    let mut whole = 0;
    for seed in 0..FILES {
        let mut random = Random(seed);
        let units = damaged(&mut random);
        let path = folder.path().join(format!("{seed}"));
        let (mut source, written) = write(&path, &units, &mut random);
        let (samples, to_the_end, account) = read(&mut *source);
        let lines = account.lines().join("\n");
        // Stored accounts whose sums don't hold can't be read.
        assert_eq!(account.read(), account.used_count() + account.left_out_count(), "{lines}");
        assert_eq!(samples, account.used_count(), "{name}, seed {seed}: {lines}");
        if to_the_end {
            assert_eq!(account.read(), written, "{name}, seed {seed}: {lines}");
            whole += 1;
        } else {
            assert!(account.read() <= written, "{name}, seed {seed}: {lines}");
        }
    }
    assert!(whole > FILES / 3, "{name}: {whole} of {FILES} files are read to their end");
}

fn axis(column: usize) -> AxisColumn {
    AxisColumn { column: RecordedColumn::Number(column), offset: 0.0, scale: 1.0 }
}

#[test]
fn rows_of_damaged_text() {
    for timed in [true, false] {
        sums_hold(if timed { "text" } else { "text without times" }, |path, units, random| {
            let mut text = String::new();
            for Unit { stamp_ns, .. } in units {
                if random.once_in(30) {
                    text += ["\n", "# a comment\n", "\r\n"][random.below(3) as usize];
                }
                writeln!(text, "{stamp_ns},1e-3,0,0,0,0,9.8").unwrap();
            }
            std::fs::write(path, text).unwrap();
            let column = RecordedColumn::Number(1);
            let mapping = TextMapping {
                files: TextFiles::One(path.to_owned()),
                time: timed.then_some(TimeColumn { column, unit: TimeUnit::Nanosecond }),
                gyro: [2, 3, 4].map(axis),
                accelerometer: [5, 6, 7].map(axis),
                quantity: RecordedQuantity::Rates,
                nominal_rate_hz: RATE_HZ,
                split: 1,
                delimiter: Delimiter::Character(b','),
                comment: "#".into(),
                skip_lines: 0,
                header: false,
                gimbal: None,
                temperature: None,
            };
            (Box::new(TextSource::open(&mapping).unwrap()), units.len() as u64)
        });
    }
}

#[test]
fn messages_of_damaged_mcap() {
    let axes = ["x", "y", "z"];
    let field = |path: String| MappedField { path, offset: 0.0, scale: 1.0 };
    for by_log in [true, false] {
        sums_hold(
            if by_log { "MCAP by log times" } else { "MCAP by stamps" },
            |path, units, random| {
                let mut writer = mcap::WriteOptions::new()
                    .compression(None)
                    .create(std::fs::File::create(path).unwrap())
                    .unwrap();
                let [imu, other] = ["/imu", "/fix"]
                    .map(|topic| writer.add_channel(0, topic, "json", &BTreeMap::new()).unwrap());
                for Unit { stamp_ns, number } in units {
                    let header = |channel_id| mcap::records::MessageHeader {
                        channel_id,
                        sequence: *number as u32,
                        log_time: *stamp_ns,
                        publish_time: 0,
                    };
                    if random.once_in(5) {
                        writer.write_to_known_channel(&header(other), b"{}").unwrap();
                    }
                    let message = format!(r#"{{"t":{stamp_ns},"x":1e-3,"y":0,"z":9.8}}"#);
                    writer.write_to_known_channel(&header(imu), message.as_bytes()).unwrap();
                }
                writer.finish().unwrap();
                let stamp = match by_log {
                    true => MappedStamp::LogTime,
                    false => MappedStamp::Field {
                        path: "t".into(),
                        unit: TimeUnit::Nanosecond,
                        nanoseconds: None,
                    },
                };
                let mapping = McapMapping {
                    gyro: axes.map(|axis| field(axis.to_owned())),
                    accelerometer: axes.map(|axis| field(axis.to_owned())),
                    stamp,
                    ..McapMapping::ros_imu("/imu", RATE_HZ)
                };
                (Box::new(Replay::open(path, Some(&mapping)).unwrap()), units.len() as u64)
            },
        );
    }
}

#[test]
fn readings_of_damaged_logs() {
    for protocol in Protocol::ALL {
        sums_hold(protocol.facts().name, |path, units, random| {
            let mut encoder = AnyEncoder::new(protocol);
            let (mut bytes, mut intact) = (Vec::new(), 0);
            for Unit { stamp_ns, number } in units {
                if random.once_in(40) {
                    bytes.extend((0..random.below(60)).map(|_| 0x55_u8));
                }
                let reading = Reading {
                    rotation: Some(MeasuredTriad::increment([1e-5, 0.0, 0.0])),
                    velocity: Some(MeasuredTriad::increment([0.0, 0.0, 0.098])),
                    interval_s: Some(PERIOD_NS as f64 * 1e-9),
                    stamp: Some(Stamp { ns: *stamp_ns, clock: StampClock::Startup }),
                    sequence: Some(*number),
                    ..Reading::NOTHING
                };
                let begin = bytes.len();
                bytes.extend(encoder.encode(&reading).unwrap());
                if random.once_in(100) {
                    let middle = usize::midpoint(begin, bytes.len());
                    bytes[middle] ^= 1 << random.below(8);
                } else {
                    intact += 1;
                }
            }
            // A torn frame at the end.
            let reading = encoder.encode(&Reading {
                rotation: Some(MeasuredTriad::increment([0.0; 3])),
                velocity: Some(MeasuredTriad::increment([0.0; 3])),
                interval_s: Some(0.01),
                stamp: Some(Stamp { ns: 1_000_000_000_000, clock: StampClock::Startup }),
                sequence: Some(100_000),
                ..Reading::NOTHING
            });
            let torn = reading.unwrap();
            bytes.extend(&torn[..random.below(torn.len() as u64 / 2) as usize]);
            std::fs::write(path, bytes).unwrap();
            let log = InstrumentLog {
                file: FileName("unit.bin".to_owned()),
                speaks: Speaks::Bytes(protocol),
                count: None,
                axes: Axes::SAME,
            };
            (Box::new(LogSource::open(path, &log, Path::new(""), RATE_HZ).unwrap()), intact)
        });
    }
}
