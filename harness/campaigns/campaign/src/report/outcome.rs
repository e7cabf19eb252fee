//! Parts of a case's result that a report needs.

use super::curves::{Curve, CurveWriter, StoredCurve};
use super::effects::CaseEffect;
use crate::execute::case::CaseResult;
use crate::judge::except_requirements::verdict_except_requirements;
use octant_score::summary::{NavigationScore, Summary};
use octant_score::verdict::RequirementResult;
use octant_verdict::Verdict;
use std::collections::BTreeMap;
use std::io;

/// Result of a case.
#[derive(Clone, Debug)]
pub struct RowOutcome {
    /// Worst verdict of all parts.
    pub verdict: Verdict,
    /// Worst verdict of all parts except the requirements.
    pub besides: Verdict,
    /// Reason why there is no summary.
    pub error: Option<String>,
    /// Reasons for the verdict.
    pub reasons: Vec<String>,
    /// Checks of the case.
    pub checks: Vec<RequirementResult>,
    /// Reason why its calibration was refused.
    pub refused: Option<String>,
    /// Faults that never fired.
    pub unfired: Vec<String>,
    /// True if the case has two results.
    pub differs: bool,
    /// Hash of its streams.
    pub stream_hash: Option<String>,
    /// Drift; `None` without a navigation.
    pub drift: Option<CaseDrift>,
    /// Effect of its faults; `None` without a twin.
    pub effect: Option<CaseEffect>,
}

/// The drift of a case.
#[derive(Clone, Debug)]
pub struct CaseDrift {
    /// Length of the navigation, h.
    pub duration_h: f64,
    /// Radial error at its end, nmi.
    pub final_nmi: f64,
    /// Largest radial error, nmi.
    pub max_nmi: f64,
    /// Time-RMS, nmi.
    pub rms_nmi: f64,
    /// Rate, nmi/h.
    pub rate_nmi_per_h: f64,
    /// Radial error at the marks that it reached, nmi.
    pub marks_nmi: BTreeMap<String, f64>,
    /// Largest errors of attitude and velocity that were scored, with name and unit.
    pub solution: Box<[(&'static str, &'static str, f64)]>,
    /// Errors over time.
    pub curve: Option<StoredCurve>,
}

/// Result of a case, whose errors over time aren't stored yet.
#[derive(Debug)]
pub(super) struct ReadOutcome {
    outcome: RowOutcome,
    curve: Option<Curve>,
}

impl ReadOutcome {
    pub(super) fn of(result: CaseResult, differs: bool) -> Self {
        let besides = verdict_except_requirements(&result);
        let (verdict, error) = (result.verdict, result.error);
        let mut outcome = RowOutcome {
            verdict,
            besides,
            error,
            reasons: Vec::new(),
            checks: Vec::new(),
            refused: None,
            unfired: Vec::new(),
            differs,
            stream_hash: None,
            drift: None,
            effect: None,
        };
        let Some(summary) = result.summary else { return Self { outcome, curve: None } };
        let Summary { reasons, requirements, faults, calibration, navigation, .. } = summary;
        let Summary { counterfactual, stream_hash, .. } = summary;
        outcome.effect = counterfactual.as_ref().map(CaseEffect::of);
        outcome.reasons = reasons;
        outcome.checks = requirements;
        outcome.refused = calibration.and_then(|calibration| calibration.refused);
        outcome.unfired =
            faults.into_iter().filter(|fault| !fault.fired).map(|fault| fault.id).collect();
        outcome.stream_hash = Some(stream_hash);
        outcome.drift = navigation.as_ref().and_then(CaseDrift::of);
        let curve = navigation.and_then(|navigation| Curve::of(&navigation.series_hours));
        Self { outcome, curve }
    }

    /// Stores the errors over time.
    pub(super) fn keep(self, curves: &mut CurveWriter) -> io::Result<RowOutcome> {
        let Self { mut outcome, curve } = self;
        let stored = curve.map(|curve| curves.push(&curve)).transpose()?;
        outcome.drift.iter_mut().for_each(|drift| drift.curve = stored.clone());
        Ok(outcome)
    }
}

impl RowOutcome {
    /// Returns the verdict of a requirement: an error without a summary, inconclusive if it wasn't
    /// checked.
    #[must_use]
    pub fn check(&self, requirement: &str) -> Verdict {
        if self.error.is_some() || self.stream_hash.is_none() {
            return Verdict::Error;
        }
        let mut checks = self.checks.iter();
        let found = checks.find(|check| check.id == requirement);
        found.map_or(Verdict::Inconclusive, |check| check.verdict)
    }
}

impl CaseDrift {
    /// Extracts the drift without the errors over time; `None` for headings alone.
    fn of(navigation: &NavigationScore) -> Option<Self> {
        let radial = navigation.radial_error_nmi?;
        let marks = navigation.marks.iter().map(|(name, mark)| (name.clone(), mark.radial_nmi));
        // Latitude and longitude come first.
        let solution = navigation.errors().into_iter().skip(2);
        Some(Self {
            solution: solution
                .filter_map(|(name, unit, score)| Some((name, unit, score?.max)))
                .collect(),
            duration_h: navigation.duration_h,
            final_nmi: radial.r#final,
            max_nmi: radial.max,
            rms_nmi: radial.rms,
            rate_nmi_per_h: radial.rate_per_h,
            marks_nmi: marks.collect(),
            curve: None,
        })
    }
}
