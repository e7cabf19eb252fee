//! A reading survives encoding and decoding, however the bytes are cut.

use crate::common::{self, events, readings, streams};
use octant_instruments::{
    AnyDecoder, AnyEncoder, FramingEvent, MeasuredTriad, Protocol, Reading, ReadingKind, Stamp,
    StampClock,
};
use octant_sample::Status;
use proptest::prelude::*;

fn any_reading() -> impl Strategy<Value = Reading> {
    let three = |most: f64| proptest::array::uniform3(-most..most);
    (three(0.031), three(0.5), any::<bool>(), any::<bool>(), -40.0f32..80.0).prop_map(
        |(rotation, velocity, gyro, accelerometer, temperature_c)| {
            let mut status = Status::empty();
            status.set(Status::GYRO_SATURATED, gyro);
            status.set(Status::ACCELEROMETER_SATURATED, accelerometer);
            Reading {
                rotation: Some(MeasuredTriad::increment(rotation)),
                velocity: Some(MeasuredTriad::increment(velocity)),
                interval_s: Some(0.005),
                status,
                temperature_c: Some(temperature_c),
                ..Reading::NOTHING
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_protocol_says_what_it_was_told(
        told in proptest::collection::vec(any_reading(), 1..60),
        start in 0u64..(1 << 40),
    ) {
        for protocol in Protocol::ALL {
            let (mut encoder, mut decoder) = (AnyEncoder::new(protocol), AnyDecoder::new(protocol));
            let [rotation, velocity] = protocol.facts().resolution;
            let mut sums = [[0.0; 3]; 2];
            let mut first = None;
            for (number, told) in told.iter().enumerate() {
                let number = number as u64;
                // Times on a grid that all protocols can represent.
                let ns = (start + number) * 5_000_000;
                let stamp = Some(Stamp { ns, clock: StampClock::Startup });
                let told = Reading { sequence: Some(start + number), stamp, ..*told };
                let said = events(&mut decoder, encoder.encode(&told).unwrap());
                prop_assert_eq!(said.len(), 1);
                let FramingEvent::Reading(said) = said[0] else { panic!("{said:?}") };
                for (which, told, said, limit) in [
                    (0, told.rotation, said.rotation, rotation),
                    (1, told.velocity, said.velocity, velocity),
                ] {
                    let (told, said) = (told.unwrap().value, said.unwrap().over(0.005));
                    for axis in 0..3 {
                        let off = said[axis] - told[axis];
                        prop_assert!(off.abs() <= limit, "{protocol:?} {off}");
                        sums[which][axis] += off;
                        // The sum follows: the resolution loses nothing.
                        prop_assert!(sums[which][axis].abs() <= limit, "{protocol:?} {sums:?}");
                    }
                }
                // Time and number continue from any start.
                let stamp = said.stamp.unwrap();
                let (number_first, ns_first) = *first.get_or_insert((said.sequence, stamp.ns));
                prop_assert_eq!(stamp.ns - ns_first, number * 5_000_000);
                if let (Some(said), Some(first)) = (said.sequence, number_first) {
                    prop_assert_eq!(said - first, number);
                }
                if protocol != Protocol::NovAtel {
                    prop_assert_eq!(said.status - Status::GIMBAL_INVALID, told.status);
                }
                if let (Some(said), Some(told)) = (said.temperature_c, told.temperature_c) {
                    prop_assert!((said - told).abs() <= 0.5 / 256.0 + 1e-6);
                }
            }
            prop_assert!(decoder.counters().is_clean(), "{:?}", decoder.counters());
        }
    }

    #[test]
    fn the_cuts_make_no_difference(
        cuts in proptest::collection::vec(1usize..90, 1..40),
        garbage in proptest::collection::vec(any::<u8>(), 0..300),
    ) {
        for (protocol, frames) in streams(20) {
            let mut bytes = Vec::new();
            for (number, frame) in frames.iter().enumerate() {
                if number == 7 {
                    bytes.extend(&garbage);
                }
                bytes.extend(frame);
            }
            let (mut whole, mut cut) = (AnyDecoder::new(protocol), AnyDecoder::new(protocol));
            let in_one = events(&mut whole, &bytes);
            let mut in_pieces = Vec::new();
            let (mut rest, mut next) = (&bytes[..], cuts.iter().cycle());
            while !rest.is_empty() {
                let (piece, tail) = rest.split_at((*next.next().unwrap()).min(rest.len()));
                in_pieces.extend(events(&mut cut, piece));
                rest = tail;
            }
            prop_assert_eq!(format!("{in_one:?}"), format!("{in_pieces:?}"));
            prop_assert_eq!(whole.counters(), cut.counters());
            prop_assert_eq!(whole.counters().bytes, bytes.len() as u64);
        }
    }
}

#[test]
fn what_a_protocol_has_to_say_is_demanded() {
    let all = common::reading(1);
    for protocol in Protocol::ALL {
        for lacking in [
            Reading { rotation: None, ..all },
            Reading { velocity: None, ..all },
            Reading { stamp: None, ..all },
        ] {
            let mut encoder = AnyEncoder::new(protocol);
            let error = encoder.encode(&lacking).unwrap_err().to_string();
            assert!(error.to_lowercase().contains(protocol.name()), "{error}");
        }
    }
    let error =
        AnyEncoder::new(Protocol::Xsens).encode(&Reading { sequence: None, ..all }).unwrap_err();
    assert_eq!(error.to_string(), "a frame of Xsens needs a sequence number");
}

#[test]
fn names_are_those_of_protocols() {
    for protocol in Protocol::ALL {
        assert_eq!(Protocol::of_name(protocol.name()), Some(protocol));
    }
    assert_eq!(Protocol::of_name("nmea"), None);
}

/// Fixed point of both widths and double, as defined in the maker's document.
#[test]
fn xsens_numbers_of_every_precision() {
    let frame = |identifier: u16, numbers: &[&[u8]]| {
        let data: Vec<u8> = numbers.concat();
        let mut frame = vec![0xFA, 0xFF, 0x36, data.len() as u8 + 3];
        frame.extend((identifier).to_be_bytes());
        frame.push(data.len() as u8);
        frame.extend(data);
        let sum = frame[1..].iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
        frame.push(sum.wrapping_neg());
        frame
    };
    let values = [0.25, -1.5, 9.8125];
    let float = values.map(|v| (v as f32).to_be_bytes());
    let double = values.map(f64::to_be_bytes);
    let fixed12 = values.map(|v| ((v * f64::from(1 << 20)) as i32).to_be_bytes());
    let fixed16 = values.map(|v| {
        let all = ((v * (1u64 << 32) as f64) as i64).to_be_bytes();
        // The fraction comes first, then the integer part.
        [all[4], all[5], all[6], all[7], all[2], all[3]]
    });
    let slices = |all: &[[u8; 4]; 3]| all.map(|one| one.to_vec());
    for (precision, numbers) in [
        (0u16, slices(&float)),
        (1, slices(&fixed12)),
        (2, fixed16.map(|one| one.to_vec())),
        (3, double.map(|one| one.to_vec())),
    ] {
        let numbers: Vec<&[u8]> = numbers.iter().map(Vec::as_slice).collect();
        let reading = common::only(Protocol::Xsens, &frame(0x4010 | precision, &numbers));
        let velocity = reading.velocity.unwrap();
        assert_eq!(
            (velocity.kind, velocity.value),
            (ReadingKind::Increment, values),
            "{precision}"
        );
        let reading = common::only(Protocol::Xsens, &frame(0x8020 | precision | 4, &numbers));
        assert_eq!(reading.rotation.unwrap().value, values);
        // A packet whose length isn't that of its kind is no frame.
        let short = frame(0x4010 | precision, &numbers[..2]);
        let mut decoder = AnyDecoder::new(Protocol::Xsens);
        assert!(readings(&events(&mut decoder, &short)).is_empty());
        assert_eq!(decoder.counters().malformed, 1);
    }
}

/// Rotations of up to nearly half a turn, and a quaternion with the other sign.
#[test]
fn xsens_rotations_of_any_size() {
    for angle in [1e-12, 1e-7, 0.3, 3.0] {
        for axis in 0..3 {
            let mut rotation = [0.0; 3];
            rotation[axis] = angle;
            let told = Reading {
                rotation: Some(MeasuredTriad::increment(rotation)),
                ..common::reading(1)
            };
            let mut encoder = AnyEncoder::new(Protocol::Xsens);
            let mut frame = encoder.encode(&told).unwrap().to_vec();
            let said = common::only(Protocol::Xsens, &frame).rotation.unwrap().value;
            assert!((said[axis] - angle).abs() <= 3e-7 * angle, "{angle} {said:?}");
            // −q is the same rotation: flip the sign bits of the four floats.
            let at = frame.windows(3).position(|three| three == [0x80, 0x30, 16]).unwrap() + 3;
            for number in 0..4 {
                frame[at + 4 * number] ^= 0x80;
            }
            let last = frame.len() - 1;
            frame[last] = 0;
            let sum = frame[1..].iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
            frame[last] = sum.wrapping_neg();
            let same = common::only(Protocol::Xsens, &frame).rotation.unwrap().value;
            assert_eq!(same, said);
        }
    }
}

/// Clocks and counters roll over, readings don't.
#[test]
fn counters_roll_over() {
    for (protocol, start) in [(Protocol::Xsens, 65_500), (Protocol::Sbg, 858_993_400)] {
        let (mut encoder, mut decoder) = (AnyEncoder::new(protocol), AnyDecoder::new(protocol));
        let mut last: Option<Reading> = None;
        for number in start..start + 200 {
            let told = common::reading(number);
            let said = readings(&events(&mut decoder, encoder.encode(&told).unwrap()))[0];
            if let Some(last) = last {
                assert_eq!(said.stamp.unwrap().ns - last.stamp.unwrap().ns, 5_000_000);
                assert_eq!(said.sequence, last.sequence.map(|last| last + 1));
            }
            last = Some(said);
        }
        assert!(decoder.counters().is_clean());
    }
}

/// Beyond 1833 °/s, SBG uses another scale.
#[test]
fn sbg_high_range() {
    let told = Reading {
        rotation: Some(MeasuredTriad::mean([50.0, -1.0, 0.0])),
        velocity: Some(MeasuredTriad::mean([0.0, 0.0, -9.8])),
        interval_s: None,
        ..common::reading(1)
    };
    let mut encoder = AnyEncoder::new(Protocol::Sbg);
    let said = common::only(Protocol::Sbg, encoder.encode(&told).unwrap()).rotation.unwrap();
    assert_eq!(said.lsb, Some(1.0 / 12_304_174.0));
    for (said, told) in said.value.into_iter().zip([50.0, -1.0, 0.0]) {
        assert!((said - told).abs() <= 0.5 / 12_304_174.0 + 1e-12, "{said}");
    }
}
