//! Readings from any CAN database through a mapping.

#[path = "../../../../fuzz/dbc.rs"]
mod fuzz;

use octant_instruments::dbc::{CanFrame, Database, Gatherer, SignalMapping};
use octant_instruments::{Reading, ReadingKind};
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};
use octant_wire::can::{CanVersion, segments};
use octant_wire::message::{EndRole, SampleMessage, StepNumber};
use octant_wire::{Message, can};
use proptest::prelude::*;

const OCTANT_DBC: &str = include_str!("../../../../fixtures/can/octant.dbc");

const OWN: &str = r#"
rotation = { x = "InstrumentSample_3.delta_theta_x", y = "InstrumentSample_3.delta_theta_y", z = "InstrumentSample_4.delta_theta_z" }
velocity = { x = "InstrumentSample_4.delta_velocity_x", y = "InstrumentSample_5.delta_velocity_y", z = "InstrumentSample_5.delta_velocity_z" }
gimbal = { azimuth = "InstrumentSample_6.azimuth", roll = "InstrumentSample_6.roll" }
sequence = { signal = "InstrumentSample_1.sequence" }
stamp = { signal = "InstrumentSample_2.device_time_ns" }
"#;

/// Database of a unit with two messages: one little-endian, one big-endian with floats.
const UNIT_DBC: &str = r#"VERSION ""

NS_ :

BS_:

BU_: Unit Host

BO_ 291 Gyro: 8 Unit
 SG_ counter : 0|4@1+ (1,0) [0|15] "" Host
 SG_ valid : 4|1@1+ (1,0) [0|1] "" Host
 SG_ rate_x : 8|18@1- (0.0025,0) [0|0] "deg/s" Host
 SG_ rate_y : 26|18@1- (0.0025,0) [0|0] "deg/s" Host
 SG_ rate_z : 44|18@1- (0.0025,0) [0|0] "deg/s" Host

BO_ 2147484708 Accel: 12 Unit
 SG_ counter : 3|4@0+ (1,0) [0|15] "" Host
 SG_ time : 15|16@0+ (100,0) [0|0] "us" Host
 SG_ a_x : 31|12@0- (0.01,0) [0|0] "m/s^2" Host
 SG_ a_y : 35|12@0- (0.01,0) [0|0] "m/s^2" Host
 SG_ a_z : 55|12@0- (0.01,0) [0|0] "m/s^2" Host
 SG_ temperature : 64|8@1+ (0.5,-40) [0|0] "degC" Host

BO_ 293 Float: 12 Unit
 SG_ angle : 0|32@1- (1,0) [0|0] "" Host
 SG_ wide : 88|16@1+ (1,0) [0|0] "" Host
 SG_ choice M : 32|8@1+ (1,0) [0|0] "" Host
 SG_ chosen m1 : 40|8@1+ (1,0) [0|0] "" Host

SIG_VALTYPE_ 293 angle : 1;
"#;

const UNIT: &str = r#"
rotation = { x = "Gyro.rate_x", y = "Gyro.rate_y", z = "-Gyro.rate_z" }
velocity = { x = "Accel.a_x", y = "Accel.a_y", z = "-Accel.a_z", unit = "m/s2" }
sequence = { signal = "Gyro.counter" }
stamp = { signal = "Accel.time" }
temperature = { signal = "Accel.temperature" }
valid = { signal = "Gyro.valid", equals = 1 }
counters = ["Gyro.counter", "Accel.counter"]
order = ["Gyro", "Accel"]
"#;

fn gatherer(dbc: &str, mapping: &str) -> Gatherer {
    let database = Database::parse("unit.dbc", dbc).unwrap();
    Gatherer::new(&database, &SignalMapping::parse("unit.toml", mapping).unwrap()).unwrap()
}

fn sample(number: u64) -> Sample {
    let k = number as i32;
    Sample {
        sequence: number,
        device_time: DeviceTime { ns: number * 5_000_000 },
        delta_theta: [17 * k, -k, i32::MIN + k],
        delta_velocity: [i32::MAX - k, 3, -52_600_000],
        gimbal: GimbalAngles { azimuth: 210_828_714, roll: -k },
        status: Status::empty(),
    }
}

fn own_frames(number: u64) -> Vec<can::BusFrame> {
    let step = StepNumber::new((number & 0x7FFF) as u16);
    let message = Message::Sample(SampleMessage { step, aided: false, sample: sample(number) });
    segments(&message, EndRole::Instrument, CanVersion::Classic).unwrap().collect()
}

fn frame(frame: &can::BusFrame) -> CanFrame<'_> {
    CanFrame { id: frame.id().into(), extended: false, data: frame.data() }
}

/// Octant's samples, read through its own database, give the same readings as their decoder, bit for
/// bit.
#[test]
fn our_own_database_reads_our_own_samples() {
    let mut gatherer = gatherer(OCTANT_DBC, OWN);
    assert_eq!(gatherer.identifiers().count(), 6);
    for number in [1, 2, 5] {
        let frames = own_frames(number);
        let found: Vec<Reading> =
            frames.iter().filter_map(|one| gatherer.receive(&frame(one))).collect();
        let expected = Reading { status_word: None, ..Reading::of_sample(&sample(number)) };
        assert_eq!(found, [expected]);
    }
    let counters = gatherer.counters();
    assert_eq!((counters.readings, counters.missing, counters.other), (3, 2, 3));
}

/// Writes bits in sequence, as the definition of the format counts them.
fn put(data: &mut [u8], start: usize, size: usize, little_endian: bool, value: u64) {
    let mut bit = start;
    for i in 0..size {
        let set = if little_endian { value >> i & 1 } else { value >> (size - 1 - i) & 1 } as u8;
        data[bit / 8] |= set << (bit % 8);
        bit = if little_endian {
            bit + 1
        } else if bit.is_multiple_of(8) {
            // Continues at the top of the next byte.
            bit + 15
        } else {
            bit - 1
        };
    }
}

fn gyro(counter: u64, valid: bool, rates: [i64; 3]) -> [u8; 8] {
    let mut data = [0; 8];
    put(&mut data, 0, 4, true, counter & 15);
    put(&mut data, 4, 1, true, valid.into());
    for (start, rate) in [8, 26, 44].into_iter().zip(rates) {
        put(&mut data, start, 18, true, rate as u64 & 0x3FFFF);
    }
    data
}

fn accel(counter: u64, time: u64, values: [i64; 3]) -> [u8; 12] {
    let mut data = [0; 12];
    put(&mut data, 3, 4, false, counter & 15);
    put(&mut data, 15, 16, false, time & 0xFFFF);
    for (start, value) in [31, 35, 55].into_iter().zip(values) {
        put(&mut data, start, 12, false, value as u64 & 0xFFF);
    }
    put(&mut data, 64, 8, true, 131);
    data
}

fn send(gatherer: &mut Gatherer, gyro: Option<&[u8]>, accel: Option<&[u8]>) -> Vec<Reading> {
    let gyro = gyro.map(|data| CanFrame { id: 291, extended: false, data });
    let accel = accel.map(|data| CanFrame { id: 1060, extended: true, data });
    gyro.iter().chain(&accel).filter_map(|frame| gatherer.receive(frame)).collect()
}

proptest! {
    #[test]
    fn signals_of_both_byte_orders(
        rates in proptest::array::uniform3(-131_072i64..131_072),
        values in proptest::array::uniform3(-2048i64..2048),
    ) {
        let mut gatherer = gatherer(UNIT_DBC, UNIT);
        let (gyro, accel) = (gyro(3, true, rates), accel(3, 7, values));
        let found = send(&mut gatherer, Some(&gyro), Some(&accel));
        prop_assert_eq!(found.len(), 1);
        let (rotation, velocity) = (found[0].rotation.unwrap(), found[0].velocity.unwrap());
        prop_assert_eq!((rotation.kind, velocity.kind), (ReadingKind::Mean, ReadingKind::Mean));
        for (axis, sign) in [(0, 1.0), (1, 1.0), (2, -1.0)] {
            let rate = sign * (rates[axis] as f64 * 0.0025).to_radians();
            prop_assert!((rotation.value[axis] - rate).abs() < 1e-14);
            prop_assert!((velocity.value[axis] - sign * values[axis] as f64 * 0.01).abs() < 1e-12);
        }
        prop_assert_eq!(found[0].temperature_c, Some(25.5));
        prop_assert_eq!(found[0].stamp.unwrap().ns, 700_000);
        prop_assert_eq!(found[0].status, Status::empty());
    }

    /// Arbitrary frames cause no panic, and all are counted.
    #[test]
    fn any_frames(bus in proptest::collection::vec(
        (prop_oneof![Just(291u32), Just(1060), any::<u32>()], any::<bool>(), proptest::collection::vec(any::<u8>(), 0..65)),
        0..60,
    )) {
        let mut gatherer = gatherer(UNIT_DBC, UNIT);
        for (id, extended, data) in &bus {
            gatherer.receive(&CanFrame { id: *id, extended: *extended, data });
        }
        prop_assert_eq!(gatherer.counters().frames, bus.len() as u64);
    }

    /// A database with some changed bytes is read or refused, and so is a mapping that uses it.
    #[test]
    fn a_damaged_database(strikes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut bytes = UNIT_DBC.as_bytes().to_vec();
        for (at, byte) in strikes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let text = String::from_utf8_lossy(&bytes);
        if let Ok(database) = Database::parse("unit.dbc", &text)
            && let Ok(mut gatherer) = Gatherer::new(&database, &SignalMapping::parse("unit.toml", UNIT).unwrap())
        {
            send(&mut gatherer, Some(&[0xFF; 8]), Some(&[0x55; 12]));
        }
    }
}

#[test]
fn what_is_lost_makes_no_mixed_reading() {
    let mut gatherer = gatherer(UNIT_DBC, UNIT);
    let gyro_of = |number: u64| gyro(number, true, [number as i64, 0, 0]);
    let accel_of = |number: u64| accel(number, number * 50, [number as i64, 0, 0]);
    let mut expected = 0;
    for number in 1..=40u64 {
        let (gyro, accel) = (gyro_of(number), accel_of(number));
        let found = match number {
            // Lost are the second message, the first one, and the second together with the next first.
            5 => send(&mut gatherer, Some(&gyro), None),
            9 => send(&mut gatherer, None, Some(&accel)),
            20 => send(&mut gatherer, Some(&gyro), None),
            21 => send(&mut gatherer, None, Some(&accel)),
            30 => send(&mut gatherer, Some(&gyro[..7]), Some(&accel)),
            _ => send(&mut gatherer, Some(&gyro), Some(&accel)),
        };
        expected += found.len();
        if let [reading] = found[..] {
            // Both are continued, across 15 of the counter and 65535 of the clock.
            assert_eq!(reading.sequence, Some(number));
            assert_eq!(reading.stamp.unwrap().ns, number * 5_000_000);
            let ratio = reading.velocity.unwrap().value[0] / 0.01;
            assert!((ratio - number as f64).abs() < 1e-9, "of another sample");
        }
    }
    let counters = *gatherer.counters();
    assert_eq!((expected, counters.readings), (35, 35));
    assert_eq!(
        (counters.incomplete, counters.orphaned, counters.mixed, counters.short),
        (1, 2, 1, 1)
    );
    assert_eq!(counters.missing, 5);
    assert!(!counters.is_clean());
    let invalid = gyro(41, false, [0; 3]);
    let found = send(&mut gatherer, Some(&invalid), Some(&accel_of(41)));
    assert_eq!(found[0].status, Status::INERTIAL_INVALID);
}

fn refusal(dbc: &str, from: &str, to: &str) -> String {
    let database = Database::parse("unit.dbc", dbc).unwrap();
    let mapping = UNIT.replace(from, to);
    assert!(from.is_empty() || mapping != UNIT, "{from}");
    match SignalMapping::parse("unit.toml", &mapping) {
        Ok(mapping) => Gatherer::new(&database, &mapping).unwrap_err().to_string(),
        Err(problem) => problem.to_string(),
    }
}

#[test]
fn what_is_wrong_is_said_with_file_line_and_signal() {
    let of = |from: &str, to: &str| refusal(UNIT_DBC, from, to);
    assert_eq!(
        of("Gyro.rate_x", "Gyro.rate_w"),
        "unit.toml: rotation.x: message `Gyro` (unit.dbc:9) has no signal `rate_w`, it has counter, \
         valid, rate_x, rate_y, rate_z"
    );
    assert_eq!(
        of("Accel.a_y", "Accelerometer.a_y"),
        "unit.toml: velocity.y: unit.dbc has no message `Accelerometer`"
    );
    assert_eq!(
        of("\"Accel.a_x\"", "\"a_x\""),
        "unit.toml: velocity.x: `a_x` is no signal, expected is `Message.signal`"
    );
    assert_eq!(
        of("unit = \"m/s2\"", "unit = \"g\""),
        "unit.toml: velocity.x: signal `a_x` has unit `m/s^2` in the database (unit.dbc:19), not `g`"
    );
    assert_eq!(
        of("unit = \"m/s2\"", "unit = \"furlong\""),
        "unit.toml: velocity.x: unit `furlong` doesn't fit, expected is one of m/s, mm/s, m/s2, mm/s2, g, \
         mg, ug"
    );
    assert_eq!(
        of("\"Gyro.rate_y\"", "\"Accel.a_y\""),
        "unit.toml: rotation.y: signal `a_y` (unit.dbc:20) has unit `m/s^2`, expected is one of rad, \
         mrad, urad, deg, arcsec, rad/s, mrad/s, deg/s, deg/h"
    );
    assert_eq!(
        of("\"Gyro.rate_y\"", "\"Float.angle\""),
        "unit.toml: rotation.y: signal `angle` (unit.dbc:25) has no unit: say it, one of rad, mrad, urad, \
         deg, arcsec, rad/s, mrad/s, deg/s, deg/h"
    );
    assert_eq!(
        of("\"Accel.time\"", "\"Accel.temperature\""),
        "unit.toml: stamp: signal `temperature` (unit.dbc:22) has unit `degC`, expected is one of s, ms, \
         us, ns"
    );
    assert_eq!(
        of("\"Gyro.counter\" }", "\"Gyro.rate_x\" }"),
        "unit.toml: sequence: signal `rate_x` (unit.dbc:12) is no counter: expected is an unsigned \
         integer without an offset"
    );
    assert_eq!(
        of("\"Gyro.valid\"", "\"Float.wide\""),
        "unit.dbc:26: signal `wide` of 16 bits from bit 88 doesn't fit in the 12 bytes of its message"
    );
    assert_eq!(
        of("\"Gyro.valid\"", "\"Float.chosen\""),
        "unit.dbc:28: signal `chosen` is multiplexed, which isn't supported"
    );
    assert_eq!(
        of("[\"Gyro\", \"Accel\"]", "[\"Gyro\"]"),
        "unit.toml: order: message `Accel` isn't in it, but a signal of it is mapped"
    );
    assert_eq!(
        of("[\"Gyro\", \"Accel\"]", "[\"Gyro\", \"Gyro\"]"),
        "unit.toml: order: `Gyro` is no message of which a signal is mapped, or stands here twice"
    );
    assert!(
        of("valid =", "walid =").starts_with("unit.toml:7: unknown field `walid`"),
        "{}",
        of("valid =", "walid =")
    );
    // Rates are mixed with increments.
    let mixed = UNIT_DBC.replace(
        "rate_y : 26|18@1- (0.0025,0) [0|0] \"deg/s\"",
        "rate_y : 26|18@1- (0.0025,0) [0|0] \"deg\"",
    );
    assert_eq!(
        refusal(&mixed, "", ""),
        "unit.toml: rotation.y: signal `Gyro.rate_y` (unit.dbc:13) is another quantity than that of x: all \
         are increments, or all are rates"
    );
}

#[test]
fn a_file_that_is_no_database() {
    let broken = UNIT_DBC.replace("rate_y : 26|18@1-", "rate_y : 26-18@1-");
    let problem = Database::parse("unit.dbc", &broken).unwrap_err().to_string();
    assert!(problem.starts_with("unit.dbc:13: this is no DBC: expected"), "{problem}");
    assert!(Database::parse("unit.dbc", "no database at all").is_err());
}

/// Signals that are IEEE floats.
#[test]
fn floats() {
    let mapping = r#"
rotation = { x = "Float.angle", y = "Float.angle", z = "Float.angle", unit = "mrad", scale = 2.0 }
velocity = { x = "Float.choice", y = "Float.choice", z = "Float.choice", unit = "mm/s" }
"#;
    let mut gatherer = gatherer(UNIT_DBC, mapping);
    let mut data = [0; 12];
    data[..4].copy_from_slice(&(-1.25f32).to_le_bytes());
    data[4] = 200;
    let reading = gatherer.receive(&CanFrame { id: 293, extended: false, data: &data }).unwrap();
    let (rotation, velocity) = (reading.rotation.unwrap(), reading.velocity.unwrap());
    assert_eq!(
        (rotation.kind, rotation.value, rotation.lsb),
        (ReadingKind::Increment, [-2.5e-3; 3], None)
    );
    assert_eq!((velocity.kind, velocity.value), (ReadingKind::Increment, [0.2; 3]));
}

/// Runs the fuzzer's seeds and findings; the seeds are written with `OCTANT_WRITE_FIXTURES=1`.
#[test]
fn the_corpus_of_the_fuzzer() {
    let mut seed = [UNIT_DBC, UNIT, ""].join("=====\n").into_bytes();
    for (id, data) in
        [(291u32, &gyro(1, true, [1, 2, 3])[..]), (1060 | 1 << 31, &accel(1, 9, [4, 5, 6]))]
    {
        seed.extend(id.to_le_bytes());
        seed.push(data.len() as u8);
        seed.extend(data);
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fuzz/corpus/dbc");
    let file = format!("{folder}/unit");
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(&file, &seed).unwrap();
    }
    let shipped = std::fs::read(&file).unwrap_or_default();
    assert!(shipped == seed, "run this test with OCTANT_WRITE_FIXTURES=1 to write {file}");
    for entry in std::fs::read_dir(folder).unwrap() {
        fuzz::bus(&std::fs::read(entry.unwrap().path()).unwrap());
    }
}
