//! Parts of a plan as scores and findings name them.

use octant_calibration::config as core;
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_scenario as scenario;

/// Lists the parameters that a calibration is to estimate, where the plan names them.
#[must_use]
pub fn planned_of(plan: &scenario::CalibrationSpec) -> Vec<&'static str> {
    match &plan.estimator {
        core::Estimator::Kalman(_) => (0..NAMES.len())
            .filter(|i| plan.estimates(ParameterGroup::of(*i)))
            .map(|i| NAMES[i])
            .collect(),
        core::Estimator::LeastSquares(_) | core::Estimator::ExternalTurntable(_) => Vec::new(),
    }
}

/// Name of an estimator.
pub(super) fn estimator_name(estimator: &core::Estimator) -> &'static str {
    match estimator {
        core::Estimator::Kalman(_) => "kalman",
        core::Estimator::LeastSquares(_) => "least-squares",
        core::Estimator::ExternalTurntable(_) => "external-turntable",
    }
}
