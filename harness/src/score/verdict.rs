//! Verdicts: pass < inconclusive < fail < error, and the worst wins.

use super::summary::{FaultResult, Summary};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What a run, a requirement or a finding comes to. The order is the order of badness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It is shown to be good.
    Pass,
    /// Nothing is shown: a measure is missing, a fault never fired, a record was dropped.
    Inconclusive,
    /// It is shown to be bad.
    Fail,
    /// The bench failed: device gone, disk full.
    Error,
}

impl Verdict {
    /// All verdicts, from best to worst.
    pub const ALL: [Self; 4] = [Self::Pass, Self::Inconclusive, Self::Fail, Self::Error];

    /// The worse of the two.
    #[must_use]
    pub fn worst(self, other: Self) -> Self {
        self.max(other)
    }

    /// Exit status of the program; 2 is bad input or usage and no verdict.
    #[must_use]
    pub const fn exit_code(self) -> u8 {
        match self {
            Self::Pass => 0,
            Self::Fail => 1,
            Self::Inconclusive => 3,
            Self::Error => 4,
        }
    }

    /// The name used in files and on the screen.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Inconclusive => "inconclusive",
            Self::Fail => "fail",
            Self::Error => "error",
        }
    }
}

/// How a measure is held against a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Comparison {
    /// The measure may not be above the limit.
    #[serde(rename = "<=")]
    AtMost,
    /// The measure must be below the limit.
    #[serde(rename = "<")]
    Below,
    /// The measure may not be below the limit.
    #[serde(rename = ">=")]
    AtLeast,
    /// The measure must be above the limit.
    #[serde(rename = ">")]
    Above,
}

impl Comparison {
    /// The sign as it is written.
    #[must_use]
    pub const fn sign(self) -> &'static str {
        match self {
            Self::AtMost => "<=",
            Self::Below => "<",
            Self::AtLeast => ">=",
            Self::Above => ">",
        }
    }

    /// Room to the limit, positive on the good side.
    fn margin(self, value: f64, limit: f64) -> f64 {
        match self {
            Self::AtMost | Self::Below => limit - value,
            Self::AtLeast | Self::Above => value - limit,
        }
    }

    fn holds(self, value: f64, limit: f64) -> bool {
        match self {
            Self::AtMost => value <= limit,
            Self::Below => value < limit,
            Self::AtLeast => value >= limit,
            Self::Above => value > limit,
        }
    }
}

/// A limit on one measure of the summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Requirement {
    /// Id of the requirement that this check verifies.
    pub id: String,
    /// Path of the measure in the summary, with dots:
    /// `navigation.longitude_error_arcmin.max`, `calibration.parameters.g_zz.error`. With bars
    /// around it the magnitude is meant: `|calibration.parameters.g_zz.error|`.
    pub measure: String,
    /// How it is held against the limit.
    pub comparison: Comparison,
    /// The limit, in the unit of the measure.
    pub limit: f64,
}

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

    /// What is told of it where it isn't a pass.
    #[must_use]
    pub fn told(&self) -> Option<String> {
        match self.verdict {
            Verdict::Pass => None,
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
        let figures = [value, self.limit].map(|v| crate::report::number::plain(v, 6));
        match figures {
            [a, b] if a == b && value != self.limit => (value.to_string(), self.limit.to_string()),
            [a, b] => (a, b),
        }
    }
}

/// Something other than a requirement that bears on the verdict: an overrun, a dropped record, a
/// bench that failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What it comes to.
    pub verdict: Verdict,
    /// What happened, in plain words.
    pub reason: String,
}

/// Label of a run that passes because nothing was asked of it.
pub const NO_REQUIREMENT: &str = "no requirement checked";

/// What is told of a calibration that was refused.
pub(crate) fn refusal(method: &str, reason: &str) -> String {
    format!("calibration of {method} refused: {reason}")
}

/// Faults of both methods that never fired, with what is told of them.
pub(crate) fn unfired(summary: &Summary) -> impl Iterator<Item = (&FaultResult, String)> {
    let primary = summary.faults.iter().map(|fault| (fault, String::new()));
    let baseline = summary.baseline.iter().flat_map(|baseline| {
        baseline.faults.iter().map(|fault| (fault, format!(" in {}", baseline.label)))
    });
    primary.chain(baseline).filter(|(fault, _)| !fault.fired).map(|(fault, place)| {
        let why = match fault.firings {
            0 => "its trigger never came true",
            _ => "it set in and altered nothing",
        };
        (fault, format!("fault {} never fired{place}: {why}", fault.id))
    })
}

/// Holds a summary against its requirements, and sets `requirements`, `verdict` and `reasons`.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn judge(
    summary: &mut Summary,
    requirements: &[Requirement],
    findings: &[Finding],
) -> Result<(), serde_json::Error> {
    let document = serde_json::to_value(&*summary)?;
    let mut verdict = Verdict::Pass;
    let mut reasons = Vec::new();
    for finding in findings {
        verdict = verdict.worst(finding.verdict);
        reasons.push(finding.reason.clone());
    }
    let refusals = [
        (summary.method.as_str(), summary.calibration.as_ref(), true),
        summary
            .baseline
            .as_ref()
            .map_or(("", None, false), |b| (b.label.as_str(), b.calibration.as_ref(), false)),
    ];
    for (method, calibration, primary) in refusals {
        if let Some(reason) = calibration.and_then(|c| c.refused.as_ref()) {
            // The baseline is there to be compared with: its refusal is told, the run stands.
            if primary {
                verdict = verdict.worst(Verdict::Fail);
            }
            reasons.push(refusal(method, reason));
        }
    }
    for (_, reason) in unfired(summary) {
        verdict = verdict.worst(Verdict::Inconclusive);
        reasons.push(reason);
    }
    let results: Vec<RequirementResult> =
        requirements.iter().map(|requirement| evaluate(requirement, &document)).collect();
    for result in &results {
        verdict = verdict.worst(result.verdict);
        reasons.extend(result.told());
    }
    if requirements.is_empty() {
        reasons.push(NO_REQUIREMENT.to_owned());
    }
    summary.verdict = verdict;
    summary.reasons = reasons;
    summary.requirements = results;
    Ok(())
}

/// The worst of a judged summary but for its requirements: a calibration that was refused, a fault that
/// never fired, a finding, and that it checks nothing.
///
/// A summary doesn't keep its findings, but [`judge`] gives a reason for each: where there are more
/// reasons than the rest explains, there was one. A requirement that fails hides none of them.
#[must_use]
pub fn besides(summary: &Summary) -> Verdict {
    let baseline = summary.baseline.as_ref();
    let refused = |calibration: Option<&super::summary::Calibration>| {
        calibration.is_some_and(|calibration| calibration.refused.is_some())
    };
    let primary_refused = refused(summary.calibration.as_ref());
    let refusals = [primary_refused, refused(baseline.and_then(|b| b.calibration.as_ref()))];
    let faults = summary.faults.iter().chain(baseline.iter().flat_map(|b| &b.faults));
    let silent = faults.filter(|fault| !fault.fired).count();
    let unkept = summary.requirements.iter().filter(|r| r.verdict != Verdict::Pass).count();
    let nothing = summary.requirements.is_empty();
    let explained = refusals.into_iter().filter(|refused| *refused).count()
        + silent
        + unkept
        + usize::from(nothing);
    let found = summary.reasons.len() > explained;
    let mut worst = Verdict::Pass;
    if nothing || silent > 0 || found {
        worst = Verdict::Inconclusive;
    }
    if primary_refused {
        worst = worst.worst(Verdict::Fail);
    }
    // How bad a finding was shows where nothing else is as bad.
    let checks = summary.requirements.iter().map(|r| r.verdict).fold(worst, Verdict::worst);
    if summary.verdict > checks { summary.verdict } else { worst }
}

/// Holds one requirement against a summary as JSON.
#[must_use]
pub fn evaluate(requirement: &Requirement, summary: &Value) -> RequirementResult {
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
