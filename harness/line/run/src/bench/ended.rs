//! Ends of a run's loop, planned ones and failures, with the reports of the bench's parts.

use super::unit::UnitEventError;
use super::wire_account::wire_account;
use octant_account::Account;
use octant_base::failing::{Failing, FailureKind};
use octant_endpoint::EndpointError;
use octant_realtime::schedule::Granted;
use octant_recorder::RecorderError;
use octant_recorder::event::{BenchRecord, LinkRecord, PowerRecord};
use octant_sample::{Mode, Output};
use octant_score::summary::PacingRecord;
use octant_source::SourceError;
use octant_trajectory::Comparison;

/// How the loop ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The core has finished its procedure.
    Done,
    /// The core refused its calibration and stopped there.
    Refused,
    /// The source had no more samples.
    SourceEnded,
    /// Interrupted on request.
    Cancelled,
    /// The bench was lost, and the run was to end there; or it was lost in an earlier run.
    Lost,
    /// The core's answer broke the rules.
    Misbehaved,
    /// Source, endpoint or the disk of the recording failed.
    Broken,
}

/// Returns the end that the core's output signals, if any.
#[inline(always)]
pub(crate) fn over(output: &Output) -> Option<Ended> {
    match output.mode {
        Mode::Done => Some(Ended::Done),
        Mode::Refused => Some(Ended::Refused),
        Mode::Aligning | Mode::Calibrating | Mode::Navigating => None,
    }
}

/// Reasons why a run was aborted. These are failures of the bench, not of the core.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The source failed.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The endpoint failed.
    #[error(transparent)]
    Endpoint(#[from] EndpointError),
    /// The recorder failed.
    #[error(transparent)]
    Recorder(#[from] RecorderError),
    /// The source has no temperature, and errors follow it.
    #[error(
        "tell the filter the temperature: the source has none, and procedure.calibration.further has errors that follow it; \
         the plant has one, and so have text files and messages with a column or field of it, and logs whose instrument sends \
         one from the first sample on"
    )]
    Untold,
    /// A navigation can't be scored.
    #[error(transparent)]
    Drift(#[from] octant_score::drift::DriftError),
    /// A calibration can't be smoothed.
    #[error(transparent)]
    Smoother(#[from] octant_smoother::backward::SmootherError),
    /// A recorded event of the unit can't be repeated.
    #[error(transparent)]
    Unit(#[from] UnitEventError),
}

impl Failing for RunError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Source(error) => error.kind(),
            Self::Endpoint(_)
            | Self::Recorder(_)
            | Self::Untold
            | Self::Drift(_)
            | Self::Smoother(_)
            | Self::Unit(_) => FailureKind::Bench,
        }
    }
}

impl RunError {
    /// True if source, endpoint or the disk of the recording went away: results up to then stay
    /// valid.
    #[must_use]
    pub(crate) fn is_gone(&self) -> bool {
        matches!(
            self,
            Self::Source(SourceError::Gone { .. } | SourceError::TableStopped { .. })
                | Self::Endpoint(
                    EndpointError::Gone { .. }
                        | EndpointError::Live(_)
                        | EndpointError::Power(_)
                        | EndpointError::Restart { .. }
                )
                | Self::Recorder(RecorderError::Write { .. })
        )
    }
}

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
    /// Findings of the comparison of a solution with its reference, besides the errors.
    pub compared: Option<Box<Comparison>>,
    /// Time keeping of a run by the clock.
    pub kept: Option<TimeKeeping>,
    /// Device and traffic of a run over a wire; as in the recording.
    pub link: Option<Box<LinkRecord>>,
    /// Clocks and counts of a real instrument and its table; as in the recording.
    pub instrument: Option<Box<BenchRecord>>,
    /// Switchings of the device's power; as in the recording.
    pub power: Option<Box<PowerRecord>>,
}

impl BenchEnd {
    /// Lists the accounts of all that came from outside: what the source read, then what a unit sent over its wire.
    #[must_use]
    pub fn accounts(&self) -> Vec<Account> {
        let wire = self.link.as_deref().map(wire_account);
        self.inputs.iter().cloned().chain(wire).collect()
    }
}
