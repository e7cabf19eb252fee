//! Shared parts of the tests.

use octant_instruments::{
    AnyDecoder, AnyEncoder, FramingEvent, MeasuredTriad, Protocol, Reading, Stamp, StampClock,
};

/// Parses hexadecimal digits.
pub(crate) fn unhex(text: &str) -> Vec<u8> {
    let digits: String = text.split_whitespace().collect();
    (0..digits.len())
        .step_by(2)
        .map(|i| u8::from_str_radix(&digits[i..i + 2], 16).unwrap())
        .collect()
}

/// Decodes bytes into all of their events.
pub(crate) fn events(decoder: &mut AnyDecoder, mut bytes: &[u8]) -> Vec<FramingEvent> {
    let mut events = Vec::new();
    while let Some(event) = decoder.next(&mut bytes) {
        events.push(event);
    }
    events
}

/// Extracts the readings from events.
pub(crate) fn readings(events: &[FramingEvent]) -> Vec<Reading> {
    let reading = |event: &FramingEvent| match event {
        FramingEvent::Reading(reading) => Some(*reading),
        FramingEvent::Lost(_) => None,
    };
    events.iter().filter_map(reading).collect()
}

/// Decodes bytes that hold exactly one reading.
pub(crate) fn only(protocol: Protocol, bytes: &[u8]) -> Reading {
    let mut decoder = AnyDecoder::new(protocol);
    let found = readings(&events(&mut decoder, bytes));
    assert!(decoder.counters().is_clean(), "{:?}", decoder.counters());
    assert_eq!(decoder.counters().bytes_framed, bytes.len() as u64);
    assert_eq!(found.len(), 1);
    found[0]
}

/// Reading of a unit that turns and shakes; every protocol can carry it.
pub(crate) fn reading(number: u64) -> Reading {
    let k = number as f64;
    Reading {
        rotation: Some(MeasuredTriad::increment([1e-3 * (0.1 * k).sin(), -2e-6 * k, 3.6e-7])),
        velocity: Some(MeasuredTriad::increment([1e-3 * (0.3 * k).cos(), 2e-5, -0.049 + 1e-7 * k])),
        interval_s: Some(0.005),
        stamp: Some(Stamp { ns: number * 5_000_000, clock: StampClock::Startup }),
        sequence: Some(number),
        temperature_c: Some(25.0 + number as f32 / 256.0),
        ..Reading::NOTHING
    }
}

/// Frames of readings 1 to `count`.
pub(crate) fn frames(protocol: Protocol, count: u64) -> Vec<Vec<u8>> {
    let mut encoder = AnyEncoder::new(protocol);
    (1..=count).map(|number| encoder.encode(&reading(number)).unwrap().to_vec()).collect()
}

/// Lines of readings 1 to `count`.
pub(crate) fn lines(count: u64) -> Vec<Vec<u8>> {
    let AnyEncoder::NovAtel(mut encoder) = AnyEncoder::new(Protocol::NovAtel) else {
        unreachable!()
    };
    (1..=count).map(|number| encoder.encode_line(&reading(number)).unwrap().to_vec()).collect()
}

/// Streams of every protocol, and of lines.
pub(crate) fn streams(count: u64) -> Vec<(Protocol, Vec<Vec<u8>>)> {
    let mut all: Vec<_> = Protocol::ALL.map(|one| (one, frames(one, count))).into();
    all.push((Protocol::NovAtel, lines(count)));
    all
}
