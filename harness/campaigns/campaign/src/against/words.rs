//! Conclusion of a comparison, and its errors in other units.

use super::comparison::{EnsembleComparison, ErrorRow, RUNS_MIN};
use octant_base::display::DisplayUnits;
use octant_statistics::sample::ConfidenceInterval;

impl EnsembleComparison {
    /// Returns the comparison with its errors of position, attitude and velocity in these units, at the site
    /// of its cases. Parameters keep theirs.
    #[must_use]
    pub fn shown(&self, units: &DisplayUnits) -> Self {
        let drift = self.drift.iter().map(|row| row.shown(units)).collect();
        let mut shown = Self { drift, ..self.clone() };
        conclude(&mut shown, units);
        shown
    }
}

impl ErrorRow {
    /// Name of the error, as [`DisplayUnits::of`] takes it; `None` for a parameter.
    fn error(&self) -> Option<&str> {
        self.hours.and(self.name.split(' ').next())
    }

    fn shown(&self, units: &DisplayUnits) -> Self {
        let Some(error) = self.error() else { return self.clone() };
        let unit = units.of(error);
        let interval = |of: &ConfidenceInterval| ConfidenceInterval {
            value: unit.of(of.value),
            low: unit.of(of.low),
            high: unit.of(of.high),
        };
        Self {
            unit: unit.name.to_owned(),
            predicted_mean: unit.of(self.predicted_mean),
            predicted_sigma: unit.of(self.predicted_sigma),
            simulated_mean: interval(&self.simulated_mean),
            simulated_sigma: interval(&self.simulated_sigma),
            ..self.clone()
        }
    }
}

/// Concludes whether the prediction holds, and writes the reasons. `units` are those of the rows.
pub(super) fn conclude(comparison: &mut EnsembleComparison, units: &DisplayUnits) {
    let rows = || comparison.states.iter().chain(&comparison.drift);
    let differing: Vec<&ErrorRow> = rows().filter(|row| !row.agrees).collect();
    let error = format!("{:.0} %", 100.0 * comparison.known_to);
    let mut words = Vec::new();
    let stands = if !differing.is_empty() {
        words.push(format!(
            "the prediction can't stand for these runs: {} of {} figures differ by more than the \
             sample's own error of {error}",
            differing.len(),
            rows().count()
        ));
        words.extend(differing.iter().map(|row| in_words(row, units)));
        Some(false)
    } else if comparison.runs >= RUNS_MIN && comparison.without > 0 {
        words.push(format!(
            "all {} figures agree within the sample's own error of {error}, of the {} cases that have a \
             calibration: of the other {} no prediction says anything, and it can't stand for them",
            rows().count(),
            comparison.runs,
            comparison.without
        ));
        None
    } else if comparison.runs < RUNS_MIN {
        words.push(format!(
            "{} runs know σ to {error} only: from {RUNS_MIN} on it is said whether the prediction can \
             stand for them",
            comparison.runs
        ));
        None
    } else {
        words.push(format!(
            "the prediction can stand for these runs: all {} figures agree within the sample's own \
             error of {error}",
            rows().count()
        ));
        Some(true)
    };
    if let Some(detects) = &comparison.detects {
        words.push(format!(
            "{} runs find with 90 % an error whose σ is below {:.2} or above {:.2} of the predicted one, \
             or whose mean is {:.2} σ off",
            comparison.runs, detects.ratio_below, detects.ratio_above, detects.mean_sigma
        ));
    }
    if let Some(ratio) = comparison.mean_ratio {
        words.push(format!(
            "predicted over simulated σ is {ratio:.3} in the mean over the parameters"
        ));
    }
    if comparison.open > 0 {
        words.push(format!("{} more cases have not been run", comparison.open));
    }
    if comparison.repeated > 0 {
        words.push(format!(
            "{} cases are the same runs as others, by their streams, and don't count again",
            comparison.repeated
        ));
    }
    if comparison.without > 0 {
        words.push(format!(
            "{} cases are not in the sample: they ended as errors, or refused their calibration",
            comparison.without
        ));
    }
    comparison.stands = stands;
    comparison.words = words;
}

fn in_words(row: &ErrorRow, units: &DisplayUnits) -> String {
    let ErrorRow {
        name,
        unit,
        predicted_sigma,
        predicted_mean,
        simulated_sigma,
        simulated_mean,
        ..
    } = row;
    // A digit more than the scores have; parameters have four.
    let digits = row.error().map_or(4, |error| units.of(error).decimals + 1);
    let outside = |value: f64, interval: &ConfidenceInterval| {
        !(interval.low..=interval.high).contains(&value)
    };
    if outside(*predicted_sigma, simulated_sigma) {
        format!(
            "{name}: σ is {predicted_sigma:.digits$} {unit} predicted and {:.digits$} simulated",
            simulated_sigma.value
        )
    } else {
        format!(
            "{name}: the mean is {predicted_mean:.digits$} {unit} predicted and {:.digits$} simulated",
            simulated_mean.value
        )
    }
}
