//! Protocols by a description: bytes of real units, encoders of the test's own, damage, and cuts.

use crate::common::unhex;
use crc::{CRC_32_MPEG_2, Crc};
use octant_instruments::described::{CrcParameters, DescribedCrc};
use octant_instruments::description::{READY, UnitDescription};
use octant_instruments::{AnyDecoder, FramingEvent, Reading, ReadingKind, Stamp, StampClock};
use octant_sample::Status;
use proptest::prelude::*;

const DEGREE_RAD: f64 = std::f64::consts::PI / 180.0;
const G_MPS2: f64 = 9.806_65;

fn ready(name: &str) -> AnyDecoder {
    UnitDescription::ready(name).unwrap().unwrap().decoder()
}

/// Decodes a whole stream, in pieces of `step` bytes, to its end.
fn decode(decoder: &mut AnyDecoder, bytes: &[u8], step: usize) -> Vec<Reading> {
    let mut all = Vec::new();
    let mut take = |event| {
        if let FramingEvent::Reading(reading) = event {
            all.push(reading);
        }
    };
    for mut piece in bytes.chunks(step) {
        while let Some(event) = decoder.next(&mut piece) {
            take(event);
        }
    }
    while let Some(event) = decoder.end() {
        take(event);
    }
    let counters = decoder.counters();
    assert_eq!(counters.bytes, bytes.len() as u64);
    assert_eq!(counters.bytes_framed + counters.bytes_lost, bytes.len() as u64);
    all
}

fn near(found: [f64; 3], expected: [f64; 3], relative: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() <= relative * expected.abs(), "{found} {expected}");
    }
}

/// A frame of a KVH 1750 in the unit test kvhtest.cpp of the ROS driver kvh_driver, with the CRC there.
const KVH_1750: &str =
    "FE81FF55 37A96A6E 38586C1F B75BF862 BF803E78 BB650D28 3B0A37AC 77 3D 0028 4BFA34D8";

/// A datagram of a STIM300: the values and the CRC that github.com/geirhovland/stim300 prints of a real unit, put in
/// the order of the datasheet. The unit's CRC, 3326689990, holds for no other order, scale, status or dummy byte.
const STIM300: &str = "AF 000124 FFFAD6 00035B 00 FFE7A6 FFDD36 081C52 00 FF7E70 FEBA0C 3FFA1D 00 23A0 23C0 23A0 00 \
    2319 230A 231C 00 2395 23B6 2395 00 FFEF02 00 E1 01FA C64942C6";

#[test]
fn a_frame_of_a_real_kvh_1750_is_read() {
    for (name, kind) in
        [("kvh-1775-rate", ReadingKind::Mean), ("kvh-1775-angle", ReadingKind::Increment)]
    {
        let mut decoder = ready(name);
        let found = decode(&mut decoder, &unhex(KVH_1750), 1000);
        assert!(decoder.counters().is_clean());
        let [reading] = found[..] else { panic!("{found:?}") };
        let rotation = reading.rotation.unwrap();
        assert_eq!(rotation.kind, kind);
        // Single precision of Python's struct.unpack, printed with all digits.
        let expected =
            [2.019_593_011_937_104e-5, 5.159_910_870_133_899e-5, -1.311_124_833_591_748e-5];
        assert_eq!(rotation.value, expected);
        let velocity = reading.velocity.unwrap();
        assert_eq!(velocity.kind, ReadingKind::Mean);
        let g = [-1.001_906_394_958_496, -0.003_495_046_868_920_326_2, 0.002_109_031_192_958_355];
        near(velocity.value, g.map(|g| g * G_MPS2), 1e-15);
        assert_eq!((reading.sequence, reading.status), (Some(61), Status::empty()));
        assert_eq!((reading.status_word, reading.temperature_c), (Some(0x77), Some(40.0)));
    }
}

#[test]
fn the_message_of_a_kvh_built_in_test_is_a_frame_without_a_reading() {
    // Bytes and checksum of kvhtest.cpp.
    let bytes = unhex("FE8100AA 7F7F7E7B7F7F 1E");
    let mut decoder = ready("kvh-1775-rate");
    assert_eq!(decode(&mut decoder, &bytes, 1000), []);
    assert!(decoder.counters().is_clean());
    assert_eq!(decoder.counters().other, 1);
}

#[test]
fn a_datagram_of_a_real_stim300_is_read() {
    let mut decoder = ready("stim300-rate");
    let found = decode(&mut decoder, &unhex(STIM300), 1000);
    assert!(decoder.counters().is_clean(), "{:?}", decoder.counters());
    let [reading] = found[..] else { panic!("{found:?}") };
    let (rotation, velocity) = (reading.rotation.unwrap(), reading.velocity.unwrap());
    assert_eq!((rotation.kind, velocity.kind), (ReadingKind::Mean, ReadingKind::Mean));
    let rate = [0.017_822_265_625, -0.080_688_476_562_5, 0.052_429_199_218_75];
    near(rotation.value, rate.map(|rate| rate * DEGREE_RAD), 1e-15);
    let force = [-0.011_890_411_376_953_125, -0.016_986_846_923_828_125, 1.013_828_277_587_890_6];
    near(velocity.value, force.map(|force| force * G_MPS2), 1e-15);
    assert_eq!((reading.sequence, reading.temperature_c), (None, Some(35.625)));
}

#[test]
fn the_words_of_the_example_are_read_with_scales_signs_and_flags() {
    // Words as its description says. The sum by hand: EB90 + 8005 + 1 + A = 16BA0, + FFF6 + 64 = 26BFA, + 800 + F800
    // = 36BFA, + 9C40 + 1964 + 8002 = 4A1A0, of which 16 bits count.
    let words: [u16; 13] = [
        0xEB90, 0x8005, 0x0001, 0x0000, 0x000A, 0xFFF6, 0x0064, 0x0800, 0xF800, 0x9C40, 0x1964,
        0x8002, 0x0000,
    ];
    let sum = words.iter().fold(0u32, |sum, word| sum + u32::from(*word)) as u16;
    assert_eq!(sum, 0xA1A0);
    let bytes: Vec<u8> = words.iter().chain(&[sum]).flat_map(|word| word.to_be_bytes()).collect();
    let found = decode(&mut ready("ln-100-like"), &bytes, 1000);
    let [reading] = found[..] else { panic!("{found:?}") };
    // The highest bits of the counter's word are another's.
    assert_eq!(reading.sequence, Some(5));
    // 65 536 units of 25 µs.
    assert_eq!(reading.stamp, Some(Stamp { ns: 1_638_400_000, clock: StampClock::Startup }));
    let arcsec = DEGREE_RAD / 3600.0;
    near(reading.rotation.unwrap().value, [1.0, -1.0, -10.0].map(|v| v * arcsec), 1e-12);
    near(reading.velocity.unwrap().value, [0.5, -0.5, 25_536.0 / 4096.0], 1e-12);
    assert_eq!(reading.temperature_c, Some(25.0));
    assert_eq!(reading.status, Status::GYRO_SATURATED);
}

/// Frame of format A by the tables of the manual, with the CRC of the crate `crc`.
fn kvh(number: u8) -> Vec<u8> {
    let k = f32::from(number);
    let mut bytes = vec![0xFE, 0x81, 0xFF, 0x55];
    for value in [1e-5 * k, -2e-5, 3e-4 * k, 0.01 * k, -0.02, -1.0] {
        bytes.extend(value.to_be_bytes());
    }
    bytes.extend([if number == 6 { 0x37 } else { 0x77 }, (120 + number) & 127, 0, 21]);
    let crc = Crc::<u32>::new(&CRC_32_MPEG_2).checksum(&bytes);
    bytes.extend(crc.to_be_bytes());
    bytes
}

#[test]
fn a_counter_rolls_over_and_a_lost_frame_is_missing() {
    let frames: Vec<Vec<u8>> = (1..=12).filter(|number| *number != 9).map(kvh).collect();
    let mut decoder = ready("kvh-1775-rate");
    let found = decode(&mut decoder, &frames.concat(), 1000);
    let numbers: Vec<u64> = found.iter().filter_map(|reading| reading.sequence).collect();
    assert_eq!(numbers, [121, 122, 123, 124, 125, 126, 127, 128, 130, 131, 132]);
    assert_eq!(decoder.counters().missing, 1);
    let invalid: Vec<bool> =
        found.iter().map(|reading| reading.status.contains(Status::INERTIAL_INVALID)).collect();
    assert_eq!(invalid.iter().filter(|invalid| **invalid).count(), 1);
    assert!(invalid[5], "its bit of accelerometer z is off");
}

/// Three frames of each description: real ones where there are any.
fn streams() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    let mut second: Vec<u8> = unhex(STIM300)[..59].to_vec();
    second[3] = 0x77;
    let padded = [&second[..], &[0]].concat();
    second.extend(Crc::<u32>::new(&CRC_32_MPEG_2).checksum(&padded).to_be_bytes());
    let word = |number: u16| -> Vec<u8> {
        let words = [0xEB90, number, 0, number * 200, 1, 2, 3, 4, 5, 6, 4100, 0x8000, 0u16];
        let sum = words.iter().fold(0u16, |sum, word| sum.wrapping_add(*word));
        words.iter().chain(&[sum]).flat_map(|word| word.to_be_bytes()).collect()
    };
    vec![
        ("kvh-1775-rate", vec![kvh(1), kvh(2), kvh(3)]),
        ("stim300-rate", vec![unhex(STIM300), second, unhex(STIM300)]),
        ("stim300-increment", vec![unhex(STIM300), unhex(STIM300), unhex(STIM300)]),
        ("ln-100-like", vec![word(7), word(8), word(9)]),
    ]
}

/// Replaces every byte of a frame by every other value: all readings found were sent, and the frames before and after
/// are found.
#[test]
fn no_byte_of_a_frame_can_be_another_one() {
    for (name, frames) in streams() {
        let decoder = ready(name);
        let sent = decode(&mut decoder.clone(), &frames.concat(), 4096);
        assert_eq!(sent.len(), 3);
        let before = frames[0].len();
        for at in 0..frames[1].len() {
            for flip in 1..=255u8 {
                let mut bytes = frames.concat();
                bytes[before + at] ^= flip;
                let mut decoder = decoder.clone();
                let found = decode(&mut decoder, &bytes, 4096);
                let context = format!("{name} byte {at} ^ {flip:#04x}");
                assert_eq!(found, [sent[0], sent[2]], "{context}");
                assert!(!decoder.counters().is_clean(), "{context}");
            }
        }
    }
}

#[test]
fn cuts_and_bytes_between_frames_make_no_difference() {
    for (name, frames) in streams() {
        let sent = decode(&mut ready(name), &frames.concat(), 4096);
        // Beginnings of frames that never come, of each of its frames.
        let noise = [0xFE, 0x81, 0xFF, 0xAF, 0xEB, 0xF7, 0x91, 0xFE];
        let mut bytes = Vec::new();
        for frame in &frames {
            bytes.extend(noise);
            bytes.extend(frame);
        }
        for step in 1..bytes.len() {
            let mut decoder = ready(name);
            assert_eq!(decode(&mut decoder, &bytes, step), sent, "{name}, pieces of {step}");
            assert_eq!(decoder.counters().bytes_lost, 24, "{name}, pieces of {step}");
        }
        for cut in 1..frames[1].len() {
            let bytes = [&frames[0], &frames[1][..cut], &frames[2]].concat();
            assert_eq!(decode(&mut ready(name), &bytes, 4096), [sent[0], sent[2]], "{name} {cut}");
        }
    }
}

/// Parameters and results of the catalogue of parametrised CRC algorithms, as the crate `crc-catalog` has them.
#[test]
fn every_crc_of_the_catalogue_is_computed() {
    macro_rules! check {
        ($number:ty: $($name:ident)+) => {$({
            let known: crc::Algorithm<$number> = crc::$name;
            let crc = DescribedCrc::new(CrcParameters {
                width: known.width.into(),
                poly: known.poly.into(),
                init: known.init.into(),
                refin: known.refin,
                refout: known.refout,
                xorout: known.xorout.into(),
            });
            let found = crc.of(b"123456789".iter().copied());
            assert_eq!(found, u32::from(known.check), stringify!($name));
        })+};
    }
    check!(u8: CRC_8_SMBUS CRC_8_MAXIM_DOW CRC_8_AUTOSAR CRC_8_DARC CRC_8_I_432_1 CRC_8_WCDMA);
    check!(u16: CRC_16_XMODEM CRC_16_KERMIT CRC_16_MODBUS CRC_16_IBM_3740 CRC_16_GENIBUS CRC_16_DNP CRC_16_USB);
    check!(u32: CRC_32_MPEG_2 CRC_32_ISO_HDLC CRC_32_BZIP2 CRC_32_CKSUM CRC_32_ISCSI CRC_32_JAMCRC);
}

#[test]
fn every_ready_description_says_where_it_is_from_and_what_it_never_met() {
    for (name, text) in READY {
        UnitDescription::parse(name, text).unwrap();
        let is_example = text.starts_with("# An example, and NOT a maker's format");
        assert!(is_example || text.contains("# Sources: "), "{name}");
        assert!(is_example || text.contains("never met a real unit"), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Arbitrary bytes are counted, cause no panic, and give the same in pieces of any length.
    #[test]
    fn any_bytes_are_counted(
        bytes in proptest::collection::vec(prop_oneof![Just(0xFEu8), Just(0x81), Just(0xFF), Just(0x91), any::<u8>()], 0..3000),
        step in 1usize..200,
    ) {
        for (name, _) in READY {
            let (mut whole, mut cut) = (ready(name), ready(name));
            prop_assert_eq!(decode(&mut whole, &bytes, 4096), decode(&mut cut, &bytes, step));
            prop_assert_eq!(whole.counters(), cut.counters());
        }
    }

    /// Every description that is read, whatever its numbers, decodes any bytes without a panic.
    #[test]
    fn any_description_is_read_or_refused(
        length in -5i64..1100,
        places in proptest::collection::vec(-40i64..40, 8),
        mask in 0i64..300,
        kind in prop_oneof![Just("sum8"), Just("words16"), Just("xor8"), Just("none"), Just("sum16")],
        bytes in proptest::collection::vec(any::<u8>(), 0..500),
    ) {
        let [a, b, c, d, e, f, g, h] = places[..] else { unreachable!() };
        let checksum = if kind == "none" { String::new() } else { format!(", at = {a}, to = {b}, pad_to = 3") };
        let field = |is: &str, at: i64, ty: &str, unit: &str| {
            format!("{{ is = \"{is}\", at = {at}, type = \"{ty}\", unit = \"{unit}\" }},")
        };
        let text = format!(
            "version = 1\nname = \"any\"\nchecksum = {{ kind = \"{kind}\"{checksum} }}\n[[frame]]\nsync = [7]\n\
             length = {length}\nfield = [{}{}{}{}{}{}{{ is = \"counter\", at = 2, type = \"u16\", mask = {mask} }}]\n",
            field("gyro x", c, "f64", "rad"), field("gyro y", d, "i24", "rad"), field("gyro z", e, "u8", "rad"),
            field("accel x", f, "i64", "g"), field("accel y", g, "f32", "mg"), field("accel z", h, "u64", "m/s2"),
        );
        if let Ok(unit) = UnitDescription::parse("any.toml", &text) {
            decode(&mut unit.decoder(), &bytes, 11);
        }
    }
}
