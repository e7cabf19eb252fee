//! The loop: source → endpoint → recorder, one epoch at a time.

use super::watch::Watcher;
use crate::endpoint::{Endpoint, EndpointError};
use crate::recorder::{Extra, Frame, Recorder, RecorderError};
use crate::source::{Epoch, Source, SourceError};
use octant_sample::{GimbalCommand, Mode, Output};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Epochs between two looks at what others want: about a millisecond of wall time.
const CONTROL_EPOCHS: u64 = 8192;

/// What others see of a run, and want of it.
#[derive(Debug, Default)]
pub struct Control {
    /// Epochs done.
    pub epochs: AtomicU64,
    /// Set to end the run at the next look.
    pub cancel: AtomicBool,
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
        if output.parameters_revision != revision {
            revision = output.parameters_revision;
            let estimate = endpoint.parameters();
            recorder.extra(&Extra::Parameters(estimate));
            watcher.parameters(&output, &estimate);
        }
        let watched = watcher.epoch(&output);
        if (watched || recorder.truth_due())
            && let Some(truth) = source.truth()
        {
            if recorder.truth_due() {
                recorder.extra(&Extra::Truth(truth));
            }
            if watched {
                watcher.truth(&output, &truth);
            }
        }
        epochs += 1;
        match output.mode {
            Mode::Done => return Ok(Ended::Done),
            Mode::Refused => return Ok(Ended::Refused),
            Mode::Aligning | Mode::Calibrating | Mode::Navigating => {}
        }
        if epochs.is_multiple_of(CONTROL_EPOCHS) {
            control.epochs.store(epochs, Ordering::Relaxed);
            if control.cancel.load(Ordering::Relaxed) {
                return Ok(Ended::Cancelled);
            }
        }
    }
}
