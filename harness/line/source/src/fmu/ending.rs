//! End of a run for the FMU of its source.

use crate::SourceError;
use octant_fmu_bind::stepper::Stepper;

/// Frees the FMU of a source at the end of a run; returns its failure.
pub(super) fn freed(stepper: &mut Stepper) -> Option<SourceError> {
    let error = stepper.finish().err()?;
    Some(SourceError::Gone { uri: stepper.uri().to_owned(), reason: error.to_string() })
}
