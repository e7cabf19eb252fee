//! Passes a calibration several times over the same samples.
//!
//! Least squares linearises about its initial parameters. If errors are large (MEMS: percents),
//! each pass starts from the result of the previous one, until the parameters settle.

use crate::bench::Bench;
use crate::bench::ended::{Ended, RunError};
use crate::bench::steps::{InStep, Keeps};
use octant_calibration::state_machine::CoreConfigError;
use octant_calibration::{Core, CoreConfig};
use octant_endpoint::{Endpoint, InProcess};
use octant_sample::{Mode, Output};
use octant_source::{Epoch, Source, SourceError};

/// Maximum number of passes.
pub const PASSES_MAX: u32 = 10;

/// A parameter has settled when a pass changes it by no more than this much of its σ.
const SETTLED_SIGMA: f64 = 0.1;

/// Result of the passes.
#[derive(Clone, Debug)]
pub struct Passes {
    /// The core after its last pass: table, or refusal.
    pub core: Core,
    /// Number of passes.
    pub passes: u32,
    /// True if the last pass changed no parameter by more than a tenth of its σ. Otherwise it was
    /// refused, or [`PASSES_MAX`] were not enough.
    pub settled: bool,
}

/// Reasons why passes could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PassError {
    /// The configuration contradicts itself.
    #[error(transparent)]
    Config(#[from] CoreConfigError),
    /// A pass was aborted.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Calibrates in passes. `open` opens the source again for each; the first one starts from
/// `config.initial_parameters`.
///
/// # Errors
/// If the configuration contradicts itself or the source fails. A refused calibration is no error:
/// see [`Core::refusal`].
pub fn in_passes<S: Source>(
    config: &CoreConfig,
    mut open: impl FnMut() -> Result<S, SourceError>,
) -> Result<Passes, PassError> {
    let mut config = config.clone();
    let mut passes = 0;
    loop {
        passes += 1;
        let core = pass(&config, open().map_err(RunError::from)?)?;
        let settled = core.table().is_some() && settled(&config, &core);
        if settled || core.table().is_none() || passes == PASSES_MAX {
            return Ok(Passes { core, passes, settled });
        }
        config.initial_parameters = *core.parameters();
    }
}

/// Makes one pass: until the calibration is over, or the source.
///
/// # Errors
/// If the configuration contradicts itself or the source fails.
pub fn pass(config: &CoreConfig, source: impl Source) -> Result<Core, PassError> {
    let mut bench = Bench::with(source, InProcess::new(config)?, None, Calibrates);
    bench.run();
    let (ended, _, mut endpoint, _) = bench.end()?;
    if ended == Ended::SourceEnded {
        endpoint.end_of_stream().map_err(RunError::from)?;
    }
    Ok(endpoint.into_core())
}

/// Keeps nothing, and ends with the calibration.
struct Calibrates;

impl<S: Source, E: Endpoint> Keeps<S, E> for Calibrates {
    fn answered(
        &mut self,
        _source: &S,
        _endpoint: &E,
        _step: InStep<'_>,
        _sent: &Epoch,
        output: &Output,
    ) -> Result<Option<Ended>, RunError> {
        let over = !matches!(output.mode, Mode::Aligning | Mode::Calibrating);
        Ok(over.then_some(Ended::Done))
    }
}

/// Returns whether a pass changed no parameter significantly. A parameter that isn't estimated has
/// no σ, and doesn't change.
fn settled(before: &CoreConfig, core: &Core) -> bool {
    let (before, after) = (before.initial_parameters.to_array(), core.parameters().to_array());
    let moved = |((before, after), sigma): ((f64, f64), f64)| {
        (after - before).abs() > SETTLED_SIGMA * sigma
    };
    !before.into_iter().zip(after).zip(*core.sigma()).any(moved)
}
