//! Records of one length by a description: numbers of an encoder of the test's own, and lengths that aren't those of the file.

use octant_instruments::description::UnitDescription;
use octant_instruments::framing::ReadingCounters;
use octant_instruments::{AnyDecoder, FramingEvent, Reading, ReadingKind, UnreadBytes};

/// Increments and a time in doubles, in the order of PSINS' binary files: three angles, three velocities, seconds.
const PSINS: &str = r#"version = 2
name = "doubles as PSINS keeps them"
[record]
length = 56
field = [
    { is = "gyro x", at = 0, type = "f64", unit = "rad" },
    { is = "gyro y", at = 8, type = "f64", unit = "rad" },
    { is = "gyro z", at = 16, type = "f64", unit = "rad" },
    { is = "accel x", at = 24, type = "f64", unit = "m/s" },
    { is = "accel y", at = 32, type = "f64", unit = "m/s" },
    { is = "accel z", at = 40, type = "f64", unit = "m/s" },
    { is = "stamp", at = 48, type = "f64", unit = "s" },
]
"#;

/// A header of 512 bytes, a time and six integers, in the style of Waypoint's IMR files.
const IMR: &str = r#"version = 2
name = "integers behind a header, in the style of IMR files"
[record]
skip = 512
length = 32
field = [
    { is = "stamp", at = 0, type = "f64", unit = "s" },
    { is = "gyro x", at = 8, type = "i32", unit = "deg", scale = 1e-8 },
    { is = "gyro y", at = 12, type = "i32", unit = "deg", scale = 1e-8 },
    { is = "gyro z", at = 16, type = "i32", unit = "deg", scale = 1e-8 },
    { is = "accel x", at = 20, type = "i32", unit = "m/s", scale = 1e-6 },
    { is = "accel y", at = 24, type = "i32", unit = "m/s", scale = 1e-6 },
    { is = "accel z", at = 28, type = "i32", unit = "m/s", scale = 1e-6 },
]
"#;

fn psins(k: u32) -> ([f64; 7], Vec<u8>) {
    let k = f64::from(k);
    let values =
        [7e-7 * (1.0 + k), -3e-7, 2e-8 * k, 1e-4 * k, -2e-4, -0.049 - 1e-6 * k, 5400.0 + 0.005 * k];
    (values, values.iter().flat_map(|value| value.to_le_bytes()).collect())
}

fn imr(k: i32) -> Vec<u8> {
    let time = 345_600.005 + 0.005 * f64::from(k);
    let numbers = [2_000 + k, -k, 17, 400 * k, -3, -49_000 - k];
    time.to_le_bytes().into_iter().chain(numbers.into_iter().flat_map(i32::to_le_bytes)).collect()
}

fn decoder(text: &str) -> AnyDecoder {
    UnitDescription::parse("unit.toml", text).unwrap().decoder()
}

/// Decodes a whole file, in pieces of `step` bytes.
fn decode(
    text: &str,
    bytes: &[u8],
    step: usize,
) -> (Vec<Reading>, Vec<UnreadBytes>, ReadingCounters) {
    let mut decoder = decoder(text);
    let (mut readings, mut lost) = (Vec::new(), Vec::new());
    let mut take = |event| match event {
        FramingEvent::Reading(reading) => readings.push(reading),
        FramingEvent::Lost(unread) => lost.push(unread),
    };
    for mut piece in bytes.chunks(step) {
        while let Some(event) = decoder.next(&mut piece) {
            take(event);
        }
    }
    while let Some(event) = decoder.end() {
        take(event);
    }
    let counters = *decoder.counters();
    assert_eq!(counters.bytes, bytes.len() as u64);
    assert_eq!(counters.bytes_framed + counters.bytes_lost, bytes.len() as u64);
    (readings, lost, counters)
}

/// Message of the first defect that ends the reading.
fn told(text: &str, bytes: &[u8]) -> Option<String> {
    let (_, lost, _) = decode(text, bytes, 4096);
    lost.iter().find(|unread| unread.cause.is_final()).map(|unread| unread.cause.to_string())
}

#[test]
fn doubles_are_read_to_the_last_bit_in_any_pieces() {
    let bytes: Vec<u8> = (0..50).flat_map(|k| psins(k).1).collect();
    for step in [1, 3, 55, 56, 57, 4096] {
        let (readings, lost, counters) = decode(PSINS, &bytes, step);
        assert!(lost.is_empty() && counters.is_clean());
        assert_eq!(readings.len(), 50);
        for (reading, k) in readings.iter().zip(0..) {
            let (values, _) = psins(k);
            let (rotation, velocity) = (reading.rotation.unwrap(), reading.velocity.unwrap());
            assert_eq!(
                (rotation.kind, velocity.kind),
                (ReadingKind::Increment, ReadingKind::Increment)
            );
            assert_eq!(rotation.value[..], values[..3]);
            assert_eq!(velocity.value[..], values[3..6]);
            assert_eq!(reading.stamp.unwrap().ns, 5_400_000_000_000 + 5_000_000 * u64::from(k));
        }
    }
}

#[test]
fn integers_behind_a_header_have_their_scale() {
    let mut bytes: Vec<u8> = (0..512).map(|k| (k * 7) as u8).collect();
    bytes.extend((0..20).flat_map(imr));
    // A torn end.
    bytes.extend(&imr(20)[..11]);
    for step in [1, 500, 511, 513, 10_000] {
        let (readings, lost, counters) = decode(IMR, &bytes, step);
        assert!(lost.is_empty());
        assert_eq!(
            (readings.len(), counters.bytes_lost, counters.bytes_framed),
            (20, 11, 512 + 640)
        );
        let reading = readings[3];
        let degree_rad = std::f64::consts::PI / 180.0;
        let turned = [2003.0, -3.0, 17.0].map(|count| count * 1e-8 * degree_rad);
        for (found, expected) in reading.rotation.unwrap().value.into_iter().zip(turned) {
            assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{found} {expected}");
        }
        for (found, count) in
            reading.velocity.unwrap().value.into_iter().zip([1200.0, -3.0, -49_003.0])
        {
            assert!((found - count * 1e-6).abs() <= 1e-15 * count.abs(), "{found} {count}");
        }
        assert_eq!(reading.stamp.unwrap().ns, 345_600_020_000_000);
    }
}

#[test]
fn every_wrong_length_and_every_wrong_beginning_is_told_with_a_record() {
    let doubles: Vec<u8> = (0..400).flat_map(|k| psins(k).1).collect();
    let mut integers = vec![0; 512];
    integers.extend((0..400).flat_map(imr));
    for (text, length, right, bytes) in [(PSINS, 56, 0, &doubles), (IMR, 32, 512, &integers)] {
        assert_eq!(told(text, bytes), None);
        for wrong in length + 1..4 * length {
            let text = text.replace(&format!("length = {length}"), &format!("length = {wrong}"));
            // Every second record is one as well: of those the stamps and the rate tell, not the numbers.
            let expected = if wrong % length == 0 { None } else { Some("record ") };
            let found = told(&text, bytes);
            assert_eq!(found.as_deref().map(|said| &said[..7]), expected, "{wrong}: {found:?}");
        }
        for more in 1..length {
            let text = text
                .replace("[record]\n", "[record]\nskip = 0\n")
                .replace("skip = 0\nskip", "skip");
            let text =
                text.replace(&format!("skip = {right}\n"), &format!("skip = {}\n", right + more));
            let found = told(&text, bytes).unwrap_or_default();
            assert!(found.starts_with("record "), "{more}: {found:?}");
        }
    }
}

#[test]
fn a_number_that_is_none_and_a_stamp_that_stands_are_told_with_their_record() {
    let with = |record: u32, at: usize, value: f64| {
        let mut bytes: Vec<u8> = (0..10).flat_map(|k| psins(k).1).collect();
        let start = 56 * record as usize + at;
        bytes[start..start + 8].copy_from_slice(&value.to_le_bytes());
        told(PSINS, &bytes).unwrap()
    };
    let end = "; the records have another length, or begin elsewhere";
    assert_eq!(
        with(6, 8, f64::NAN),
        format!("record 7: gyro y is NaN, expected a finite number{end}")
    );
    assert_eq!(
        with(2, 40, f64::NEG_INFINITY),
        format!("record 3: accel z is -inf, expected a finite number{end}")
    );
    assert_eq!(
        with(2, 24, 1e6),
        format!("record 3: accel x is 1e6 in SI units, which no sensor gives{end}")
    );
    let said = with(4, 48, 5400.015);
    let expected =
        "record 5: the stamp, 5400015000000 ns, isn't after the one before it, 5400015000000 ns";
    assert_eq!(said, format!("{expected}{end}"));
}

#[test]
fn a_damaged_record_is_left_out_and_two_in_a_row_end_it() {
    let text = PSINS
        .replace("length = 56", "length = 57")
        .replace("[record]\n", "[record]\nchecksum = { kind = \"sum8\", at = -1 }\n");
    let record = |k: u32| -> Vec<u8> {
        let mut bytes = psins(k).1;
        bytes.push(bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte)));
        bytes
    };
    let mut bytes: Vec<u8> = (0..20).flat_map(record).collect();
    bytes[57 * 5 + 3] ^= 0x40;
    bytes[57 * 12 + 30] ^= 0x01;
    let (readings, lost, counters) = decode(&text, &bytes, 100);
    assert_eq!((readings.len(), lost.len(), counters.checksum), (18, 2, 2));
    assert!(lost.iter().all(|unread| !unread.cause.is_final()));
    bytes[57 * 13 + 30] ^= 0x01;
    let said = told(&text, &bytes).unwrap();
    assert!(
        said.starts_with(
            "record 14: its checksum is wrong, and so is that of the record before it"
        ),
        "{said}"
    );
}

#[test]
fn descriptions_of_records_are_checked() {
    let said = |old: &str, new: &str| {
        assert_eq!(PSINS.matches(old).count(), 1, "{old}");
        UnitDescription::parse("unit.toml", &PSINS.replace(old, new)).unwrap_err().to_string()
    };
    let expected = "unit.toml:4: record: found in a description of version 1, expected version = 2";
    assert!(
        said("version = 2", "version = 1").contains(&expected[12..]),
        "{}",
        said("version = 2", "version = 1")
    );
    assert_eq!(
        said("length = 56", "length = 55"),
        "unit.toml:12: record.field[6].at: found 48, from which 8 bytes don't end within the frame's 55"
    );
    assert_eq!(
        said("length = 56\n", ""),
        "unit.toml:3: record.length: missing, expected the number of a record's bytes"
    );
    assert_eq!(
        said("length = 56", "length = 56\nsync = [0xA5]"),
        "unit.toml:5: record.sync: unknown key; known keys: length, skip, checksum, field"
    );
    let frame = PSINS
        .replace("version = 2", "version = 1")
        .replace("[record]", "checksum = { kind = \"none\" }\n[[frame]]\nsync = [0]");
    let found = UnitDescription::parse("unit.toml", &frame).unwrap_err().to_string();
    assert!(
        found.ends_with("found a floating-point type, expected an integer, or version = 2"),
        "{found}"
    );
    UnitDescription::parse("unit.toml", &frame.replace("version = 1", "version = 2")).unwrap();
}
