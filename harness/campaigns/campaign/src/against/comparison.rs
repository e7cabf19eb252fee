//! One ensemble, predicted and simulated, error by error.

use crate::plan::{Case, Plan};
use octant_statistics::sample::ConfidenceInterval;
use serde::{Deserialize, Serialize};

/// Minimum number of runs for a conclusion: σ is then known to a third.
pub const RUNS_MIN: usize = 50;

/// One ensemble, predicted and simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnsembleComparison {
    /// Name of the scenario in the campaign.
    pub scenario: String,
    /// Keys that are set.
    pub set: Vec<String>,
    /// Name of the method.
    pub method: String,
    /// Number of runs in the sample.
    pub runs: usize,
    /// Cases without a result.
    pub open: usize,
    /// Cases without a summary, or whose calibration was refused: they are not in the sample.
    pub without: usize,
    /// Cases that are the same run as another one of the sample, by their stream: together they are
    /// one draw.
    #[serde(default)]
    pub repeated: usize,
    /// Probability that all intervals hold the truth.
    pub confidence: f64,
    /// Relative half-width of the sample's interval of σ.
    pub known_to: f64,
    /// Differences that this number of runs would find with a probability of 90 %; null if there
    /// are too few.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detects: Option<Detects>,
    /// Parameters at the end of the calibration.
    pub states: Vec<ErrorRow>,
    /// Position errors in navigation, and attitude and velocity errors at its end.
    pub drift: Vec<ErrorRow>,
    /// Mean over the parameters of predicted over simulated σ; null where there is none.
    pub mean_ratio: Option<f64>,
    /// Conclusion whether the prediction holds for these runs; null if there are too few.
    pub stands: Option<bool>,
    /// Conclusion in plain words.
    pub words: Vec<String>,
    /// Effects that are not in the prediction.
    pub not_modelled: Vec<String>,
}

impl EnsembleComparison {
    /// Place of its first case in the plan; `None` if the plan has no such case.
    #[must_use]
    pub fn place(&self, plan: &Plan) -> Option<usize> {
        let is = |case: &Case| case.scenario == self.scenario && *case.set == *self.set;
        plan.cases.iter().position(is)
    }
}

/// Smallest differences of one error that a comparison finds with a probability of 90 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Detects {
    /// True σ over the predicted one, where the prediction is too large.
    pub ratio_below: f64,
    /// True σ over the predicted one, where the prediction is too small.
    pub ratio_above: f64,
    /// Difference of the mean, in σ.
    pub mean_sigma: f64,
}

/// One error, predicted and simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorRow {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Time since the start of navigation, h; null for a parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hours: Option<f64>,
    /// Predicted mean.
    pub predicted_mean: f64,
    /// Predicted σ about the predicted mean.
    pub predicted_sigma: f64,
    /// Mean of the sample with its interval.
    pub simulated_mean: ConfidenceInterval,
    /// σ of the sample about its mean, with its interval.
    pub simulated_sigma: ConfidenceInterval,
    /// Predicted over simulated σ; null if that is zero.
    pub ratio: Option<f64>,
    /// True if both predictions are within the intervals.
    pub agrees: bool,
}
