//! A step allocates nothing, neither in lock-step nor in real time, also when nothing arrives.
#![allow(unsafe_code, reason = "an allocator that counts is unsafe by its trait")]

use crate::common::{Served, facts, harness, options, sample};
use octant_link::Wire;
use octant_link::harness::{Harness, Sending, SessionOptions};
use octant_sample::Output;
use octant_wire::message::{EndRole, StepPacing};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::time::Duration;

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
fn a_step_allocates_nothing() {
    for uri in ["pty:", "udp:0"] {
        let (_served, uri) = Served::on(uri, facts());
        let mut harness = harness(&uri);
        let mut output = Output::default();
        let before = COUNT.with(Cell::get);
        for k in 1..=500 {
            let (sample, aiding) = sample(k);
            harness.step(&sample, aiding.as_ref(), &mut output).unwrap();
        }
        assert_eq!(COUNT.with(Cell::get), before, "{uri}");
    }
}

#[test]
fn sending_and_polling_allocate_nothing() {
    for uri in ["pty:", "udp:0"] {
        let (_served, uri) = Served::on(uri, facts());
        let options = SessionOptions { pacing: StepPacing::RealTime, ..options() };
        let mut harness =
            Harness::open(Wire::open(&uri, EndRole::Harness).unwrap(), options).unwrap();
        let before = COUNT.with(Cell::get);
        let (mut k, mut nothing) = (1, 0);
        while k <= 300 || nothing < 100 {
            let (sample, aiding) = sample(k);
            if k <= 300
                && !matches!(
                    harness.send_sample(&sample, aiding.as_ref()).unwrap(),
                    Sending::WindowFull
                )
            {
                k += 1;
                // One request in ten steps: a flood of them would leave a busy device no room for
                // samples.
                if k % 10 == 0 {
                    harness.request_time().unwrap();
                }
            }
            harness.keep_alive().unwrap();
            nothing += u32::from(harness.poll(Duration::ZERO).unwrap().is_none());
        }
        assert_eq!(COUNT.with(Cell::get), before, "{uri}");
    }
}
