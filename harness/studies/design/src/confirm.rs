//! Confirmation of a design by simulation: paired runs of the designed sequence and of eight positions with
//! the sixteen moves, held against what was predicted of both.
//!
//! Linear prediction is optimistic near the bound: it takes products of errors for zero, and the filter then
//! believes σ that its errors don't keep. Normalized errors of the g-dependent biases show it, and the
//! improvement in simulation shows whether it matters.

use crate::largest::{LargestErrors, Sampled};
use crate::measure::{DesignMeasure, Part};
use octant_run::paired::SideResult;
use octant_score::compare::Measure;
use octant_statistics::paired::{Improvement, improvement, student};
use octant_statistics::sample::{ConfidenceInterval, deviation, mean, rms};
use serde::Serialize;

/// Range of the normalized squared errors of the g-dependent biases in which a design is confirmed.
pub const NORMALIZED: (f64, f64) = (0.8, 1.3);
/// Confidence of the intervals.
pub const CONFIDENCE: f64 = 0.9;
/// Places of the diagonal among the nine g-dependent biases.
const DIAGONAL: [usize; 3] = [0, 4, 8];

/// Hash of the scenarios of both sides, resolved: runs with another one are others.
#[must_use]
pub fn runs_hash(reference: &str, designed: &str) -> String {
    let mut hasher = blake3::Hasher::new();
    for scenario in [reference, designed] {
        hasher.update(&(scenario.len() as u64).to_le_bytes());
        hasher.update(scenario.as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

/// Largest errors that were predicted for both sides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PredictedPair {
    /// Eight positions with the sixteen moves.
    pub reference: Vec<LargestErrors>,
    /// The design.
    pub designed: Vec<LargestErrors>,
}

/// Result of the runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Confirmation {
    /// Number of seeds.
    pub seeds: usize,
    /// Refused calibrations of the reference and of the design.
    pub refused: [usize; 2],
    /// Largest errors of both sides.
    pub cells: Vec<ConfirmedCell>,
    /// Normalized squared errors of the reference.
    pub normalized_reference: Option<NormalizedErrors>,
    /// Normalized squared errors of the design.
    pub normalized: Option<NormalizedErrors>,
    /// True: the design keeps its promise.
    pub confirmed: bool,
    /// Reasons why it doesn't.
    pub reasons: Vec<String>,
}

/// Largest errors up to a time, as root mean squares over the seeds, arcmin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ConfirmedCell {
    /// The error and the time.
    pub measure: Measure,
    /// Of eight positions with the sixteen moves.
    pub reference: f64,
    /// Of the design.
    pub designed: f64,
    /// Improvement with its 90 % interval, from the pairs.
    pub improvement: Improvement,
    /// Prediction for the reference.
    pub predicted_reference: Sampled,
    /// Prediction for the design.
    pub predicted_designed: Sampled,
    /// Predicted improvement.
    pub predicted_improvement: f64,
    /// True: the confirmation rests on this cell.
    pub decides: bool,
}

/// Means over seeds and terms of squared errors of the g-dependent biases over σ², with their 90 %
/// intervals; expected: 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NormalizedErrors {
    /// Of all nine terms.
    pub all: ConfidenceInterval,
    /// Of the diagonal.
    pub diagonal: ConfidenceInterval,
}

impl NormalizedErrors {
    fn of(runs: &[&SideResult]) -> Option<Self> {
        let over = |terms: &[usize]| {
            let of_run = |run: &&SideResult| {
                let squares: Option<Vec<f64>> =
                    terms.iter().map(|term| run.g_normalized.get(*term).map(|n| n * n)).collect();
                mean(&squares?)
            };
            let each = runs.iter().map(of_run).collect::<Option<Vec<f64>>>()?;
            let value = mean(&each)?;
            let n = each.len();
            let spread = deviation(&each)? / libm::sqrt(n as f64);
            let half = student(n.checked_sub(1)?, CONFIDENCE)? * spread;
            Some(ConfidenceInterval { value, low: value - half, high: value + half })
        };
        Some(Self { all: over(&[0, 1, 2, 3, 4, 5, 6, 7, 8])?, diagonal: over(&DIAGONAL)? })
    }
}

impl ConfirmedCell {
    fn of(
        measure: Measure,
        pairs: &[[SideResult; 2]],
        predicted: &PredictedPair,
        latitude: bool,
    ) -> Option<Self> {
        let hours = match measure {
            Measure::Latitude24h | Measure::Longitude24h => 24.0,
            Measure::Latitude72h | Measure::Longitude72h => 72.0,
            _ => return None,
        };
        let both = pairs.iter().filter_map(|[reference, designed]| {
            reference.maxima.get(measure).zip(designed.maxima.get(measure))
        });
        let (reference, designed): (Vec<f64>, Vec<f64>) = both.unzip();
        let at = |all: &[LargestErrors]| {
            let at = all.iter().find(|at| (at.hours - hours).abs() < 1e-6)?;
            Some(if measure.is_longitude() { at.longitude_arcmin } else { at.latitude_arcmin })
        };
        let (predicted_reference, predicted_designed) =
            (at(&predicted.reference)?, at(&predicted.designed)?);
        Some(Self {
            measure,
            reference: rms(&reference)?,
            designed: rms(&designed)?,
            improvement: improvement(&reference, &designed, CONFIDENCE)?,
            predicted_reference,
            predicted_designed,
            predicted_improvement: 1.0 - predicted_designed.value / predicted_reference.value,
            decides: latitude != measure.is_longitude(),
        })
    }
}

impl Confirmation {
    /// Judges runs of both sides, eight positions first.
    ///
    /// A design is confirmed if no calibration was refused, the normalized squared errors of the
    /// g-dependent biases, of all nine and of the diagonal, are in the range [`NORMALIZED`], and the interval
    /// of the improvement reaches the predicted one. Of the latest mark it is the longitude error that
    /// counts, or the latitude error where that is minimised.
    #[must_use]
    pub fn of(
        pairs: &[[SideResult; 2]],
        predicted: &PredictedPair,
        measure: DesignMeasure,
    ) -> Self {
        let side = |side: usize| pairs.iter().map(|pair| &pair[side]).collect::<Vec<_>>();
        let refused =
            [0, 1].map(|number| side(number).iter().filter(|run| run.refused.is_some()).count());
        let latitude = matches!(measure, DesignMeasure::Drift(Part::Latitude, _));
        let mut cells: Vec<ConfirmedCell> = [
            Measure::Latitude24h,
            Measure::Longitude24h,
            Measure::Latitude72h,
            Measure::Longitude72h,
        ]
        .into_iter()
        .filter_map(|measure| ConfirmedCell::of(measure, pairs, predicted, latitude))
        .collect();
        let last = cells.iter().rposition(|cell| cell.decides);
        for (index, cell) in cells.iter_mut().enumerate() {
            cell.decides = Some(index) == last;
        }
        let normalized = NormalizedErrors::of(&side(1));
        let mut reasons = Vec::new();
        if refused[1] > 0 {
            reasons.push(format!("{} of {} calibrations were refused", refused[1], pairs.len()));
        }
        match &normalized {
            Some(errors) => reasons.extend(errors.reasons()),
            None => {
                reasons.push("normalized errors of the g-dependent biases are unknown".to_owned())
            }
        }
        match last.map(|last| &cells[last]) {
            Some(cell) => reasons.extend(cell.reason()),
            None => reasons.push("fewer than 2 pairs have a largest error each".to_owned()),
        }
        Self {
            seeds: pairs.len(),
            refused,
            cells,
            normalized_reference: NormalizedErrors::of(&side(0)),
            normalized,
            confirmed: reasons.is_empty(),
            reasons,
        }
    }
}

impl NormalizedErrors {
    fn reasons(&self) -> Vec<String> {
        let (low, high) = NORMALIZED;
        let beyond = |name: &str, found: f64| {
            (!(low..=high).contains(&found)).then(|| {
                format!(
                    "normalized squared errors of {name} are {found:.2}, expected {low} to {high}"
                )
            })
        };
        let all = beyond("the nine g-dependent biases", self.all.value);
        all.into_iter().chain(beyond("their diagonal", self.diagonal.value)).collect()
    }
}

impl ConfirmedCell {
    fn reason(&self) -> Option<String> {
        let percent = |part: f64| 100.0 * part;
        let Improvement { value, low, high, .. } = self.improvement;
        (high < self.predicted_improvement).then(|| {
            format!(
                "the largest error in {} is {:.0} % smaller, 90 % interval [{:.0}, {:.0}], predicted {:.0} %",
                self.measure.name(),
                percent(value),
                percent(low),
                percent(high),
                percent(self.predicted_improvement)
            )
        })
    }
}
