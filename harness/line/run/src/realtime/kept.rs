//! Time keeping of a run by the clock.

use octant_realtime::schedule::Granted;
use octant_score::summary::PacingRecord;

/// Time keeping of a run.
#[derive(Clone, Debug)]
pub struct TimeKeeping {
    /// Figures for the summary.
    pub pacing: PacingRecord,
    /// Real-time settings that the host granted the thread.
    pub granted: Granted,
}
