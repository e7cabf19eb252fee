//! Bytes that units sent, whole and damaged, in every protocol; those of a described unit are encoded here, from its document.

use super::rest::{COUNT, RATE_HZ, Rest, readings, scenario, uniform};
use super::table::{Case, Counts, Ends, Parameters, Part};
use octant_instruments::{AnyEncoder, MeasuredTriad, Protocol, Reading, Stamp, StampClock};
use octant_sample::Status;
use std::collections::BTreeMap;

const FILE: &str = "unit.bin";

/// A calibration of which the core would have to fill in too much.
const LACKING: Ends =
    Ends::Inconclusive("the calibration was refused for the samples that it lacks");

/// Changes of a stream.
struct Unit<'a> {
    /// Stamp, s, of number and true time.
    stamp_s: &'a dyn Fn(u64, f64) -> f64,
    /// Counter of the number.
    counter: &'a dyn Fn(u64) -> u64,
    /// Status of the number.
    status: &'a dyn Fn(u64) -> Status,
}

const REGULAR: Unit<'_> =
    Unit { stamp_s: &|_, t| t, counter: &|k| k + 1, status: &|_| Status::empty() };

/// Frames of a unit, one a reading.
fn frames(protocol: Protocol, unit: &Unit<'_>) -> Vec<Vec<u8>> {
    let mut encoder = AnyEncoder::new(protocol);
    let rows = readings(RATE_HZ, COUNT).into_iter().zip(0..);
    rows.map(|(row, k)| {
        let stamp_ns = ((unit.stamp_s)(k, row.time_s) * 1e9).round() as u64;
        encoder
            .encode(&reading(&row, stamp_ns, (unit.counter)(k), (unit.status)(k)))
            .unwrap()
            .to_vec()
    })
    .collect()
}

pub fn reading(row: &Rest, stamp_ns: u64, counter: u64, status: Status) -> Reading {
    let [gx, gy, gz, ax, ay, az] = row.values.map(|rate| rate / RATE_HZ);
    Reading {
        rotation: Some(MeasuredTriad::increment([gx, gy, gz])),
        velocity: Some(MeasuredTriad::increment([ax, ay, az])),
        interval_s: Some(1.0 / RATE_HZ),
        stamp: Some(Stamp { ns: stamp_ns, clock: StampClock::Startup }),
        sequence: Some(counter),
        status,
        ..Reading::NOTHING
    }
}

struct Logs {
    part: Part,
    input: String,
    scenario: String,
    /// Parameters of the undamaged streams.
    clean: BTreeMap<&'static str, Parameters>,
}

impl Logs {
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
        self.part.run(&Case { input: &self.input, holds, files: &files, set, counts, ends })
    }

    fn refused(&mut self, holds: &str, content: &[u8], words: &'static str) {
        self.row(holds, content, &[], Counts::default(), Ends::Refused(words));
    }

    /// Begins with the rows of another protocol.
    fn begin(&mut self, protocol: Protocol) {
        let name = protocol.facts().name;
        self.input = name.to_owned();
        self.scenario =
            scenario(&format!("uri = \"log:unit.bin\"\n[source.log]\nprotocol = \"{name}\""));
        self.part.clean = self.clean.get(name).cloned();
        if self.part.clean.is_none() {
            let whole = frames(protocol, &REGULAR).concat();
            let clean = self.row("regular", &whole, &[], Counts::used(COUNT), Ends::Pass);
            self.part.clean = Some(clean.clone());
            self.clean.insert(name, clean);
        }
    }
}

#[test]
fn logs_of_units() {
    let mut logs = Logs {
        part: Part::new("logs"),
        input: String::new(),
        scenario: String::new(),
        clean: BTreeMap::new(),
    };
    let used = Counts::used;
    for protocol in Protocol::ALL {
        logs.begin(protocol);
        let whole = frames(protocol, &REGULAR);
        for (lost, name) in [(1, "one frame lost"), (50, "1 s lost"), (250, "5 s lost")] {
            let mut some = whole.clone();
            some.drain(1000..1000 + lost);
            logs.row(
                name,
                &some.concat(),
                &[],
                used(COUNT - lost as u64).missing(lost as u64),
                if lost < 250 { Ends::Pass } else { LACKING },
            );
        }
        // Every other byte between frames is no part of one.
        let mut random = uniform(7);
        let mut noisy = Vec::new();
        for (frame, k) in whole.iter().zip(0_u64..) {
            if k % 50 == 0 {
                noisy.extend((0..40).map(|_| (random() * 256.0) as u8));
            }
            noisy.extend(frame);
        }
        logs.row("40 random bytes before one frame in 50", &noisy, &[], used(COUNT), Ends::Pass);
        let mut flipped = whole.clone();
        for k in (100..COUNT as usize).step_by(300) {
            flipped[k][10] ^= 4;
        }
        logs.row(
            "a bit flipped in ten frames",
            &flipped.concat(),
            &[],
            used(COUNT - 10).missing(10),
            Ends::Pass,
        );
        let mut twice = whole.clone();
        twice.insert(1000, whole[1000].clone());
        logs.row("a frame twice", &twice.concat(), &[], used(COUNT).left_out(1), Ends::Pass);
        let back = |k: u64, t: f64| if k < 1500 { t } else { t - 29.0 };
        let again = |k: u64| if k < 1500 { k + 1 } else { k - 1499 };
        let restarted =
            frames(protocol, &Unit { stamp_s: &back, counter: &again, ..REGULAR }).concat();
        logs.refused(
            "the unit restarts in the middle",
            &restarted,
            "the unit was restarted, or its clock set",
        );
        let all = whole.concat();
        logs.row(
            "cut off within the last frame",
            &all[..all.len() - 3],
            &[],
            used(COUNT - 1),
            Ends::Inconclusive("of an incomplete frame"),
        );
        let slow = |k: u64, t: f64| t + 0.02 * k as f64;
        let other = frames(protocol, &Unit { stamp_s: &slow, ..REGULAR }).concat();
        // Counters without a gap and stamps of another rate, or stamps alone.
        let words = match protocol {
            Protocol::Xsens | Protocol::Octant => {
                "readings are 40.0000 ms apart, 25.0 Hz, expected 20.0000 ms by imu.rate"
            }
            _ => "readings come at 25 Hz by their stamps, expected 50 Hz",
        };
        logs.refused("25 Hz, and the scenario says 50 Hz", &other, words);
    }
    // Means, with stamps of a clock that is wrong.
    logs.begin(Protocol::Sbg);
    for ppm in [100.0, -100.0, 500.0, -500.0] {
        let stamp = |_: u64, t: f64| 10.0 + (t - 10.0) * (1.0 + ppm * 1e-6);
        let holds = format!(
            "stamps of a clock that is {} by {} ppm",
            if ppm > 0.0 { "fast" } else { "slow" },
            f64::abs(ppm)
        );
        logs.row(
            &holds,
            &frames(Protocol::Sbg, &Unit { stamp_s: &stamp, ..REGULAR }).concat(),
            &[],
            used(COUNT),
            Ends::Pass,
        );
    }
    // Bits of the status: 100 readings whose gyros are out of range.
    for protocol in [Protocol::Sbg, Protocol::Xsens] {
        logs.begin(protocol);
        let status = |k: u64| {
            if (1000..1100).contains(&k) { Status::GYRO_SATURATED } else { Status::empty() }
        };
        let flagged = frames(protocol, &Unit { status: &status, ..REGULAR }).concat();
        logs.row(
            "100 readings with a gyro out of range",
            &flagged,
            &[],
            used(COUNT - 100).left_out(100),
            LACKING,
        );
    }
    for protocol in [Protocol::Sbg, Protocol::NovAtel] {
        logs.begin(protocol);
        let status = |k: u64| {
            if (1000..1100).contains(&k) { Status::INERTIAL_INVALID } else { Status::empty() }
        };
        let flagged = frames(protocol, &Unit { status: &status, ..REGULAR }).concat();
        logs.row(
            "100 readings that the unit calls invalid",
            &flagged,
            &[],
            used(COUNT - 100).left_out(100),
            LACKING,
        );
    }
    // Counters that roll over within the file.
    logs.begin(Protocol::Sbg);
    let wraps = |_: u64, t: f64| 4_294.967_296 - 40.0 + t;
    logs.row(
        "its clock of 32 bits begins again",
        &frames(Protocol::Sbg, &Unit { stamp_s: &wraps, ..REGULAR }).concat(),
        &[],
        used(COUNT),
        Ends::Pass,
    );
    let jitter = |k: u64, t: f64| t + if k.is_multiple_of(2) { 2e-3 } else { -2e-3 };
    logs.row(
        "stamps that jitter by ±2 ms",
        &frames(Protocol::Sbg, &Unit { stamp_s: &jitter, ..REGULAR }).concat(),
        &[],
        used(11).repaired(COUNT - 11),
        Ends::Pass,
    );
    logs.begin(Protocol::Xsens);
    let counter = |k: u64| 65_536 - 1500 + k;
    logs.row(
        "its counter of 16 bits begins again",
        &frames(Protocol::Xsens, &Unit { counter: &counter, ..REGULAR }).concat(),
        &[],
        used(COUNT),
        Ends::Pass,
    );
    logs.begin(Protocol::NovAtel);
    let week = |_: u64, t: f64| 2_000.0 * 604_800.0 - 40.0 + t;
    logs.row(
        "the GPS week ends",
        &frames(Protocol::NovAtel, &Unit { stamp_s: &week, ..REGULAR }).concat(),
        &[],
        used(COUNT),
        Ends::Pass,
    );
    // Bytes of something else.
    let sbg = frames(Protocol::Sbg, &REGULAR).concat();
    logs.refused("frames of SBG", &sbg, "it has no reading: ");
    logs.refused("an empty file", &[], "it has no reading: ");
    logs.refused("zeros", &[0; 4000], "it has no reading: ");
    logs.part.finish(50);
}

/// CRC-32 of KVH's document: polynomial 0x04C11DB7, register of ones, no reflection and no final XOR.
fn crc32(bytes: &[u8]) -> u32 {
    bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte) << 24, |crc, _| {
            if crc >> 31 == 1 { crc << 1 ^ 0x04C1_1DB7 } else { crc << 1 }
        })
    })
}

/// Frames of a KVH 1775 (ICD 56-0298 rev. B), binary format A with rates: no stamps, and a counter of 7 bits.
fn kvh() -> Vec<Vec<u8>> {
    let frame = |(row, k): (Rest, u64)| {
        let mut frame = vec![0xFE, 0x81, 0xFF, 0x55];
        let [gx, gy, gz, ax, ay, az] = row.values;
        for value in [gx, gy, gz, ax / 9.806_65, ay / 9.806_65, az / 9.806_65] {
            frame.extend((value as f32).to_be_bytes());
        }
        frame.extend([0x77, (k % 128) as u8, 0, 25]);
        let crc = crc32(&frame);
        frame.extend(crc.to_be_bytes());
        frame
    };
    readings(RATE_HZ, COUNT).into_iter().zip(0..).map(frame).collect()
}

#[test]
fn logs_of_a_described_unit() {
    let source = "uri = \"log:unit.bin\"\n[source.log]\nprotocol = \"described\"\ndescription = \"kvh-1775-rate\"";
    let mut logs = Logs {
        part: Part::new("described units"),
        input: "kvh-1775-rate".to_owned(),
        scenario: scenario(source),
        clean: BTreeMap::new(),
    };
    let used = Counts::used;
    let whole = kvh();
    let clean = logs.row("regular", &whole.concat(), &[], used(COUNT), Ends::Pass);
    logs.part.clean = Some(clean);
    for (lost, name) in [(1, "one frame lost"), (50, "1 s lost")] {
        let mut some = whole.clone();
        some.drain(1000..1000 + lost);
        logs.row(
            name,
            &some.concat(),
            &[],
            used(COUNT - lost as u64).missing(lost as u64),
            Ends::Pass,
        );
    }
    let mut flipped = whole.clone();
    for k in (100..COUNT as usize).step_by(300) {
        flipped[k][10] ^= 4;
    }
    logs.row(
        "a bit flipped in ten frames",
        &flipped.concat(),
        &[],
        used(COUNT - 10).missing(10),
        Ends::Pass,
    );
    let all = whole.concat();
    logs.row(
        "cut off within the last frame",
        &all[..all.len() - 3],
        &[],
        used(COUNT - 1),
        Ends::Inconclusive("of an incomplete frame"),
    );
    logs.row("the first 17 bytes lost", &all[17..], &[], used(COUNT - 1), Ends::Pass);
    logs.refused("an empty file", &[], "it has no reading: ");
    logs.part.finish(7);
}
