//! Time keeping of a run by the clock.

use octant_realtime::schedule::Granted;
use octant_score::summary::Pacing;

/// Time keeping of a run.
#[derive(Clone, Debug)]
pub struct Kept {
    /// Figures for the summary.
    pub pacing: Pacing,
    /// Real-time settings that the host granted the thread.
    pub granted: Granted,
}
