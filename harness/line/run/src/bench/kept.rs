//! Reports of the bench's parts: time keeping, link, instrument and power.

use super::ended::RunError;
use octant_account::Account;
use octant_realtime::schedule::Granted;
use octant_recorder::event::{BenchRecord, LinkRecord, PowerRecord};
use octant_score::summary::PacingRecord;

/// Time keeping of a run by the clock.
#[derive(Clone, Debug)]
pub struct TimeKeeping {
    /// Figures for the summary.
    pub pacing: PacingRecord,
    /// Real-time settings that the host granted the thread.
    pub granted: Granted,
}

/// Reports of the bench's parts at the end of a run.
#[derive(Debug, Default)]
pub struct BenchEnd {
    /// Failure in the middle that ended the run.
    pub broken: Option<RunError>,
    /// Description of the point where the source ended in the middle of something.
    pub cut_short: Option<String>,
    /// Accounts of what the source read from outside.
    pub inputs: Vec<Account>,
    /// Time keeping of a run by the clock.
    pub kept: Option<TimeKeeping>,
    /// Device and traffic of a run over a wire; as in the recording.
    pub link: Option<Box<LinkRecord>>,
    /// Clocks and counts of a real instrument and its table; as in the recording.
    pub instrument: Option<Box<BenchRecord>>,
    /// Switchings of the device's power; as in the recording.
    pub power: Option<Box<PowerRecord>>,
}
