//! Bytes from other sources: examples in the makers' manuals, and recordings of their units.

use crate::common::{events, only, readings, unhex};
use octant_instruments::novatel::scale_of;
use octant_instruments::{AnyDecoder, Protocol, ReadingKind, Stamp, StampClock};
use octant_sample::Status;

/// VN-100 user manual UM001, 4.3.7 "Example Cases", both cases: attitude alone, and attitude with a field
/// of four bytes of the IMU group. The frames are intact and hold no reading.
#[test]
fn vectornav_examples_of_the_manual() {
    let one = unhex("FA 01 08 00 93 50 2E 42 83 3E F1 3F 48 B5 04 BB 92 88");
    // The manual prints 01 as the fifth byte, `ImuStatus` of two bytes. The payload has four and the
    // printed CRC is that of 20, the field next to `Temp`: the misprint is no frame.
    let misprinted =
        unhex("FA 05 08 00 01 00 A4 15 02 42 4D DF EB 3F F6 1A 36 BE BF 2D A4 41 A8 3A");
    let mut two = misprinted.clone();
    two[4] = 0x20;
    for bytes in [one, two] {
        let mut decoder = AnyDecoder::new(Protocol::VectorNav);
        assert!(events(&mut decoder, &bytes).is_empty());
        let counters = decoder.counters();
        assert_eq!((counters.other, counters.bytes_framed), (1, bytes.len() as u64));
        assert!(counters.is_clean());
    }
    let mut decoder = AnyDecoder::new(Protocol::VectorNav);
    assert_eq!(events(&mut decoder, &misprinted).len(), 1);
    assert_eq!((decoder.counters().other, decoder.counters().checksum), (0, 1));
}

/// A frame built from the tables of the manual (4.4, 4.6): interval, rotation in degrees and velocity
/// of the common group, with the CRC computed bit by bit as in 3.8.3.
#[test]
fn vectornav_increments_after_the_tables() {
    let mut frame = unhex("FA 01 01 08");
    frame.extend(123_456_789_000u64.to_le_bytes());
    for float in [0.005f32, 45.0, -0.25, 0.001, 0.5, -0.0625, -0.049] {
        frame.extend(float.to_le_bytes());
    }
    let crc = frame[1..].iter().fold(0u16, |crc, byte| {
        (0..8).fold(crc ^ (u16::from(*byte) << 8), |crc, _| {
            if crc & 0x8000 != 0 { (crc << 1) ^ 0x1021 } else { crc << 1 }
        })
    });
    frame.extend(crc.to_be_bytes());
    let reading = only(Protocol::VectorNav, &frame);
    assert_eq!(reading.stamp, Some(Stamp { ns: 123_456_789_000, clock: StampClock::Startup }));
    assert_eq!(reading.interval_s, Some(f64::from(0.005f32)));
    let (rotation, velocity) = (reading.rotation.unwrap(), reading.velocity.unwrap());
    assert_eq!((rotation.kind, velocity.kind), (ReadingKind::Increment, ReadingKind::Increment));
    assert!((rotation.value[0] - core::f64::consts::FRAC_PI_4).abs() < 1e-15);
    assert!((rotation.value[1] + 0.25f64.to_radians()).abs() < 1e-17);
    assert_eq!(velocity.value[..2], [0.5, -0.0625]);
    assert_eq!((reading.sequence, reading.temperature_c), (None, None));
}

/// Logs from the maker's own decoder library ("EDIE", its framer tests): the same epoch as a binary and
/// as an ASCII log of an HG1700-AG58, made by a receiver.
#[test]
fn novatel_binary_and_line_of_one_epoch() {
    let binary = unhex(
        "AA 44 13 28 B6 05 9C 06 78 B9 E2 1C 00 0B 9C 06 0B 97 55 A8 32 94 1D 41 03 15 80 00 \
         EB D0 91 02 A6 87 F3 FF 38 EA FC FF 66 B7 FC FF 1C 5F FF FF 59 D9 FF FF 47 5F AF BA",
    );
    let line = b"%RAWIMUSXA,1692,484620.664;00,11,1692,484620.664389000,00801503,\
        43110635,-817242,-202184,-215194,-41188,-9895*a5db8c7b\r\n";
    let from_binary = only(Protocol::NovAtel, &binary);
    let from_line = only(Protocol::NovAtel, line);
    assert_eq!(from_binary, from_line);
    let reading = from_binary;
    let ns = 1692 * 604_800_000_000_000 + 484_620_664_389_000;
    assert_eq!(reading.stamp, Some(Stamp { ns, clock: StampClock::Gps }));
    assert_eq!(reading.status_word, Some(0x0080_1503));
    assert_eq!(reading.status, Status::empty());
    // Axes are z, −y, x in the log; a count is 2⁻³³ rad and 2⁻²⁷ ft/s.
    let rad = 1.0 / (1u64 << 33) as f64;
    let mps = 0.3048 / (1u64 << 27) as f64;
    let rotation = reading.rotation.unwrap();
    assert_eq!(rotation.kind, ReadingKind::Increment);
    assert_eq!(rotation.value, [-9895.0, 41188.0, -215_194.0].map(|count| count * rad));
    let velocity = reading.velocity.unwrap().value;
    assert_eq!(velocity, [-202_184.0, 817_242.0, 43_110_635.0].map(|count| count * mps));
    // At 100 Hz the increments show gravity.
    let g = velocity.iter().map(|v| (v * 100.0).powi(2)).sum::<f64>().sqrt();
    assert!((g - 9.81).abs() < 0.02, "{g}");
}

/// ASCII example of the receiver's documentation (OEM7, log RAWIMUSX): type 41, which is an Epson G320
/// at 125 Hz.
#[test]
fn novatel_example_of_the_documentation() {
    let line = b"%RAWIMUSXA,2209,491674.014;04,41,2209,491674.013699,ea59fe00,\
        329308016,-2706935,4508389,196192,417138,-1000837*038422a7\r\n";
    let reading = only(Protocol::NovAtel, line);
    let ns = 2209 * 604_800_000_000_000 + 491_674_013_699_000;
    assert_eq!(reading.stamp, Some(Stamp { ns, clock: StampClock::Gps }));
    assert_eq!(reading.status_word, Some(0xea59_fe00));
    let scale = scale_of(41).unwrap();
    let velocity = reading.velocity.unwrap().value;
    let rotation = reading.rotation.unwrap().value;
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{found} {expected}");
    };
    near(velocity[0], 4_508_389.0 * scale.velocity_mps);
    near(velocity[1], 2_706_935.0 * scale.velocity_mps);
    near(velocity[2], 329_308_016.0 * scale.velocity_mps);
    near(rotation[0], -1_000_837.0 * scale.rotation_rad);
    near(rotation[1], -417_138.0 * scale.rotation_rad);
    near(rotation[2], 196_192.0 * scale.rotation_rad);
    // Documented units: (0.008/65536)/125 °, (0.200/65536)·(9.80665/1000)/125 m/s. The unit was at
    // rest: gravity, and a MEMS gyro's bias of some hundredths of a degree a second.
    let g = velocity.iter().map(|v| (v * 125.0).powi(2)).sum::<f64>().sqrt();
    assert!((g - 9.8).abs() < 0.07, "{g}");
    let rate = rotation.map(|increment| (increment * 125.0).to_degrees());
    assert!(rate.iter().all(|rate| rate.abs() < 0.2), "{rate:?}");
    // The CRC of the line is correct as printed; a changed line fails.
    let mut other = line.to_vec();
    other[60] = b'1';
    let mut decoder = AnyDecoder::new(Protocol::NovAtel);
    assert!(readings(&events(&mut decoder, &other)).is_empty());
}

/// ASCII example of the receiver's documentation (OEM7, log RAWIMUX), with the long header, and the same log as
/// a binary one, of which the header is written by hand from its table.
#[test]
fn novatel_logs_with_the_long_header() {
    let line =
        b"#RAWIMUXA,USB1,0,64.5,FINESTEERING,2209,491740.110,02000020,0dc5,16809;04,41,2209,\
        491740.109817,ea57fe00,329394068,-2396829,4481425,321199,257329,-936077*cf9c035d\r\n";
    let reading = only(Protocol::NovAtel, line);
    let ns = 2209 * 604_800_000_000_000 + 491_740_109_817_000;
    assert_eq!(reading.stamp, Some(Stamp { ns, clock: StampClock::Gps }));
    assert_eq!(reading.status_word, Some(0xea57_fe00));
    let rotation = reading.rotation.unwrap().value;
    let scale = scale_of(41).unwrap();
    assert_eq!(rotation, [-936_077.0, -257_329.0, 321_199.0].map(|c| c * scale.rotation_rad));

    // Header length 28, message 1461, port USB1, 40 bytes of data, week and milliseconds.
    let mut long = unhex(
        "AA 44 12 1C B5 05 00 A0 28 00 00 00 81 B4 A1 08 0E 6A 4F 1D 20 00 00 02 C5 0D A9 41",
    );
    let mut data = vec![4, 41];
    data.extend(2209_u16.to_le_bytes());
    data.extend(491_740.109_817_f64.to_le_bytes());
    data.extend(0xea57_fe00_u32.to_le_bytes());
    for count in [329_394_068_i32, -2_396_829, 4_481_425, 321_199, 257_329, -936_077] {
        data.extend(count.to_le_bytes());
    }
    long.extend(&data);
    let crc = octant_instruments::checksum::novatel(&long);
    long.extend(crc.to_le_bytes());
    assert_eq!(only(Protocol::NovAtel, &long), reading);

    // A log of 72 bytes that is none of the unit's passes, and one too long for the decoder costs its own bytes
    // alone.
    let other = |bytes: u16| {
        let mut log = unhex(
            "AA 44 12 1C 2A 00 00 A0 00 00 00 00 81 B4 A1 08 0E 6A 4F 1D 20 00 00 02 C5 0D A9 41",
        );
        log[8..10].copy_from_slice(&bytes.to_le_bytes());
        log.extend(vec![7; usize::from(bytes)]);
        let crc = octant_instruments::checksum::novatel(&log);
        log.extend(crc.to_le_bytes());
        log
    };
    let stream = [other(72), long.clone(), other(2000), long].concat();
    let mut decoder = AnyDecoder::new(Protocol::NovAtel);
    assert_eq!(readings(&events(&mut decoder, &stream)).len(), 2);
    let counters = decoder.counters();
    assert_eq!((counters.other, counters.bytes_lost), (1, 2032));
}

/// Recording of an MTi at 400 Hz with increments, published with a third-party decoder together with
/// the values that the maker's software shows.
#[test]
fn xsens_increments_of_a_recorded_unit() {
    let bytes = unhex(
        "FA FF 36 53 10 20 02 89 90 10 60 04 00 26 C7 33 40 20 0C 3D 0A 5D 4A BD 28 44 1C 41 1D \
         09 AF 40 10 0C 38 B0 80 00 B8 D7 28 00 3C C9 02 28 80 20 0C BA E5 4C 02 BB 9A 3F 83 BA \
         D8 04 03 80 30 10 3F 80 00 01 B6 12 C0 01 B6 C5 70 00 B6 0A 40 00 E0 20 04 00 00 00 05 \
         F4",
    );
    let reading = only(Protocol::Xsens, &bytes);
    assert_eq!(reading.sequence, Some(35216));
    assert_eq!(reading.stamp, Some(Stamp { ns: 254_136_300_000, clock: StampClock::Startup }));
    assert_eq!((reading.status_word, reading.status), (Some(5), Status::empty()));
    let velocity = reading.velocity.unwrap();
    let expected = [8.416175842285156e-05, -0.00010259449481964111, 0.024537160992622375];
    assert_eq!((velocity.kind, velocity.value), (ReadingKind::Increment, expected));
    // Twice the vector part over the scalar, 1 + 2⁻²³: the next term is smaller by 1e-11.
    let rotation = reading.rotation.unwrap();
    let q = [-2.186745632570819e-06, -5.884096026420593e-06, -2.0600855350494385e-06];
    for (axis, q) in q.into_iter().enumerate() {
        let expected = 2.0 * q / 1.0000001192092896;
        assert!((rotation.value[axis] - expected).abs() < 1e-10 * q.abs(), "{axis}");
    }
    // The frame also has acceleration and rate of turn: times 1/400 s they equal the increments.
    let acceleration = [0.03378037363290787, -0.04108057916164398, 9.814864158630371];
    let rate = [-0.0017493965569883585, -0.0047072782181203365, -0.0016480687772855163];
    for axis in 0..3 {
        assert!((velocity.value[axis] - acceleration[axis] / 400.0).abs() < 1e-6);
        assert!((rotation.value[axis] - rate[axis] / 400.0).abs() < 1e-8);
    }
}

/// A recorded frame with quaternion, time, status and counter only, and the smallest frame, which the
/// maker's protocol document shows for other messages.
#[test]
fn xsens_frames_without_a_reading() {
    let recorded = unhex(
        "FA FF 36 26 20 10 10 3E FC 23 42 3F 00 E0 28 BF 01 8F A7 3E FE EE B1 10 60 04 00 0A F8 4C \
         E0 20 04 00 00 00 02 10 20 02 1B C5 D4",
    );
    for bytes in [recorded, unhex("FA FF 36 00 CB")] {
        let mut decoder = AnyDecoder::new(Protocol::Xsens);
        assert!(events(&mut decoder, &bytes).is_empty());
        assert!(decoder.counters().is_clean() && decoder.counters().other == 1);
    }
}

/// A recorded frame with rate and acceleration only: means.
#[test]
fn xsens_means_of_a_recorded_unit() {
    let bytes = unhex(
        "FA FF 36 31 10 20 02 DF C5 10 60 04 00 45 9D A0 40 20 0C BE DC 9A FA 3F 54 9F 37 41 1C BB \
         70 80 20 0C BB AA 5C 80 3B 8C 55 01 BB 81 33 00 E0 20 04 00 00 00 81 45",
    );
    let reading = only(Protocol::Xsens, &bytes);
    assert_eq!(reading.sequence, Some(0xDFC5));
    assert_eq!(reading.stamp.unwrap().ns, 0x0045_9DA0 * 100_000);
    let (velocity, rotation) = (reading.velocity.unwrap(), reading.rotation.unwrap());
    assert_eq!((velocity.kind, rotation.kind), (ReadingKind::Mean, ReadingKind::Mean));
    assert_eq!(velocity.value[2], f64::from(f32::from_bits(0x411C_BB70)));
    assert_eq!(rotation.value[0], f64::from(f32::from_bits(0xBBAA_5C80)));
}

/// SBG publishes the layout of its frames (sbgECom, "Binary Protocol") without an example. This frame
/// is written by hand from the table of `SBG_ECOM_LOG_IMU_SHORT`, with its CRC computed bit by bit from
/// the documented polynomial.
#[test]
fn sbg_frame_after_the_table() {
    let mut bare = unhex("2C 00 20 00");
    bare.extend(4_000_000_000u32.to_le_bytes());
    bare.extend(0x03FFu16.to_le_bytes());
    for count in [1_048_576, 0, -10_283_008] {
        bare.extend(i32::to_le_bytes(count));
    }
    for count in [67_108_864, -1, 0] {
        bare.extend(i32::to_le_bytes(count));
    }
    bare.extend(i16::to_le_bytes(-640));
    let crc = bare.iter().fold(0u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte), |crc, _| {
            if crc & 1 == 1 { (crc >> 1) ^ 0x8408 } else { crc >> 1 }
        })
    });
    let mut frame = unhex("FF 5A");
    frame.extend(&bare);
    frame.extend(crc.to_le_bytes());
    frame.push(0x33);
    let reading = only(Protocol::Sbg, &frame);
    assert_eq!(reading.stamp.unwrap(), Stamp { ns: 4_000_000_000_000, clock: StampClock::Startup });
    assert_eq!((reading.status, reading.status_word), (Status::empty(), Some(0x3FF)));
    assert_eq!(reading.temperature_c, Some(-2.5));
    let (velocity, rotation) = (reading.velocity.unwrap(), reading.rotation.unwrap());
    assert_eq!((velocity.kind, rotation.kind), (ReadingKind::Mean, ReadingKind::Mean));
    assert_eq!(velocity.value, [1.0, 0.0, -10_283_008.0 / 1_048_576.0]);
    assert_eq!(rotation.value, [1.0, -1.0 / 67_108_864.0, 0.0]);
}

/// A frame of an MTi with packet counter and another packet.
fn xsens_frame(counter: u16, packet: &[u8]) -> Vec<u8> {
    let mut frame = unhex("FA FF 36");
    frame.push((5 + packet.len()) as u8);
    frame.extend([0x10, 0x20, 2]);
    frame.extend(counter.to_be_bytes());
    frame.extend(packet);
    let sum = frame[1..].iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
    frame.push(sum.wrapping_neg());
    frame
}

/// Rate and acceleration, as in the recorded frame above.
fn xsens_means() -> Vec<u8> {
    unhex(
        "40 20 0C BE DC 9A FA 3F 54 9F 37 41 1C BB 70 80 20 0C BB AA 5C 80 3B 8C 55 01 BB 81 33 00",
    )
}

/// `GnssPvtData`, 94 bytes by the maker's protocol document.
fn xsens_satellites() -> Vec<u8> {
    let mut packet = unhex("70 10 5E");
    packet.resize(3 + 94, 0x11);
    packet
}

/// Numbers of the readings of a unit that sends these frames, and how many were missing and behind.
fn xsens_numbers(frames: impl IntoIterator<Item = (u16, bool)>) -> (Vec<u64>, u64, u64) {
    let mut decoder = AnyDecoder::new(Protocol::Xsens);
    let mut bytes = Vec::new();
    for (counter, satellites) in frames {
        let packet = if satellites { xsens_satellites() } else { xsens_means() };
        bytes.extend(xsens_frame(counter, &packet));
    }
    let found = readings(&events(&mut decoder, &bytes));
    let counters = decoder.counters();
    assert_eq!(counters.bytes_framed, bytes.len() as u64);
    let numbers = found.iter().map(|reading| reading.sequence.unwrap()).collect();
    (numbers, counters.missing, counters.behind)
}

/// The counter counts frames with satellite data too: every fifth one here, across the counter's end.
#[test]
fn xsens_readings_are_numbered_without_frames_of_satellite_data() {
    let frames = (65_500..65_600u64).map(|count| (count as u16, count % 5 == 3));
    let numbers = xsens_numbers(frames);
    assert_eq!(numbers, ((65_500..65_580).collect(), 0, 0));
    // A satellite frame may repeat the counter of the reading that it belongs to.
    let frames = [(7, false), (7, true), (8, false), (8, true), (9, false)];
    assert_eq!(xsens_numbers(frames), (vec![7, 8, 9], 0, 0));
}

#[test]
fn xsens_lost_frames_are_gaps_beside_satellite_data_too() {
    // Of 10 to 19, satellites in 12 and 16: 14 is lost, then 17 to 18.
    let sent = [10, 11, 12, 13, 15, 16, 19].map(|count| (count, count == 12 || count == 16));
    assert_eq!(xsens_numbers(sent), (vec![10, 11, 12, 14, 17], 3, 0));
    // Two lost before a satellite frame are two, not three.
    assert_eq!(xsens_numbers([(1, false), (4, true), (5, false)]), (vec![1, 4], 2, 0));
}

#[test]
fn xsens_unit_switched_on_anew_goes_back() {
    let mut frames: Vec<_> = (0..60).map(|count| (count, count % 2 == 1)).collect();
    frames.extend((0..6).map(|count| (count, false)));
    let expected = (0..30).chain(0..6).collect();
    assert_eq!(xsens_numbers(frames), (expected, 0, 1));
}
