//! Ends of the program where the system refuses memory or a thread: a sentence and the status of a broken bench.
//!
//! `std` aborts where memory is refused, and panics where a thread is. Neither can be handled where it happens: nothing can
//! be unwound without memory. What was written stays, as after a kill.
//!
//! For the program alone: a library doesn't end the process that loaded it.

use std::alloc::{GlobalAlloc, Layout, System};

/// Words of a process that the system gave no more memory, by which another one knows it.
pub const OUT_OF_MEMORY: &str = "out of memory";

/// The system's allocator, which ends the program when it has no memory left.
#[derive(Clone, Copy, Debug, Default)]
pub struct Allocator;

impl Allocator {
    #[inline]
    fn given(memory: *mut u8) -> *mut u8 {
        if memory.is_null() {
            end(&[
                "error: ",
                OUT_OF_MEMORY,
                ": the system refused it; what was recorded stays readable; expected a higher limit (ulimit -v, the \
                 container's), fewer --jobs or a shorter run\n",
            ]);
        }
        memory
    }
}

// SAFETY: each function hands its arguments to `System` and returns what it returned. A null pointer, with which `System` says
// that it has no memory, doesn't return on Unix.
#[allow(unsafe_code, reason = "an allocator is an unsafe trait")]
unsafe impl GlobalAlloc for Allocator {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `alloc`, which is that of `System`.
        Self::given(unsafe { System.alloc(layout) })
    }

    #[inline]
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`; `memory` came from `System`.
        unsafe { System.dealloc(memory, layout) }
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `alloc_zeroed`, which is that of `System`.
        Self::given(unsafe { System.alloc_zeroed(layout) })
    }

    #[inline]
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `realloc`; `memory` came from `System`.
        Self::given(unsafe { System.realloc(memory, layout, size) })
    }
}

/// Makes the panic of a thread that the system refuses end the program with a sentence. `std::thread` and
/// [`crate::pool`] panic then, in the middle of work that other threads wait for.
pub fn on_no_thread() {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let text = panic.payload_as_str().unwrap_or_default();
        let of = ["failed to spawn thread", "failed to start a thread"];
        if of.iter().any(|start| text.starts_with(start)) {
            end(&[
                "error: ",
                OUT_OF_MEMORY,
                " or threads: the system refused a thread; what was recorded stays readable; expected higher limits \
                 (ulimit -v, ulimit -u, the container's) or fewer --jobs\n",
            ]);
        }
        before(panic);
    }));
}

/// Writes the parts of a sentence to stderr and ends the process, without memory, locks and handlers.
#[cold]
#[cfg(unix)]
#[allow(unsafe_code, reason = "functions of C are called")]
fn end(parts: &[&str]) {
    for part in parts {
        // SAFETY: the pointer is valid for as many bytes, which `write` only reads. If nobody reads them, nothing can be done.
        let _ = unsafe { libc::write(libc::STDERR_FILENO, part.as_ptr().cast(), part.len()) };
    }
    // SAFETY: ends the process at once; no destructor or handler runs, as with an abort.
    unsafe { libc::_exit(STATUS) }
}

/// Does nothing: the abort or the panic of `std` follows.
#[cold]
#[cfg(not(unix))]
fn end(_: &[&str]) {}

/// Exit status of a broken bench, that of `octant_verdict::Verdict::Error`.
#[cfg(unix)]
const STATUS: i32 = 4;
