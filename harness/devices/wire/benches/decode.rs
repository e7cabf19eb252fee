//! Decoding speed of a stream of samples and outputs, in bytes of the line.
#![allow(missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use octant_sample::{DeviceTime, GimbalAngles, GimbalCommand, Navigation, Output, Sample};
use octant_wire::Message;
use octant_wire::can::{self, BusFrame, CanVersion, Reassembler};
use octant_wire::message::{ClockTime, EndRole, OutputMessage, SampleMessage, StepNumber};
use octant_wire::serial::{DecodeEvent, SerialDecoder, SerialEncoder};
use std::hint::black_box;

/// Number of steps in the stream, at 200 Hz.
const STEPS: u16 = 2000;

/// Sample as of an instrument at rest: mostly zeros and small counts, as is usual.
fn sample(step: u16) -> Message {
    let k = i32::from(step);
    let sample = Sample {
        sequence: u64::from(step),
        device_time: DeviceTime { ns: u64::from(step) * 5_000_000 },
        delta_theta: [17_000 + k % 7, -k % 5, 3 * k % 11],
        delta_velocity: [k % 13, 40 - k % 80, -52_600_000 + k % 97],
        gimbal: GimbalAngles { azimuth: 210_828_714, roll: k % 300 },
        ..Sample::default()
    };
    Message::Sample(SampleMessage { step: StepNumber::new(step), aided: false, sample })
}

fn output(step: u16) -> Message {
    let x = f64::from(step) * 1e-6;
    let output = Output {
        sequence: u64::from(step),
        device_time: DeviceTime { ns: u64::from(step) * 5_000_000 },
        gimbal_command: GimbalCommand { target: GimbalAngles { azimuth: 210_828_714, roll: 0 } },
        navigation: Navigation {
            latitude_rad: 0.532 + x,
            longitude_rad: 1.99 - x,
            height_m: 12.0 + x,
            velocity_mps: [x, -x, x * x],
            q_nb: [0.7 + x, 0.1, 0.2 - x, 0.6],
        },
        nis: f64::NAN,
        ..Output::default()
    };
    let step = StepNumber::new(step);
    Message::Output(OutputMessage { step, parameters_follow: false, output, computing_ns: 900 })
}

fn serial(c: &mut Criterion) {
    let mut group = c.benchmark_group("serial");
    for (name, message) in [("samples", sample as fn(u16) -> Message), ("outputs", output)] {
        let mut encoder = SerialEncoder::new();
        let mut bytes = Vec::new();
        for step in 0..STEPS {
            bytes.extend(encoder.encode(&message(step), ClockTime::from_ns(u64::from(step) << 22)));
        }
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        // Pieces as a port delivers them.
        for piece in [64, 4096] {
            group.bench_function(format!("decode {name}, {piece} bytes at a time"), |b| {
                b.iter(|| {
                    let mut decoder = SerialDecoder::new();
                    for mut piece in bytes.chunks(piece) {
                        while let Some(event) = decoder.next(&mut piece) {
                            assert!(matches!(event, DecodeEvent::Received(_)));
                            black_box(&event);
                        }
                    }
                    assert_eq!(decoder.counters().frames, u64::from(STEPS));
                });
            });
        }
        let messages: Vec<_> = (0..STEPS).map(message).collect();
        group.bench_function(format!("encode {name}"), |b| {
            b.iter(|| {
                let mut encoder = SerialEncoder::new();
                for message in &messages {
                    black_box(encoder.encode(message, ClockTime::from_ns(1)));
                }
            });
        });
    }
    // Bytes without any zero, and nothing but zeros.
    for (name, byte) in [("garbage without zeros", 0xA5), ("zeros", 0)] {
        let bytes = vec![byte; 1 << 18];
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(format!("decode {name}"), |b| {
            b.iter(|| {
                let mut decoder = SerialDecoder::new();
                let mut rest = &bytes[..];
                while let Some(event) = decoder.next(&mut rest) {
                    black_box(&event);
                }
                decoder.counters().bytes_lost
            });
        });
    }
    group.finish();
}

fn can_bus(c: &mut Criterion) {
    let mut group = c.benchmark_group("can");
    for (name, message, sender) in [
        ("samples", sample as fn(u16) -> Message, EndRole::Harness),
        ("outputs", output, EndRole::Device),
    ] {
        for format in [CanVersion::Classic, CanVersion::Fd] {
            let frames: Vec<BusFrame> = (0..STEPS)
                .flat_map(|step| {
                    can::segments(&message(step), sender, format).into_iter().flatten()
                })
                .collect();
            let bytes: usize = frames.iter().map(|frame| frame.data().len()).sum();
            group.throughput(Throughput::Bytes(bytes as u64));
            group.bench_function(format!("reassemble {name}, {format:?}"), |b| {
                b.iter(|| {
                    let mut reassembler = Reassembler::new(&[sender], format);
                    for frame in &frames {
                        black_box(reassembler.receive(frame));
                    }
                    assert_eq!(reassembler.counters().messages, u64::from(STEPS));
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, serial, can_bus);
criterion_main!(benches);
