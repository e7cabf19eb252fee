//! Progress of a run as others see it, their request to end it, and the desk of a person who attends to it.

use crate::attendance::Attendance;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// Progress of a run, and the request to end it.
#[derive(Debug, Default)]
pub struct Control {
    /// Epochs done.
    pub epochs: AtomicU64,
    /// Set to end the run at its next look.
    pub cancel: AtomicBool,
    /// Set to end the run when its bench breaks a real-time limit.
    pub stop_when_lost: AtomicBool,
    /// Set when the bench of an earlier run was lost: this one isn't begun.
    pub lost: AtomicBool,
    /// Desk of the person who attends to the run, if anybody does.
    pub attendance: OnceLock<Arc<Attendance>>,
}

/// Sets a flag when it goes, also in a panic: a thread that waits for the flag then ends.
#[derive(Debug)]
#[must_use = "the flag is set when this goes"]
pub struct SetAtEnd<'a>(pub &'a AtomicBool);

impl Drop for SetAtEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Control {
    /// Stores how far the run is; true if its end was asked for.
    pub fn look(&self, epochs: u64) -> bool {
        self.epochs.store(epochs, Ordering::Relaxed);
        self.cancel.load(Ordering::Relaxed)
    }
}
