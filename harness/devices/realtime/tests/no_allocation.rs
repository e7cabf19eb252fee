//! The frame clock allocates nothing after its start.

use octant_realtime::clock::now;
use octant_realtime::pace::{FrameClock, FramePacing};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    /// Allocations of this thread: other tests and the test runner have other threads.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

#[allow(unsafe_code, reason = "an allocator can't be written without")]
// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller keeps the contract of the system's allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `alloc`, which is the system's.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Number of allocations of this thread.
pub(crate) fn allocations() -> u64 {
    ALLOCATIONS.get()
}

#[test]
fn frames_allocate_nothing() {
    let pacing = FramePacing { period_ns: 200_000, spin_ns: 20_000, overrun_ns: 50_000 };
    // The first half of the frames is already late, the second is waited for: both paths are tested.
    let start = octant_realtime::clock::MonotonicTime { ns: now().ns - 20 * 200_000 };
    let mut clock = FrameClock::start_at(pacing, start);
    let before = allocations();
    for _ in 0..40 {
        clock.wait();
    }
    assert_eq!(allocations(), before);
    let boxed = Box::new(clock.report());
    assert!(allocations() > before, "the counter counts: {boxed:?}");
}
