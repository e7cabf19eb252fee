//! Names of what a calibration is to estimate, and by which estimator.

use octant_calibration::config as core;
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_scenario::CalibrationSpec;

/// Lists the parameters that a calibration is to estimate, where the plan names them.
#[must_use]
pub fn planned_of(plan: &CalibrationSpec) -> Vec<&'static str> {
    match &plan.estimator {
        core::Estimator::Kalman(_) => (0..NAMES.len())
            .filter(|i| plan.estimates(ParameterGroup::of(*i)))
            .map(|i| NAMES[i])
            .collect(),
        core::Estimator::LeastSquares(_) | core::Estimator::ExternalTurntable(_) => Vec::new(),
    }
}

/// Name of an estimator, as in a scenario.
pub(super) fn estimator_name(estimator: &core::Estimator) -> &'static str {
    match estimator {
        core::Estimator::Kalman(_) => "kalman",
        core::Estimator::LeastSquares(_) => "least-squares",
        core::Estimator::ExternalTurntable(_) => "external-turntable",
    }
}
