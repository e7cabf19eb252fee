//! Faults of the harness's own host: its processors, its disk, its recorder.
//!
//! A fault is described here; the program that runs on the host realises it. Its duration is fixed,
//! in host time: a starved thread could not end the fault that starves it.

/// Fault of the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HostAction {
    /// All processors are busy.
    Starve {
        /// Duration, s.
        lasts_s: f64,
        /// Threads that load each processor.
        threads: u32,
    },
    /// The disk of the recording is full from now on.
    FillDisk,
    /// The thread that writes the recording stops for a time.
    StallRecorder {
        /// Duration, s.
        pause_s: f64,
    },
}

/// A host that can be disturbed.
pub trait Hosted {
    /// Begins a fault. Called on the thread of the samples: the disturbance itself runs on other
    /// threads. Returns false if the host has nothing on which the fault could act.
    fn begin(&mut self, action: &HostAction) -> bool;
}
