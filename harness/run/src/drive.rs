//! The loop: source → endpoint → recorder, one epoch at a time.

use super::watch::Watcher;
use octant_base::control::Control;
use octant_endpoint::{Endpoint, EndpointError};
use octant_recorder::{Extra, Frame, Recorder, RecorderError};
use octant_sample::{GimbalCommand, Mode, Output};
use octant_source::{Epoch, Source, SourceError};

/// Epochs between two checks of the control: about a millisecond of wall time.
const CONTROL_EPOCHS: u64 = 8192;

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
    /// The core's answer broke the rules.
    Misbehaved,
    /// Source, endpoint or the disk of the recording failed.
    Broken,
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
    /// A navigation can't be scored.
    #[error(transparent)]
    Drift(#[from] octant_score::drift::DriftError),
}

impl RunError {
    /// True if source, endpoint or the disk of the recording went away: results up to then stay
    /// valid.
    #[must_use]
    pub fn is_gone(&self) -> bool {
        matches!(
            self,
            Self::Source(SourceError::Gone { .. } | SourceError::TableStopped { .. })
                | Self::Endpoint(
                    EndpointError::Gone { .. }
                        | EndpointError::Live(_)
                        | EndpointError::Restart { .. }
                )
                | Self::Recorder(RecorderError::Write { .. })
        )
    }
}

/// Drives the source through the endpoint until one of them ends.
///
/// # Errors
/// If source, endpoint or recorder fail; epochs recorded before stay readable.
pub fn drive<S, E>(
    source: &mut S,
    endpoint: &mut E,
    recorder: &mut Recorder,
    watcher: &mut Watcher,
    control: &Control,
) -> Result<Ended, RunError>
where
    S: Source + ?Sized,
    E: Endpoint + ?Sized,
{
    let mut command = GimbalCommand::default();
    let mut revision = 0;
    let mut epochs = 0u64;
    let look = look_every(source);
    let (mut epoch, mut output) = (Epoch::default(), Output::default());
    loop {
        if !source.next(&command, &mut epoch)? {
            return Ok(Ended::SourceEnded);
        }
        endpoint.step(&epoch, &mut output)?;
        command = output.gimbal_command;
        recorder.push(Frame { clean: &epoch, faulted: &epoch, output: &output })?;
        watcher.source(&epoch);
        answered((&epoch, false), &output, &mut revision, endpoint, recorder, watcher, source);
        epochs += 1;
        if watcher.misbehaved.is_some() {
            return Ok(Ended::Misbehaved);
        }
        if let Some(ended) = over(&output) {
            return Ok(ended);
        }
        if epochs.is_multiple_of(look) && control.look(epochs) {
            return Ok(Ended::Cancelled);
        }
    }
}

/// Returns the number of epochs between two checks of the control.
pub(super) fn look_every<S: Source + ?Sized>(source: &S) -> u64 {
    if source.is_live() { 1 } else { CONTROL_EPOCHS }
}

/// Handles the parameters and truth that belong to an output; `altered` tells whether faults
/// changed the epoch.
#[inline(always)]
pub(super) fn answered<S, E>(
    (sent, altered): (&Epoch, bool),
    output: &Output,
    revision: &mut u32,
    endpoint: &E,
    recorder: &mut Recorder,
    watcher: &mut Watcher,
    source: &S,
) where
    S: Source + ?Sized,
    E: Endpoint + ?Sized,
{
    let watched = watcher.answer(sent, altered, output);
    if output.parameters_revision != *revision {
        *revision = output.parameters_revision;
        let estimate = endpoint.parameters();
        recorder.extra(&Extra::Parameters(estimate));
        watcher.parameters(output, &estimate);
    }
    if (watched || recorder.truth_due())
        && let Some(truth) = source.truth()
    {
        if recorder.truth_due() {
            recorder.extra(&Extra::Truth(truth));
        }
        if watched {
            watcher.truth(output, &truth);
        }
    }
}

/// Returns the end that the core's output signals, if any.
#[inline(always)]
pub(super) fn over(output: &Output) -> Option<Ended> {
    match output.mode {
        Mode::Done => Some(Ended::Done),
        Mode::Refused => Some(Ended::Refused),
        Mode::Aligning | Mode::Calibrating | Mode::Navigating => None,
    }
}
