//! Lines of text by a description: a line of a real unit, checksums, pieces, damage.

use octant_instruments::description::UnitDescription;
use octant_instruments::framing::ReadingCounters;
use octant_instruments::{AnyDecoder, FramingEvent, Reading, ReadingDefect, ReadingKind};
use octant_sample::Status;

/// A line of a VN-200, as the comments of several people's programs for it print one, with its checksum.
const VNIMU: &str = "$VNIMU,-00.0350,+00.4222,-00.6643,-00.015,+00.019,+09.948,+00.002066,-00.008442,-00.044656,+20.7,+084.322*66\r\n";

const COMMA: &str = r#"version = 2
name = "comma text"
skip_lines = 1
[[line]]
columns = 9
checksum = "none"
field = [
    { is = "stamp", column = 1, unit = "s" },
    { is = "counter", column = 2, modulo = 100 },
    { is = "gyro x", column = 3, unit = "deg/s" },
    { is = "gyro y", column = 4, unit = "deg/s" },
    { is = "gyro z", column = 5, unit = "deg/s", scale = -1.0 },
    { is = "accel x", column = 6, unit = "g" },
    { is = "accel y", column = 7, unit = "g" },
    { is = "accel z", column = 8, unit = "g" },
    { is = "status", column = 9, good = 1, faulty = 0x80 },
]
"#;

/// Decodes what comes in pieces of `step` bytes, to its end.
fn decode(
    decoder: &mut AnyDecoder,
    bytes: &[u8],
    step: usize,
) -> (Vec<Reading>, Vec<ReadingDefect>) {
    let (mut readings, mut lost) = (Vec::new(), Vec::new());
    let mut take = |event| match event {
        FramingEvent::Reading(reading) => readings.push(reading),
        FramingEvent::Lost(unread) => lost.push(unread.cause),
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
    (readings, lost)
}

fn file(text: &str) -> AnyDecoder {
    UnitDescription::parse("unit.toml", text).unwrap().decoder()
}

fn port(text: &str) -> AnyDecoder {
    UnitDescription::parse("unit.toml", text).unwrap().port_decoder().unwrap()
}

/// CRC-16 of VectorNav by the program in its manual: polynomial 0x1021, bit by bit.
fn crc16(text: &str) -> u16 {
    text.bytes().fold(0, |crc, byte| {
        (0..8).fold(crc ^ (u16::from(byte) << 8), |crc, _| {
            if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 }
        })
    })
}

#[test]
fn a_line_of_a_real_vn_200_is_read() {
    let ready = UnitDescription::ready("vectornav-imu-ascii").unwrap().unwrap();
    // The same values behind the number of the register, with a CRC-16, and another message between them.
    let body = format!("VNRRG,54{}", &VNIMU[6..VNIMU.len() - 5]);
    let other = "VNYPR,+006.271,+000.031,-002.000";
    let stream = format!("{VNIMU}${other}*{:02X}\r\n${body}*{:04X}\n", 0, crc16(&body));
    for step in [1, 7, 1000] {
        let mut decoder = ready.port_decoder().unwrap();
        let (readings, lost) = decode(&mut decoder, stream.as_bytes(), step);
        assert!(lost.is_empty(), "{lost:?}");
        assert_eq!((readings.len(), decoder.counters().other), (2, 1));
        for reading in readings {
            let (rotation, velocity) = (reading.rotation.unwrap(), reading.velocity.unwrap());
            assert_eq!((rotation.kind, velocity.kind), (ReadingKind::Mean, ReadingKind::Mean));
            assert_eq!(rotation.value, [0.002_066, -0.008_442, -0.044_656]);
            assert_eq!(velocity.value, [-0.015, 0.019, 9.948]);
            assert_eq!(reading.temperature_c, Some(20.7));
        }
    }
}

#[test]
fn no_single_change_of_a_line_gives_another_reading() {
    let ready = UnitDescription::ready("vectornav-imu-ascii").unwrap().unwrap();
    let line = VNIMU.as_bytes();
    for at in 0..line.len() - 2 {
        for byte in (0..=255).filter(|byte| *byte != line[at]) {
            let damaged = [&line[..at], &[byte][..], &line[at + 1..], line].concat();
            let mut decoder = ready.port_decoder().unwrap();
            let (readings, _) = decode(&mut decoder, &damaged, 1000);
            let values: Vec<[f64; 3]> =
                readings.iter().map(|reading| reading.rotation.unwrap().value).collect();
            let sent = [0.002_066, -0.008_442, -0.044_656];
            // A hexadecimal digit may be a small letter: then nothing changed. A new line within the checksum ends the line.
            let most = if damaged[..line.len()].eq_ignore_ascii_case(line) { 2 } else { 1 };
            assert!(
                values.len() <= most && values.iter().all(|value| *value == sent),
                "{at} {byte}"
            );
            assert!(!values.is_empty() || byte == b'\n' || at == 0, "{at} {byte}");
        }
    }
}

fn comma(k: u32) -> String {
    format!(
        "{}.{:09},{},{},-0.5,{:e},0.01,-1e-3,1.0,0x01\r\n",
        1_700_000_000 + k / 200,
        (k % 200) * 5_000_000,
        k % 100,
        k,
        1e-3
    )
}

#[test]
fn comma_text_is_read_with_stamps_to_the_nanosecond_and_counters_that_roll_over() {
    let lines: Vec<String> = (0..500).filter(|k| *k != 250).map(comma).collect();
    let text = format!("time,number,gx,gy,gz,ax,ay,az,status\r\n\r\n{}", lines.concat());
    for step in [1, 13, 4096] {
        let mut decoder = file(COMMA);
        let (readings, lost) = decode(&mut decoder, text.as_bytes(), step);
        assert!(lost.is_empty(), "{lost:?}");
        assert_eq!(readings.len(), 499);
        let counters = decoder.counters();
        assert_eq!((counters.other, counters.missing, counters.behind), (2, 1, 0));
        for (reading, k) in readings.iter().zip((0..500_u32).filter(|k| *k != 250)) {
            assert_eq!(reading.sequence, Some(u64::from(k)));
            assert_eq!(
                reading.stamp.unwrap().ns,
                1_700_000_000_000_000_000 + 5_000_000 * u64::from(k)
            );
            let degree_rad = std::f64::consts::PI / 180.0;
            let expected = [f64::from(k) * degree_rad, -0.5 * degree_rad, -1e-3 * degree_rad];
            for (found, expected) in reading.rotation.unwrap().value.into_iter().zip(expected) {
                assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{found} {expected}");
            }
            assert_eq!(reading.status, Status::empty());
        }
    }
}

#[test]
fn what_is_no_line_is_counted_and_never_a_reading() {
    for (line, expected) in [
        ("1.0,1,2,3,4,5,6,7\n", "this is no frame, or a piece of one"),
        ("1.0,1,2,3,4,5,6,7,1,9\n", "this is no frame, or a piece of one"),
        ("1.0,1,2,x,4,5,6,7,1\n", "the frame is intact, but its gyro y is no such number"),
        ("1.0,1,2,3,4,,6,7,1\n", "the frame is intact, but its accel x is no such number"),
        ("1.0,-1,2,3,4,5,6,7,1\n", "the frame is intact, but its counter is no such number"),
        ("-1.0,1,2,3,4,5,6,7,1\n", "the frame is intact, but its stamp is no such number"),
    ] {
        let mut decoder = file(COMMA);
        let text = format!("header\n{}{line}{}", comma(1), comma(3));
        let (readings, lost) = decode(&mut decoder, text.as_bytes(), 1000);
        assert_eq!(lost.iter().map(ToString::to_string).collect::<Vec<_>>(), [expected], "{line}");
        assert_eq!(readings.iter().map(|r| r.sequence.unwrap()).collect::<Vec<_>>(), [1, 3]);
        // A line that can't be read doesn't move the counter.
        assert_eq!(decoder.counters().missing, 1, "{line}");
    }
    // A flag of the unit, and a number that is none.
    let text = "header\n1.0,1,2,3,4,5,6,7,0x81\n1.1,2,2,3,4,5,6,7,0\n";
    let (readings, _) = decode(&mut file(COMMA), text.as_bytes(), 1000);
    assert!(readings.iter().all(|reading| reading.status == Status::INERTIAL_INVALID));
    // A line that is too long.
    let text = format!("header\n{}{}\n{}", comma(1), "1".repeat(3000), comma(2));
    let mut decoder = file(COMMA);
    let (readings, _) = decode(&mut decoder, text.as_bytes(), 100);
    assert_eq!(readings.len(), 2);
    let ReadingCounters { malformed, bytes_lost, .. } = *decoder.counters();
    assert_eq!((malformed, bytes_lost), (1, 3001));
}

#[test]
fn a_line_without_a_checksum_is_read_whole_alone() {
    // A port that is opened within a line: 12.5 would be read as 2.5.
    let text = COMMA.replace("skip_lines = 1\n", "");
    let (first, second) = (comma(12), comma(13));
    let torn = &first[1..];
    let mut decoder = port(&text);
    let (readings, lost) = decode(&mut decoder, format!("{torn}{second}").as_bytes(), 1000);
    assert_eq!(readings.iter().map(|r| r.sequence.unwrap()).collect::<Vec<_>>(), [13]);
    assert_eq!(lost, [ReadingDefect::Malformed]);
    // A last line without its end: 1.0 may have been 1.05.
    let mut decoder = file(&text);
    let bytes = format!("{first}{}", second.trim_end());
    let (readings, _) = decode(&mut decoder, bytes.as_bytes(), 1000);
    assert_eq!(readings.len(), 1);
    assert_eq!(decoder.counters().bytes_lost, second.trim_end().len() as u64);
    // With a checksum both are known to be whole.
    let ready = UnitDescription::ready("vectornav-imu-ascii").unwrap().unwrap();
    let (readings, lost) =
        decode(&mut ready.port_decoder().unwrap(), VNIMU.trim_end().as_bytes(), 50);
    assert_eq!((readings.len(), lost.len()), (1, 0));
    // A datagram that is a line without its end, and one whose line is continued in the next one.
    let mut decoder = ready.port_decoder().unwrap();
    let line = VNIMU.trim_end();
    let mut count = 0;
    for datagram in [line, line, &line[..40], &line[40..], VNIMU] {
        let mut bytes = datagram.as_bytes();
        while let Some(event) = decoder.next(&mut bytes).or_else(|| decoder.end_of_datagram()) {
            count += usize::from(matches!(event, FramingEvent::Reading(_)));
        }
    }
    assert_eq!((count, decoder.counters().readings), (4, 4));
    assert!(decoder.counters().is_clean());
    // Each datagram a line: what ended before is no beginning of the next one.
    let mut decoder = port(&text);
    assert!(!decoder.has_checksums());
    let mut found = Vec::new();
    for line in [comma(1), comma(2)[..30].to_owned(), comma(3), comma(4)] {
        let mut bytes = line.as_bytes();
        while let Some(event) = decoder.next(&mut bytes) {
            if let FramingEvent::Reading(reading) = event {
                found.push(reading.sequence.unwrap());
            }
        }
        while decoder.end().is_some() {}
    }
    // The first line may be the end of one, and so may the one behind a torn one.
    assert_eq!(found, [4]);
}

#[test]
fn descriptions_of_lines_are_checked() {
    let said = |old: &str, new: &str| {
        assert_eq!(COMMA.matches(old).count(), 1, "{old}");
        UnitDescription::parse("unit.toml", &COMMA.replace(old, new)).unwrap_err().to_string()
    };
    for (old, new, expected) in [
        (
            "version = 2",
            "version = 1",
            "line: found in a description of version 1, expected version = 2",
        ),
        (
            "columns = 9\n",
            "",
            "unit.toml:4: line[0].columns: missing, expected the number of columns: without a checksum it shows a line that isn't whole",
        ),
        (
            "columns = 9",
            "columns = 8",
            "unit.toml:5: line[0].columns: found 8, expected more than the column 9 of a field",
        ),
        (
            "\"none\"",
            "\"nema\"",
            "unit.toml:6: line[0].checksum: found \"nema\"; did you mean \"nmea\"? expected one of: none, nmea, vectornav",
        ),
        ("column = 1,", "at = 1,", "unit.toml:8: line[0].field[0].at: unknown key"),
        (
            "column = 1,",
            "",
            "unit.toml:8: line[0].field[0].column: missing, expected the number of the column, from 1",
        ),
        ("[[line]]", "byte_order = \"big\"\n[[line]]", "unit.toml:4: byte_order: unknown key"),
        (
            "[[line]]",
            "[[line]]\nbegins = \" $X\"",
            "unit.toml:5: line[0].begins: found \" $X\", expected up to 32 characters without blanks at the ends",
        ),
        (
            "    { is = \"accel x\", column = 6, unit = \"g\" },\n",
            "",
            "unit.toml:7: line[0].field: found 2 of accel x, accel y and accel z, expected all three or none",
        ),
    ] {
        let found = said(old, new);
        assert!(found.contains(expected), "found    {found}\nexpected {expected}");
    }
    let twice = format!("{COMMA}[[line]]\nbegins = \"$A\"\nchecksum = \"nmea\"\nfield = []\n");
    let found = UnitDescription::parse("unit.toml", &twice).unwrap_err().to_string();
    assert!(
        found.contains("line[1].begins: found \"$A\", which can't be told from \"\""),
        "{found}"
    );
}
