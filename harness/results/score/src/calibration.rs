//! Results of a calibration.

use super::alignment::{AlignmentReference, SolutionScore};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Calibration of one method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibrationScore {
    /// Name of the position sequence.
    pub positions: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Duration, h.
    pub duration_h: f64,
    /// Reference that the attitude was found from.
    #[serde(default)]
    pub reference: Option<AlignmentReference>,
    /// Solution at its end, with which a navigation begins; null for a calibration without an end.
    #[serde(default)]
    pub solution: Option<SolutionScore>,
    /// Every parameter by its name.
    pub parameters: BTreeMap<String, ParameterScore>,
    /// Errors beside the parameters that the filter considered or estimated, by their names. Empty where there are
    /// none, and with a core that isn't called directly.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub further: BTreeMap<String, ParameterScore>,
    /// Mean normalized innovation squared; expected: 3 for three axes.
    pub nis_mean: Option<f64>,
    /// Where the filter considers states, whose errors in a run move all of its innovations: between which values 95 % of
    /// the runs have their mean NIS. Without such states, and with a core that isn't called directly, it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nis_expected: Option<[f64; 2]>,
    /// Normalized estimation error squared by group, divided by the size of the group; expected: 1.
    /// Groups that were not estimated are left out.
    pub nees: BTreeMap<String, f64>,
    /// Largest |error| / σ over all estimated parameters.
    pub worst_normalized_error: Option<f64>,
    /// Least gain of the parameters that were to be estimated; left out where one of them is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_gain: Option<f64>,
    /// Reason for which the core refused its own calibration; null if it didn't.
    pub refused: Option<String>,
    /// What that means, the likely causes with their evidence, and what to try, a line each. Empty for a published
    /// calibration.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refusal_explained: Vec<String>,
    /// Use of a case that is said to rest; left out where none is, and with a core that isn't called directly.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest: Option<CaseRestScore>,
    /// Counts of the core's reports.
    pub health: HealthCounts,
    /// Rows of the filter's σ over the calibration: hours of the run; heading, pitch and roll of the
    /// case, arcmin; velocity north and east, m/s. Empty where no covariance is known, and in the cases
    /// of a campaign.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sigma_hours: Vec<[f64; 6]>,
}

impl CalibrationScore {
    /// The mean NIS that is expected, in words: `3`, or `2.81 to 3.79`.
    #[must_use]
    pub fn nis_expected_words(&self) -> String {
        self.nis_expected
            .map_or_else(|| "3".to_owned(), |[low, high]| format!("{low:.2} to {high:.2}"))
    }
}

/// Use of a case that is said to rest (`procedure.calibration.aiding.rest`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseRestScore {
    /// True if the parameters rest on it; else they are those of the same calibration without it.
    pub used: bool,
    /// Contradiction between the rest and the measurements; null if there is none.
    pub contradicted: Option<String>,
    /// Largest difference of a parameter with and without it, in standard deviations of the difference; null where one
    /// of the two calibrations was refused.
    pub largest_difference_sigmas: Option<f64>,
    /// Name of that parameter.
    pub largest_difference_of: Option<String>,
}

impl CaseRestScore {
    /// One sentence on it.
    #[must_use]
    pub fn sentence(&self) -> String {
        let compared = match (self.largest_difference_sigmas, &self.largest_difference_of) {
            (Some(sigmas), Some(of)) => {
                format!(
                    ": without it no parameter differs by more than {sigmas:.1} σ of the difference ({of})"
                )
            }
            _ => String::new(),
        };
        match &self.contradicted {
            None => format!("the rest of the case is used{compared}"),
            Some(why) => format!(
                "the rest of the case is NOT used, because the case turned or a sensor drifted: {why}; all parameters are those \
                 of the calibration without it"
            ),
        }
    }
}

/// One parameter, in its unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterScore {
    /// True value; null if it is unknown.
    pub r#true: Option<f64>,
    /// Estimate.
    pub estimate: f64,
    /// 1σ; null if the parameter was not estimated.
    pub sigma: Option<f64>,
    /// Standard deviation before the calibration over that after it; left out where either is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    /// Estimate minus truth.
    pub error: Option<f64>,
    /// Error divided by σ.
    pub normalized: Option<f64>,
    /// Unit of all values except `normalized`.
    pub unit: String,
}

/// Counts of the core's reports, in epochs unless stated otherwise.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct HealthCounts {
    /// Measurements offered to the filter.
    pub measurements: u64,
    /// Measurements rejected by the innovation gate.
    pub rejected: u64,
    /// Recoveries of the filter.
    pub recoveries: u64,
    /// Epochs with identical counts of a gyro.
    pub gyro_stuck: u64,
    /// Epochs with identical counts of an accelerometer.
    pub accelerometer_stuck: u64,
    /// Epochs with samples missing before them.
    pub gaps: u64,
    /// Samples that did not advance, not used.
    pub out_of_order: u64,
    /// Samples with saturated or invalid counts.
    pub inertial_invalid: u64,
    /// Epochs in which the encoders did not show the commanded position.
    pub gimbal_disagrees: u64,
    /// Epochs in which due aiding did not come.
    pub aiding_lost: u64,
    /// Epochs in which innovations contradicted the tuning.
    pub inconsistent: u64,
    /// Epochs with numbers that are not finite, which were not used.
    pub numeric: u64,
    /// Epochs in which increments jumped more than any motion can; not used.
    pub jumps: u64,
    /// Epochs in which gyros and encoders did not show the same turn.
    pub gimbal_slips: u64,
    /// Epochs in which a parameter was found to drift.
    pub drifting: u64,
    /// Epochs whose aiding had another stamp than its sample; not used.
    pub aiding_stale: u64,
    /// Steps of the solution that its samples don't explain, while a correction was at work.
    pub solution_steps: u64,
}
