//! Runs the core again on a recording, and keeps its filter's history for the smoother.

use super::replayed::{Recorded, Replayed};
use crate::bench::Bench;
use crate::bench::ended::{Ended, RunError};
use crate::bench::steps::{InStep, Keeps};
use octant_calibration::CoreConfig;
use octant_endpoint::InProcess;
use octant_sample::{Epoch, Mode, Output};
use octant_smoother::history::FilterHistory;
use octant_source::Replay;

/// A calibration of a recording, made again.
#[derive(Debug)]
pub struct RepeatedCalibration {
    /// History of the filter.
    pub history: FilterHistory,
    /// Comparison of the core's answers with the recorded ones, up to the end of the calibration.
    pub replayed: Replayed,
    /// Mode after the calibration; that of the calibration if the recording ends before.
    pub mode: Mode,
    /// Why the core refused it, if it did.
    pub refusal: Option<String>,
}

/// Repeats a recording up to the end of its calibration, with `nodes` looks at the filter.
///
/// # Errors
/// If the core has no filter that can be smoothed, or the recording can't be read.
pub fn repeat_calibration(
    source: Replay,
    endpoint: InProcess,
    config: &CoreConfig,
    nodes: usize,
) -> Result<RepeatedCalibration, RunError> {
    let repeated = RepeatedCalibration {
        history: FilterHistory::new(config, nodes)?,
        replayed: Replayed::default(),
        mode: Mode::Aligning,
        refusal: None,
    };
    let mut bench = Bench::with(source, endpoint, None, repeated);
    bench.run_through(&mut Recorded::default());
    let (_, source, _, mut repeated) = bench.end()?;
    repeated.replayed.truncated = source.truncated();
    Ok(repeated)
}

impl Keeps<Replay, InProcess> for RepeatedCalibration {
    fn answered(
        &mut self,
        source: &Replay,
        endpoint: &InProcess,
        step: InStep<'_>,
        sent: &Epoch,
        output: &Output,
    ) -> Result<Option<Ended>, RunError> {
        self.replayed.answered(source, endpoint, step, sent, output)?;
        self.mode = output.mode;
        if !matches!(output.mode, Mode::Aligning | Mode::Calibrating) {
            self.refusal = endpoint.core().refusal().map(ToString::to_string);
            self.history.end(&sent.sample, sent.aiding.as_ref())?;
            return Ok(Some(Ended::Done));
        }
        self.history.watch(endpoint.core())?;
        Ok(None)
    }
}
