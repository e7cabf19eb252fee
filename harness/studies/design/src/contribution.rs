//! Contribution of each stop of a sequence.

use crate::judge::Judge;
use crate::search::SearchProblem;
use octant_calibration::schedule::DoesNotFit;
use octant_calibration::sequence::Sequence;
use serde::Serialize;

/// One stop and what it adds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Contribution {
    /// Azimuth, deg.
    pub azimuth_deg: f64,
    /// Roll, deg.
    pub roll_deg: f64,
    /// Dwell, s.
    pub dwell_s: f64,
    /// End of the dwell, s since the start of the calibration.
    pub until_s: f64,
    /// The measure if the calibration ended here.
    pub measure_so_far: f64,
    /// The measure of the sequence without this stop, its time given to the others; `None` where nothing
    /// is left.
    pub measure_without: Option<f64>,
}

impl SearchProblem {
    /// Returns what each stop of a sequence adds.
    ///
    /// # Errors
    /// If the sequence doesn't fit.
    pub fn contributions(
        &self,
        judge: &mut Judge,
        sequence: &Sequence,
    ) -> Result<Vec<Contribution>, DoesNotFit> {
        let mut ends = Vec::new();
        judge.evaluator.calibrate_with(sequence, self.duration_s, |_, until_s, covariance| {
            ends.push((until_s, covariance.clone()));
        })?;
        let stops = sequence.stops();
        let rates = self.setup.conditions.platform.rates;
        let unit_s = octant_calibration::schedule::dwell_s(sequence, self.duration_s, &rates)?;
        let mut all = Vec::new();
        for (index, (until_s, covariance)) in ends.into_iter().enumerate() {
            let stop = &stops[index % stops.len()];
            let measure_so_far = judge.score_of(covariance, stop);
            let mut others = stops.to_vec();
            others.remove(index % stops.len());
            let without = Sequence::new(&others, sequence.passes()).ok();
            let measure_without =
                without.and_then(|sequence| judge.score(&sequence, self.duration_s).ok());
            all.push(Contribution {
                azimuth_deg: stop.azimuth_rad.to_degrees(),
                roll_deg: stop.roll_rad.to_degrees(),
                dwell_s: unit_s * stop.weight,
                until_s,
                measure_so_far,
                measure_without,
            });
        }
        Ok(all)
    }
}
