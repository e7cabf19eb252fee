//! Room on the stack. Tools call FMUs from threads with stacks of 512 KiB and less, and a core that is made, loaded
//! or copied passes through several times its size.

#![allow(unsafe_code, reason = "a thread that borrows, and is joined at once")]

use std::panic::resume_unwind;
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};

/// Stack of the thread, bytes. The most that was measured is 1209 KiB.
const STACK: usize = 4 << 20;

/// Runs work on a thread with a stack of its own, and waits for it. Where the system has no thread to give it
/// runs on that of the caller.
pub(super) fn with_room<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let slot = Mutex::new(Some(work));
    let take = || slot.lock().unwrap_or_else(PoisonError::into_inner).take();
    let started = || take().map(|work| work());
    // A scope would keep a handle of the caller's thread, which is never given back.
    // SAFETY: the thread is joined before anything that the work borrows goes.
    let thread = unsafe { Builder::new().stack_size(STACK).spawn_unchecked(started) };
    let done = match thread.map(JoinHandle::join) {
        Ok(Ok(done)) => done,
        Ok(Err(panic)) => resume_unwind(panic),
        Err(_) => None,
    };
    match (done, take()) {
        (Some(done), _) => done,
        (None, Some(work)) => here(work),
        // The work was taken, and its result with it.
        (None, None) => resume_unwind(Box::new("a thread ended without its result")),
    }
}

/// Runs work on the caller's stack; apart, so that its frame takes room only here.
#[cold]
#[inline(never)]
fn here<T>(work: impl FnOnce() -> T) -> T {
    work()
}
