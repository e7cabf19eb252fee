//! Comparison of a measure with its limit.

use octant_verdict::decision::in_band;
use octant_verdict::verdict::{Comparison, LimitCheck, Verdict, at_latitude};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A requirement with its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RequirementResult {
    /// Id of the requirement.
    pub id: String,
    /// Path of the measure.
    pub measure: String,
    /// Comparison with the limit.
    pub comparison: Comparison,
    /// The limit; with the factor sec φ it is that at the site's latitude.
    pub limit: f64,
    /// Limit at the equator, of a limit with the factor sec φ; null without the factor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_equator: Option<f64>,
    /// Value of the measure; null if the run doesn't have it.
    pub value: Option<f64>,
    /// Margin to the limit, negative if it is broken.
    pub margin: Option<f64>,
    /// Half width of the guard band about the limit; null without a band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<f64>,
    /// Verdict.
    pub verdict: Verdict,
    /// Reason for an inconclusive verdict.
    pub reason: Option<String>,
}

impl RequirementResult {
    /// Text `NAV-1: navigation.longitude_error_arcmin.max is 0.751, required <= 3`.
    #[must_use]
    pub fn sentence(&self) -> String {
        let (value, limit) = self.figures();
        let secant = self.secant_words().map_or_else(String::new, |words| format!(" ({words})"));
        format!(
            "{}: {} is {value}, required {} {limit}{secant}",
            self.id,
            self.measure,
            self.comparison.sign()
        )
    }

    /// Text `0.75 × sec φ` of a limit with that factor.
    #[must_use]
    pub fn secant_words(&self) -> Option<String> {
        self.at_equator.map(|limit| format!("{} × sec φ", octant_base::number::plain(limit, 6)))
    }

    /// Limit as it was written, without the factor sec φ.
    #[must_use]
    pub fn written_limit(&self) -> f64 {
        self.at_equator.unwrap_or(self.limit)
    }

    /// Derives margin and verdict from value and limit again. A result with a value that was
    /// inconclusive had a reason outside of the value, which is derived again where it belongs.
    #[must_use]
    pub(super) fn again(&self) -> Self {
        let margin = margin(self.comparison, self.value, self.limit);
        let band = self.uncertainty.unwrap_or(0.0);
        let (verdict, reason) = match self.value {
            _ if !self.limit.is_finite() => (Verdict::Inconclusive, self.reason.clone()),
            None => (Verdict::Inconclusive, self.reason.clone()),
            Some(value) if in_band(value, self.limit, band) => {
                (Verdict::Inconclusive, Some(self.within(value, band)))
            }
            Some(value) if self.comparison.holds(value, self.limit) => (Verdict::Pass, None),
            Some(_) => (Verdict::Fail, None),
        };
        Self { margin, verdict, reason, ..self.clone() }
    }

    /// Text about a value too near to its limit for its uncertainty.
    fn within(&self, value: f64, band: f64) -> String {
        let plain = |value| octant_base::number::plain(value, 6);
        format!(
            "{} is {}, which its reference, uncertain by {}, can't tell from the limit of {}",
            self.measure,
            plain(value),
            plain(band),
            plain(self.limit)
        )
    }

    /// Decides the result with an uncertainty of its reference.
    #[must_use]
    pub(super) fn with_uncertainty(self, uncertainty: f64) -> Self {
        if uncertainty > 0.0 {
            Self { uncertainty: Some(uncertainty), ..self }.again()
        } else {
            self
        }
    }

    /// Text about a result that isn't a pass.
    #[must_use]
    pub fn told(&self) -> Option<String> {
        match self.verdict {
            Verdict::None | Verdict::Pass => None,
            Verdict::Fail | Verdict::Error => Some(self.sentence()),
            Verdict::Inconclusive => {
                let reason = self.reason.as_deref().unwrap_or("nothing shown");
                Some(format!("{}: {reason}", self.id))
            }
        }
    }

    /// Texts of value and limit: six digits, or all of them if six don't show a difference.
    #[must_use]
    pub fn figures(&self) -> (String, String) {
        let value = self.value.unwrap_or(f64::NAN);
        let figures = [value, self.limit].map(|v| octant_base::number::plain(v, 6));
        match figures {
            [a, b] if a == b && value != self.limit => (value.to_string(), self.limit.to_string()),
            [a, b] => (a, b),
        }
    }
}

/// Evaluates one requirement on a summary in JSON.
#[must_use]
pub fn evaluate(requirement: &LimitCheck, summary: &Value) -> RequirementResult {
    let at_equator = requirement.secant_latitude.then_some(requirement.limit);
    let limit = match measure("heading.latitude_deg", summary) {
        Ok(latitude_deg) if requirement.secant_latitude => {
            at_latitude(requirement.limit, latitude_deg)
        }
        // Without a latitude there is no measure that such a limit belongs to.
        _ => requirement.limit,
    };
    let found = if limit.is_finite() {
        measure(&requirement.measure, summary).map_err(|error| error.to_string())
    } else {
        Err(format!("limit {limit} is not a number"))
    };
    let (value, reason) = match found {
        Ok(value) => (Some(value), None),
        Err(reason) => (None, Some(reason)),
    };
    let verdict = match value {
        None => Verdict::Inconclusive,
        Some(value) if requirement.comparison.holds(value, limit) => Verdict::Pass,
        Some(_) => Verdict::Fail,
    };
    RequirementResult {
        id: requirement.id.clone(),
        measure: requirement.measure.clone(),
        comparison: requirement.comparison,
        limit,
        at_equator,
        value,
        margin: margin(requirement.comparison, value, limit),
        uncertainty: None,
        verdict,
        reason,
    }
}

/// Margin of a value to its limit; `None` without a value, and where the difference isn't a number that a file can hold.
fn margin(comparison: Comparison, value: Option<f64>, limit: f64) -> Option<f64> {
    value.map(|value| comparison.margin(value, limit)).filter(|margin| margin.is_finite())
}

/// Reason why a summary has no number at a path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeasureError {
    /// A part of the path doesn't exist.
    #[error("{place} has no `{key}`; it has {}{}", .there.join(", "), and_more(*.more))]
    Missing {
        /// Path up to there.
        place: String,
        /// Part that doesn't exist.
        key: String,
        /// Names in its place; twelve at most.
        there: Vec<String>,
        /// Number of further names.
        more: usize,
    },
    /// The run doesn't have the value.
    #[error("{place} is null: the run doesn't have it")]
    Null {
        /// Path up to there.
        place: String,
    },
    /// The path goes on after a value.
    #[error("{place} is a value and has no `{key}`")]
    Value {
        /// Path up to there.
        place: String,
        /// Part that follows.
        key: String,
    },
    /// The value isn't a number.
    #[error("{place} is not a number")]
    NotANumber {
        /// The path.
        place: String,
    },
}

fn and_more(more: usize) -> String {
    if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// Number at a dotted path of a summary.
///
/// # Errors
/// If a part of the path doesn't exist, or there is no number.
pub fn measure(path: &str, summary: &Value) -> Result<f64, MeasureError> {
    let magnitude = path.strip_prefix('|').and_then(|p| p.strip_suffix('|'));
    let mut at = summary;
    let mut walked = String::new();
    for key in magnitude.unwrap_or(path).split('.') {
        let place = || if walked.is_empty() { "the summary".to_owned() } else { walked.clone() };
        let key_found = || key.to_owned();
        let next = match at {
            Value::Object(map) => map.get(key).ok_or_else(|| {
                let mut there: Vec<String> = map.keys().cloned().collect();
                there.sort_unstable();
                let more = there.len().saturating_sub(12);
                there.truncate(12);
                MeasureError::Missing { place: place(), key: key_found(), there, more }
            })?,
            Value::Null => return Err(MeasureError::Null { place: place() }),
            _ => return Err(MeasureError::Value { place: place(), key: key_found() }),
        };
        at = next;
        if !walked.is_empty() {
            walked.push('.');
        }
        walked.push_str(key);
    }
    match at {
        Value::Number(number) => {
            let value = number.as_f64().unwrap_or(f64::NAN);
            Ok(if magnitude.is_some() { value.abs() } else { value })
        }
        Value::Null => Err(MeasureError::Null { place: walked }),
        _ => Err(MeasureError::NotANumber { place: walked }),
    }
}
