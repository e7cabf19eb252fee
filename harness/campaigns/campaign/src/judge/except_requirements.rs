//! Verdict of a case except for its requirements.

use crate::execute::case::CaseResult;
use octant_score::judge;
use octant_verdict::Verdict;

/// Returns whether a refusal is the only problem of a case, except for its requirements. If each of
/// these is a probability, the refusal counts there, as a run that didn't pass, and not a second
/// time.
pub(crate) fn is_refused_alone(result: &CaseResult) -> bool {
    let Some(summary) = &result.summary else { return false };
    // Few calibrations are refused, and a copy takes time.
    if summary.calibration.as_ref().is_none_or(|calibration| calibration.refused.is_none()) {
        return false;
    }
    let mut summary = summary.clone();
    summary.calibration.iter_mut().for_each(|calibration| calibration.refused = None);
    // The work missing after a refusal is part of that refusal.
    (summary.planned, summary.done) = (None, None);
    judge::except_requirements(&summary) <= Verdict::Pass
}

/// Returns the verdict of a case except for its requirements.
pub(crate) fn verdict_except_requirements(result: &CaseResult) -> Verdict {
    let Some(summary) = &result.summary else { return Verdict::Error };
    let worst = judge::except_requirements(summary);
    // A verdict that these parts don't explain comes from elsewhere.
    let known = summary.requirements.iter().map(|check| check.verdict).fold(worst, Verdict::worst);
    if result.verdict > known { result.verdict } else { worst }
}
