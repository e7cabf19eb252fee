//! Faults of the harness's own host: its processors, its disk, its recorder.
//!
//! A fault is described here; who runs on the host realises it. It lasts as long as it says, in time
//! of the host: a thread that is starved could not end what starves it.

/// What happens to the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HostAction {
    /// All processors are busy.
    Starve {
        /// How long, s.
        lasts_s: f64,
        /// Threads that burn each of them.
        threads: u32,
    },
    /// The disk of the recording is full from now on.
    FillDisk,
    /// The thread that writes the recording stands still.
    StallRecorder {
        /// How long, s.
        pause_s: f64,
    },
}

/// Somebody whose host can be disturbed.
pub trait Hosted {
    /// A fault sets in. Called on the thread of the samples: it raises what others do. False where
    /// there is nothing that it could happen to.
    fn begin(&mut self, action: &HostAction) -> bool;
}
