//! Verdict of a case except for its requirements.

use crate::case::CaseResult;
use octant_requirements::Verdict;
use octant_score::judge;

/// Returns whether a refusal is the only problem of a case, except for its requirements. If each of
/// these is a probability, the refusal counts there, as a run that didn't pass, and not a second
/// time.
pub(crate) fn is_refused_alone(result: &CaseResult) -> bool {
    let Some(mut summary) = result.summary.clone() else { return false };
    let refused = summary.calibration.as_mut().and_then(|calibration| calibration.refused.take());
    // The work missing after a refusal is part of that refusal.
    (summary.planned, summary.done) = (None, None);
    refused.is_some() && judge::besides(&summary) <= Verdict::Pass
}

/// Returns the verdict of a case except for its requirements.
pub(crate) fn besides(result: &CaseResult) -> Verdict {
    let Some(summary) = &result.summary else { return Verdict::Error };
    let worst = judge::besides(summary);
    // A verdict that these parts don't explain comes from elsewhere.
    let known = summary.requirements.iter().map(|check| check.verdict).fold(worst, Verdict::worst);
    if result.verdict > known { result.verdict } else { worst }
}
