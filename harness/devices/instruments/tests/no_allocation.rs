//! Decoding, encoding and sampling allocate nothing, also for damaged input.
#![allow(unsafe_code, reason = "an allocator that counts is unsafe by its trait")]

use crate::common;
use octant_instruments::{
    AnyDecoder, AnyEncoder, Axes, FramingEvent, Protocol, Sampler, SamplerSettings,
};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`, which is the same here.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `alloc` above, which is the system's.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn nothing_is_allocated() {
    let before = COUNT.with(Cell::get);
    let mut samples = 0;
    for protocol in Protocol::ALL {
        let (mut encoder, mut decoder) = (AnyEncoder::new(protocol), AnyDecoder::new(protocol));
        let mut sampler = Sampler::new(SamplerSettings { axes: Axes::SAME, rate_hz: 200.0 });
        for number in 1..=200 {
            let frame = encoder.encode(&common::reading(number)).unwrap();
            // Each tenth frame is cut in two, each seventh has garbage before it.
            if number % 7 == 0 {
                black_box(decoder.next(&mut &[0xFF, 0x5A, 0xFA, 0xAA, 0x44, 0][..]));
            }
            let (head, tail) = frame.split_at(if number % 10 == 0 { 9 } else { 0 });
            for mut piece in [head, tail] {
                while let Some(event) = decoder.next(&mut piece) {
                    if let FramingEvent::Reading(reading) = event {
                        samples += u64::from(sampler.sample(&reading, None).is_ok());
                    }
                }
            }
        }
        if let AnyEncoder::NovAtel(encoder) = &mut encoder {
            black_box(encoder.encode_line(&common::reading(201)).unwrap());
        }
        while let Some(event) = decoder.end() {
            black_box(event);
        }
    }
    assert_eq!(COUNT.with(Cell::get) - before, 0);
    assert_eq!(samples, Protocol::ALL.len() as u64 * 200);
    // The counter does notice an allocation.
    black_box(vec![0u8; 10]);
    assert!(COUNT.with(Cell::get) > before);
}

#[cfg(feature = "descriptions")]
#[test]
fn a_described_decoder_allocates_nothing() {
    use octant_instruments::description::UnitDescription;
    let mut decoder = UnitDescription::ready("kvh-1775-rate").unwrap().unwrap().decoder();
    // A frame of a KVH 1750, as in the test of its description, cut in two, with a damaged one before it.
    let frame = common::unhex(
        "FE81FF55 37A96A6E 38586C1F B75BF862 BF803E78 BB650D28 3B0A37AC 77 3D 0028 4BFA34D8",
    );
    let mut damaged = frame.clone();
    damaged[9] ^= 1;
    let before = COUNT.with(Cell::get);
    let mut readings = 0;
    for _ in 0..100 {
        for mut piece in [&damaged[..], &frame[..11], &frame[11..]] {
            while let Some(event) = decoder.next(&mut piece) {
                readings += u64::from(matches!(event, FramingEvent::Reading(_)));
            }
        }
    }
    assert_eq!((COUNT.with(Cell::get) - before, readings), (0, 100));
    let ready = UnitDescription::ready("vectornav-imu-ascii").unwrap().unwrap();
    let mut decoder = ready.port_decoder().unwrap();
    let line: &[u8] = b"$VNIMU,-00.0350,+00.4222,-00.6643,-00.015,+00.019,+09.948,+00.002066,-00.008442,-00.044656,+20.7,+084.322*66\r\n";
    let before = COUNT.with(Cell::get);
    let mut readings = 0;
    for _ in 0..100 {
        for mut piece in [&line[..50], &line[50..], &line[..20], b"\n"] {
            while let Some(event) = decoder.next(&mut piece) {
                readings += u64::from(matches!(event, FramingEvent::Reading(_)));
            }
        }
    }
    assert_eq!((COUNT.with(Cell::get) - before, readings), (0, 100));
}
