//! The result of one method: a run that ended, scored.

use super::aligned::{self, uncertainty_of};
use crate::bench::closed::Closed;
use crate::bench::ended::{BenchEnd, Ended, RunError};
use crate::bench::error::MethodError;
use crate::observers::Observers;
use crate::observers::filtered::FilteredSeries;
use octant_calibration::config::Estimator;
use octant_calibration::table::CalibrationTable;
use octant_faults::Receipt;
use octant_recorder::{Event, RecorderError, RecorderSummary, concluded};
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_sample::{Mode, Parameters};
use octant_scenario::{CalibrationSpec, Method, Scenario};
use octant_score::parameters::{
    least_gain, nees, score, score_further, set_gains, worst_normalized_error,
};
use octant_score::summary::{
    AlignmentResult, CalibrationScore, CaseRestScore, FollowedScore, HeightChannel,
    NavigationScore, SolutionScore,
};
use std::sync::Arc;

/// Result of one method.
#[derive(Debug)]
pub struct MethodRun {
    /// Name of the method, as in "eight positions with G".
    pub label: String,
    /// End of the loop.
    pub ended: Ended,
    /// Reports of the bench's parts.
    pub bench: BenchEnd,
    /// Result of the alignment; `None` if the unit never had an attitude.
    pub alignment: Option<AlignmentResult>,
    /// Result of the calibration.
    pub calibration: Option<CalibrationScore>,
    /// Result of the navigation.
    pub navigation: Option<NavigationScore>,
    /// Whether the navigation followed its samples.
    pub followed: Option<FollowedScore>,
    /// Summary of the recorder.
    pub recorder: RecorderSummary,
    /// What was observed of the run.
    pub observed: Observers,
    /// True parameters, where the source knows them.
    pub truth: Option<Parameters>,
    /// The calibration table, where the calibration was accepted.
    pub table: Option<CalibrationTable>,
    /// Receipts of the faults, in the order of the scenario.
    pub receipts: Vec<Receipt>,
    /// Twin run: the same run without its faults.
    pub twin: Option<Arc<MethodRun>>,
}

impl MethodRun {
    /// Takes a run that broke in the middle for an error.
    pub(crate) fn whole(mut self) -> Result<Self, MethodError> {
        match self.bench.broken.take() {
            None => Ok(self),
            Some(error) => Err(error.into()),
        }
    }

    /// Scores what was observed of a run that ended, and closes its recording.
    pub(crate) fn scored(
        scenario: &Scenario,
        method: Method,
        closed: Closed,
    ) -> Result<Self, MethodError> {
        let Closed {
            ended,
            mut bench,
            last,
            conclusion,
            estimate,
            mut recorder,
            mut observers,
            truth,
            receipts,
        } = closed;
        let truth = truth.as_ref();
        if let Some(output) = last {
            observers.convergence.last = Some(estimate);
            // No sample belongs to this output: the recording stores the parameters as an event.
            if output.mode != observers.last_mode() && output.mode != Mode::Refused {
                recorder.event(concluded::event(&estimate));
                observers.parameters(&output, &estimate);
            }
            observers.epoch(&output);
        }
        let refused = match conclusion.refused {
            None if observers.last_mode() == Mode::Refused => {
                Some("the core doesn't say why".to_owned())
            }
            refused => refused,
        };
        if let Some(reason) = &refused {
            recorder.event(Event::Refused { reason: reason.clone() });
        }
        let done = observers.done.work();
        let calibration = scenario.calibration_of(method).map(|plan| {
            let known = truth.map(|draws| &draws.parameters);
            let mut parameters = score(known, &estimate.parameters, &estimate.sigma);
            if let Estimator::Kalman(kalman) = &plan.estimator {
                let prior = std::array::from_fn(|i| kalman.prior.of(ParameterGroup::of(i)));
                set_gains(&mut parameters, &prior);
            }
            let all = truth.map(|draws| scenario.true_further(draws));
            let further = score_further(all.as_ref(), conclusion.further.as_ref());
            let of_core = &observers.measurements.health;
            let mut health = of_core.counts().clone();
            health.measurements = conclusion.measurements.unwrap_or(health.measurements);
            let nis_mean = conclusion.nis_mean.or(of_core.nis_mean());
            let uncertainty = conclusion.solution.as_ref().map(uncertainty_of);
            let calibrated = observers.moments.calibrated.as_ref();
            CalibrationScore {
                reference: Some(aligned::calibration_reference(scenario, &plan.estimator)),
                solution: calibrated.map(|point| SolutionScore::of(point, uncertainty.as_ref())),
                positions: plan.name.clone(),
                estimator: estimator_name(&plan.estimator).to_owned(),
                duration_h: done.calibration_s.unwrap_or(plan.duration_s) / 3600.0,
                nis_mean: nis_mean.filter(|nis| nis.is_finite()),
                nis_expected: conclusion.nis_expected,
                nees: nees(&parameters, &further),
                worst_normalized_error: worst_normalized_error(&parameters, &planned_of(plan)),
                least_gain: least_gain(&parameters, &planned_of(plan)),
                parameters,
                further,
                refused: refused.clone(),
                refusal_explained: Vec::new(),
                rest: conclusion.rest.as_ref().map(rest_score),
                health,
                sigma_hours: (observers.charts.filtered.as_mut())
                    .map_or_else(Vec::new, FilteredSeries::take_sigma),
            }
        });
        let navigation = match observers.drift.scored() {
            Some(drift) => Some(drift.finish(HeightChannel::Held).map_err(RunError::from)?),
            None => None,
        };
        let follows = observers.answers.has_to_follow() && navigation.is_some();
        let followed = follows.then(|| observers.followed.score());
        let recorder = match recorder.finish() {
            Ok(summary) => summary,
            // The end of the recording found no space: the file is readable up to there, as after any
            // other end.
            Err(error @ RecorderError::Write { .. }) => {
                bench.broken.get_or_insert_with(|| error.into());
                RecorderSummary::default()
            }
            Err(error) => return Err(RunError::from(error).into()),
        };
        Ok(Self {
            label: scenario.method_label(method),
            ended: if bench.broken.is_some() { Ended::Broken } else { ended },
            bench,
            alignment: aligned::alignment(scenario, &observers),
            calibration,
            navigation,
            followed,
            recorder,
            truth: truth.map(|draws| draws.parameters),
            table: conclusion.table,
            receipts,
            twin: None,
            observed: observers,
        })
    }
}

/// Lists the parameters that a calibration is to estimate, where the plan names them.
#[must_use]
pub fn planned_of(plan: &CalibrationSpec) -> Vec<&'static str> {
    match &plan.estimator {
        Estimator::Kalman(_) => (0..NAMES.len())
            .filter(|i| plan.estimates(ParameterGroup::of(*i)))
            .map(|i| NAMES[i])
            .collect(),
        Estimator::LeastSquares(_) | Estimator::ExternalTurntable(_) => Vec::new(),
    }
}

/// Name of an estimator.
fn estimator_name(estimator: &Estimator) -> &'static str {
    match estimator {
        Estimator::Kalman(_) => "kalman",
        Estimator::LeastSquares(_) => "least-squares",
        Estimator::ExternalTurntable(_) => "external-turntable",
    }
}

/// Use of a case that is said to rest, as it is stored.
fn rest_score(rest: &octant_endpoint::RestUse) -> CaseRestScore {
    CaseRestScore {
        used: rest.contradicted.is_none(),
        contradicted: rest.contradicted.clone(),
        largest_difference_sigmas: rest.largest_difference.map(|(sigmas, _)| sigmas),
        largest_difference_of: rest.largest_difference.map(|(_, name)| name.to_owned()),
    }
}
