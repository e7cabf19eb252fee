//! A measure against its limit.

use octant_requirements::decision::in_band;
use octant_requirements::verdict::{Comparison, LimitCheck, Verdict};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A requirement with what was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RequirementResult {
    /// Id of the requirement.
    pub id: String,
    /// Path of the measure.
    pub measure: String,
    /// How it is held against the limit.
    pub comparison: Comparison,
    /// The limit.
    pub limit: f64,
    /// The measure; null if the run doesn't have it.
    pub value: Option<f64>,
    /// Room to the limit, negative where it is broken.
    pub margin: Option<f64>,
    /// Half of the guard band about the limit; null where it is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<f64>,
    /// What it comes to.
    pub verdict: Verdict,
    /// Why it is inconclusive.
    pub reason: Option<String>,
}

impl RequirementResult {
    /// `NAV-1: navigation.longitude_error_arcmin.max is 0.751, required <= 3`.
    #[must_use]
    pub fn sentence(&self) -> String {
        let (value, limit) = self.figures();
        format!(
            "{}: {} is {value}, required {} {limit}",
            self.id,
            self.measure,
            self.comparison.sign()
        )
    }

    /// It, with margin and verdict from value and limit again. What was inconclusive with a value was so for a
    /// reason outside of it, which is found again where the reason is.
    #[must_use]
    pub(super) fn again(&self) -> Self {
        let margin = self.value.map(|value| self.comparison.margin(value, self.limit));
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

    /// That a value is too near to its limit to be told from it.
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

    /// It, decided with an uncertainty of its reference.
    #[must_use]
    pub(super) fn with_uncertainty(self, uncertainty: f64) -> Self {
        if uncertainty > 0.0 {
            Self { uncertainty: Some(uncertainty), ..self }.again()
        } else {
            self
        }
    }

    /// What is told of it where it isn't a pass.
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

    /// Value and limit as people read them: six digits, or all of them where six look alike.
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

/// Holds one requirement against a summary as JSON.
#[must_use]
pub fn evaluate(requirement: &LimitCheck, summary: &Value) -> RequirementResult {
    let found = if requirement.limit.is_finite() {
        measure(&requirement.measure, summary)
    } else {
        Err(format!("limit {} is not a number", requirement.limit))
    };
    let (value, reason) = match found {
        Ok(value) => (Some(value), None),
        Err(reason) => (None, Some(reason)),
    };
    let verdict = match value {
        None => Verdict::Inconclusive,
        Some(value) if requirement.comparison.holds(value, requirement.limit) => Verdict::Pass,
        Some(_) => Verdict::Fail,
    };
    RequirementResult {
        id: requirement.id.clone(),
        measure: requirement.measure.clone(),
        comparison: requirement.comparison,
        limit: requirement.limit,
        value,
        margin: value.map(|v| requirement.comparison.margin(v, requirement.limit)),
        uncertainty: None,
        verdict,
        reason,
    }
}

/// The number at a dotted path of a summary.
///
/// # Errors
/// In plain words: what of the path isn't there, and what is there instead.
pub fn measure(path: &str, summary: &Value) -> Result<f64, String> {
    let magnitude = path.strip_prefix('|').and_then(|p| p.strip_suffix('|'));
    let mut at = summary;
    let mut walked = String::new();
    for key in magnitude.unwrap_or(path).split('.') {
        let place = if walked.is_empty() { "the summary" } else { &walked };
        let next = match at {
            Value::Object(map) => map.get(key).ok_or_else(|| {
                let mut there: Vec<&str> = map.keys().map(String::as_str).collect();
                there.sort_unstable();
                let more = there.len().saturating_sub(12);
                there.truncate(12);
                let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
                format!("{place} has no `{key}`; it has {}{tail}", there.join(", "))
            })?,
            Value::Null => return Err(format!("{place} is null: the run doesn't have it")),
            _ => return Err(format!("{place} is a value and has no `{key}`")),
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
        Value::Null => Err(format!("{walked} is null: the run doesn't have it")),
        _ => Err(format!("{walked} is not a number")),
    }
}
