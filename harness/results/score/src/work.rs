//! Comparison of the work planned for a run with the work done, the first basis of a verdict.

use octant_base::number::plain;
use serde::{Deserialize, Serialize};

/// Largest tolerated shortfall of a duration, s: a unit changes its mode a sample or two late.
const DURATION_SLACK_S: f64 = 1.0;
/// Largest tolerated shortfall of a short duration, as a fraction.
const DURATION_SLACK: f64 = 0.01;
/// Largest tolerated fraction of missing references: those due while a mode changes.
const REFERENCE_SLACK: f64 = 0.01;

/// Amounts of work, planned or done. Null: not planned, or unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Work {
    /// Number of stops of the calibration at which the gimbals were held.
    pub stops: Option<u64>,
    /// Duration of the calibration with its alignment, s.
    pub calibration_s: Option<f64>,
    /// Number of references (velocity or position) for the calibration.
    pub references: Option<u64>,
    /// Duration of the navigation, s.
    pub navigation_s: Option<f64>,
}

/// A part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunPart {
    /// Calibration.
    Calibration,
    /// Navigation.
    Navigation,
}

impl RunPart {
    /// Part that a measure of a summary belongs to, by its dotted path; `None`: no part, or both.
    #[must_use]
    pub fn of(measure: &str) -> Option<Self> {
        let path = measure.trim_matches('|');
        let path = path.strip_prefix("baseline.").unwrap_or(path);
        let path = path.strip_prefix("counterfactual.").unwrap_or(path);
        match path.split('.').next() {
            Some("calibration" | "parameters") => Some(Self::Calibration),
            Some("navigation") => Some(Self::Navigation),
            _ => None,
        }
    }
}

/// A part of a run that was not done as planned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Short {
    /// Part.
    pub part: RunPart,
    /// Text such as `navigation: planned 24 h, done 1 s`.
    pub text: String,
}

impl Work {
    /// Shortfalls of the work done from this plan.
    #[must_use]
    pub fn short_of(&self, done: &Self) -> Vec<Short> {
        let mut short = Vec::new();
        let mut add = |part, what: &str, planned: String, done: String| {
            short.push(Short { part, text: format!("{what}: planned {planned}, done {done}") });
        };
        let durations = [
            (RunPart::Calibration, "calibration", self.calibration_s, done.calibration_s),
            (RunPart::Navigation, "navigation", self.navigation_s, done.navigation_s),
        ];
        for (part, what, planned_s, done_s) in durations {
            let Some(planned_s) = planned_s else { continue };
            let done_s = done_s.unwrap_or(0.0);
            let slack_s = DURATION_SLACK_S.min(planned_s * DURATION_SLACK);
            // Negated comparison, so that a NaN is a shortfall.
            if !(done_s >= planned_s - slack_s) {
                add(part, what, duration(planned_s), duration(done_s));
            }
        }
        if let (Some(planned), Some(done)) = (self.stops, done.stops)
            && done < planned
        {
            let part = RunPart::Calibration;
            add(part, "stops of the calibration", planned.to_string(), done.to_string());
        }
        if let (Some(planned), Some(done)) = (self.references, done.references)
            && (done as f64) < planned as f64 * (1.0 - REFERENCE_SLACK) - 1.0
        {
            let part = RunPart::Calibration;
            add(part, "references for the calibration", planned.to_string(), done.to_string());
        }
        short
    }
}

/// Text of a duration: `24 h`, `90 s`.
#[must_use]
pub fn duration(seconds: f64) -> String {
    if seconds >= 3600.0 {
        format!("{} h", plain(seconds / 3600.0, 6))
    } else {
        format!("{} s", plain(seconds, 6))
    }
}
