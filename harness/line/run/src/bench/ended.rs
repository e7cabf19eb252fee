//! Ends of a run's loop, planned ones and failures.

use super::unit::UnitEventError;
use octant_base::failing::{Failing, FailureKind};
use octant_endpoint::EndpointError;
use octant_recorder::RecorderError;
use octant_sample::{Mode, Output};
use octant_source::SourceError;

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
    Smoother(#[from] octant_smoother::refusal::SmootherError),
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
