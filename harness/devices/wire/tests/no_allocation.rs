//! Encoding and decoding allocate nothing, also for damaged input.
#![allow(unsafe_code, reason = "an allocator that counts is unsafe by its trait")]

use crate::common::arbitrary::one_of_each;
use octant_wire::can::{self, CanVersion, Reassembler};
use octant_wire::message::{ClockTime, EndRole};
use octant_wire::serial::{SerialDecoder, SerialEncoder};
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
    let messages = one_of_each();
    let garbage = [0xA5; 1000];
    let before = COUNT.with(Cell::get);
    let (mut encoder, mut decoder) = (SerialEncoder::new(), SerialDecoder::new());
    for round in 0..20u64 {
        for message in &messages {
            let frame = encoder.encode(message, ClockTime::from_ns(round));
            let mut bytes = frame;
            while let Some(event) = decoder.next(&mut bytes) {
                black_box(&event);
            }
            for length in [1, 300, 1000] {
                let mut bytes = &garbage[..length];
                black_box(decoder.next(&mut bytes));
            }
            black_box(decoder.end());
            for (sender, format) in EndRole::ALL
                .into_iter()
                .flat_map(|r| [(r, CanVersion::Classic), (r, CanVersion::Fd)])
            {
                let mut reassembler = Reassembler::new(&EndRole::ALL, format);
                for (i, frame) in
                    can::segments(message, sender, format).into_iter().flatten().enumerate()
                {
                    // Each round loses another segment.
                    if i as u64 != round {
                        black_box(reassembler.receive(&frame));
                    }
                }
            }
        }
    }
    assert_eq!(COUNT.with(Cell::get) - before, 0);
    assert!(decoder.counters().frames > 200 && decoder.counters().damaged() > 200);
    // The counter does notice an allocation.
    black_box(vec![0u8; 10]);
    assert!(COUNT.with(Cell::get) > before);
}
