//! Counts the allocations of one thread while it is watched, so that tests beside it don't count.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    /// Number of allocations of this thread while it is watched.
    static COUNTED: Cell<Option<u64>> = const { Cell::new(None) };
}

/// Starts to count the allocations of this thread.
pub fn watch() {
    COUNTED.set(Some(0));
}

/// Stops, and returns the count since [`watch`]; `None` if this thread wasn't watched.
pub fn watched() -> Option<u64> {
    COUNTED.replace(None)
}

struct Counting;

#[allow(unsafe_code, reason = "an allocator can't be written without")]
// SAFETY: every call is passed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // A thread that ends has no cell any more, and isn't watched.
        let _ = COUNTED.try_with(|counted| counted.set(counted.get().map(|n| n + 1)));
        // SAFETY: the caller's guarantees are those that the system's allocator requires.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        let _ = COUNTED.try_with(|counted| counted.set(counted.get().map(|n| n + 1)));
        // SAFETY: the pointer came from `alloc`, which is the system's.
        unsafe { System.dealloc(pointer, layout) }
    }
}

// One allocator for the whole test program.
#[global_allocator]
static ALLOCATOR: Counting = Counting;
