//! Results of the alignment: reference, duration, solution with its σ.

use crate::observers::Observers;
use octant_calibration::config::{Estimator, Prior};
use octant_calibration::covariance::SolutionCovariance;
use octant_scenario::{AlignmentSpec, MotionSpec, Scenario, SourceSpec};
use octant_score::alignment::SolutionUncertainty;
use octant_score::summary::{AlignmentReference, AlignmentResult, SolutionScore};

/// Builds the result of a method's alignment; `None` if the unit never had an attitude.
pub(super) fn alignment(scenario: &Scenario, observers: &Observers) -> Option<AlignmentResult> {
    if matches!(scenario.source, SourceSpec::Solution(_)) {
        // The alignment of a foreign solution is unknown.
        return None;
    }
    let point = observers.moments.aligned.as_ref()?;
    let prior = observers.moments.prior.as_ref().map(prior_of);
    Some(AlignmentResult {
        reference: match scenario.alignment {
            AlignmentSpec::Given { .. } => AlignmentReference::External,
            AlignmentSpec::Coarse { .. } | AlignmentSpec::Inertial { .. } => {
                AlignmentReference::Static
            }
        },
        duration_s: observers.done.alignment_s()?,
        solution: SolutionScore::of(point, prior.as_ref()),
    })
}

/// Uncertainty with which the filter takes over from the alignment.
fn prior_of(prior: &Prior) -> SolutionUncertainty {
    let mut phi = [[0.0; 3]; 3];
    for (axis, sigma) in prior.attitude_rad.iter().enumerate() {
        phi[axis][axis] = sigma * sigma;
    }
    SolutionUncertainty { phi, velocity_mps: [prior.velocity_mps; 2] }
}

/// Uncertainty at the end of a calibration.
pub(super) fn uncertainty_of(covariance: &SolutionCovariance) -> SolutionUncertainty {
    let [north, east, _] = covariance.velocity_mps;
    SolutionUncertainty { phi: covariance.phi, velocity_mps: [north, east] }
}

/// Reference from which a calibration finds the attitude.
pub(super) fn calibration_reference(
    scenario: &Scenario,
    estimator: &Estimator,
) -> AlignmentReference {
    match (estimator, &scenario.motion) {
        (Estimator::ExternalTurntable(_), _) => AlignmentReference::External,
        (_, MotionSpec::Static(_)) => AlignmentReference::Static,
        (_, MotionSpec::Dockside(_)) => AlignmentReference::Dockside,
    }
}
