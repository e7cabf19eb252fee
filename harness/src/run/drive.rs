//! The loop: source → endpoint → recorder, one epoch at a time.

use super::watch::Watcher;
use crate::endpoint::{Endpoint, EndpointError};
use crate::recorder::{Extra, Frame, Recorder, RecorderError};
use crate::source::{Epoch, Source, SourceError};
use octant_sample::{GimbalCommand, Mode, Output};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Epochs between two looks at what others want: about a millisecond of wall time.
pub(super) const CONTROL_EPOCHS: u64 = 8192;

/// What others see of a run, and want of it.
#[derive(Debug, Default)]
pub struct Control {
    /// Epochs done.
    pub epochs: AtomicU64,
    /// Set to end the run at the next look.
    pub cancel: AtomicBool,
}

impl Control {
    /// Tells how far the run is; true if somebody asked for its end.
    pub(crate) fn look(&self, epochs: u64) -> bool {
        self.epochs.store(epochs, Ordering::Relaxed);
        self.cancel.load(Ordering::Relaxed)
    }
}

/// How the loop ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The core has finished its procedure.
    Done,
    /// The core refused its calibration and stopped there.
    Refused,
    /// The source had no more samples.
    SourceEnded,
    /// Somebody asked for it.
    Cancelled,
    /// Source, endpoint or the disk of the recording went away.
    Broken,
}

/// Why a run broke off. These are failures of the bench, not of the core.
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
    Drift(#[from] crate::score::drift::DriftError),
}

impl RunError {
    /// Source, endpoint or the disk of the recording went away: what was done before stands.
    #[must_use]
    pub fn is_gone(&self) -> bool {
        matches!(
            self,
            Self::Source(SourceError::Gone { .. })
                | Self::Endpoint(_)
                | Self::Recorder(RecorderError::Write { .. })
        )
    }
}

/// Drives the source through the endpoint until one of them ends.
///
/// # Errors
/// If source, endpoint or recorder fail; what was recorded before stays readable.
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
    let (mut epoch, mut output) = (Epoch::default(), Output::default());
    loop {
        if !source.next(&command, &mut epoch)? {
            return Ok(Ended::SourceEnded);
        }
        endpoint.step(&epoch, &mut output)?;
        command = output.gimbal_command;
        recorder.push(Frame { clean: &epoch, faulted: &epoch, output: &output })?;
        answered(&output, &mut revision, endpoint, recorder, watcher, source);
        epochs += 1;
        if let Some(ended) = over(&output) {
            return Ok(ended);
        }
        if epochs.is_multiple_of(CONTROL_EPOCHS) && control.look(epochs) {
            return Ok(Ended::Cancelled);
        }
    }
}

/// Parameters and truth that go with an output.
#[inline(always)]
pub(super) fn answered<S, E>(
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
    if output.parameters_revision != *revision {
        *revision = output.parameters_revision;
        let estimate = endpoint.parameters();
        recorder.extra(&Extra::Parameters(estimate));
        watcher.parameters(output, &estimate);
    }
    let watched = watcher.epoch(output);
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

/// Whether the core has come to its end with an output.
#[inline(always)]
pub(super) fn over(output: &Output) -> Option<Ended> {
    match output.mode {
        Mode::Done => Some(Ended::Done),
        Mode::Refused => Some(Ended::Refused),
        Mode::Aligning | Mode::Calibrating | Mode::Navigating => None,
    }
}
