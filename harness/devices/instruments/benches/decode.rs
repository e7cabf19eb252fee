//! Decoding speed of streams of the protocols, in bytes of the line.
#![allow(missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use octant_instruments::{
    AnyDecoder, AnyEncoder, FramingEvent, MeasuredTriad, Protocol, Reading, Stamp, StampClock,
};
use std::hint::black_box;

const READINGS: u64 = 2000;

/// Reading of a unit at rest on its back, at 200 Hz.
fn reading(number: u64) -> Reading {
    let k = number as f64;
    Reading {
        rotation: Some(MeasuredTriad::increment([3.6e-7 + 1e-9 * k, -1e-9 * k, 2e-9])),
        velocity: Some(MeasuredTriad::increment([1e-6, -2e-9 * k, -0.049_033])),
        interval_s: Some(0.005),
        stamp: Some(Stamp { ns: number * 5_000_000, clock: StampClock::Startup }),
        sequence: Some(number),
        temperature_c: Some(31.5),
        ..Reading::NOTHING
    }
}

fn stream(mut encode: impl FnMut(&Reading) -> Vec<u8>) -> Vec<u8> {
    (1..=READINGS).flat_map(|number| encode(&reading(number))).collect()
}

fn decode(c: &mut Criterion) {
    let mut group = c.benchmark_group("decode");
    let mut streams = Vec::new();
    for protocol in Protocol::ALL {
        let mut encoder = AnyEncoder::new(protocol);
        let bytes =
            stream(|reading| encoder.encode(reading).map(<[u8]>::to_vec).unwrap_or_default());
        streams.push((protocol.name().to_owned(), protocol, bytes));
    }
    if let AnyEncoder::NovAtel(mut encoder) = AnyEncoder::new(Protocol::NovAtel) {
        let bytes =
            stream(|reading| encoder.encode_line(reading).map(<[u8]>::to_vec).unwrap_or_default());
        streams.push(("novatel, as text".to_owned(), Protocol::NovAtel, bytes));
    }
    for (name, protocol, bytes) in streams {
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        // Pieces as a port delivers them.
        for piece in [64, 4096] {
            group.bench_function(format!("{name}, {piece} bytes at a time"), |b| {
                b.iter(|| {
                    let mut decoder = AnyDecoder::new(protocol);
                    for mut piece in bytes.chunks(piece) {
                        while let Some(event) = decoder.next(&mut piece) {
                            assert!(matches!(event, FramingEvent::Reading(_)));
                            black_box(&event);
                        }
                    }
                    assert_eq!(decoder.counters().readings, READINGS);
                });
            });
        }
        let garbage = vec![0xA5; 1 << 16];
        group.throughput(Throughput::Bytes(garbage.len() as u64));
        group.bench_function(format!("{name}, garbage"), |b| {
            b.iter(|| {
                let mut decoder = AnyDecoder::new(protocol);
                let mut rest = &garbage[..];
                while let Some(event) = decoder.next(&mut rest) {
                    black_box(&event);
                }
                decoder.counters().bytes_lost
            });
        });
    }
    group.finish();
}

criterion_group!(benches, decode);
criterion_main!(benches);
