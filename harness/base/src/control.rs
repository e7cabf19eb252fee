//! Progress of a run as others see it, and their request to end it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Progress of a run, and the request to end it.
#[derive(Debug, Default)]
pub struct Control {
    /// Epochs done.
    pub epochs: AtomicU64,
    /// Set to end the run at its next look.
    pub cancel: AtomicBool,
}

impl Control {
    /// Stores how far the run is; true if its end was asked for.
    pub fn look(&self, epochs: u64) -> bool {
        self.epochs.store(epochs, Ordering::Relaxed);
        self.cancel.load(Ordering::Relaxed)
    }
}
