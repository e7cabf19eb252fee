//! Verdict of a run, with its reasons.

use crate::summary::SystemEnded;
use crate::tuning::TunedResult;
use octant_score::judge::NO_REQUIREMENT;
use octant_score::summary::FaultResult;
use octant_score::verdict::RequirementResult;
use octant_verdict::Verdict;

/// Determines the verdict of a run, with its reasons.
pub(super) fn judge(
    ended: &SystemEnded,
    faults: &[FaultResult],
    tuned: &[TunedResult],
    (requirements, must_require): (&[RequirementResult], bool),
) -> (Verdict, Vec<String>) {
    let mut reasons = Vec::new();
    let mut verdict = Verdict::None;
    match ended {
        SystemEnded::AtStop | SystemEnded::AskedByFmu { .. } => {}
        SystemEnded::Interrupted { at_s } => {
            verdict = Verdict::Inconclusive;
            reasons.push(format!("interrupted at {at_s} s"));
        }
        SystemEnded::Failed { reason, .. } => {
            verdict = Verdict::Error;
            reasons.push(reason.clone());
        }
    }
    for fault in faults.iter().filter(|fault| !fault.fired) {
        verdict = verdict.worst(Verdict::Inconclusive);
        reasons.push(fault.sentence());
    }
    for tuned in tuned.iter().filter(|tuned| !tuned.done) {
        verdict = verdict.worst(Verdict::Inconclusive);
        reasons.push(format!("{} never got {}", tuned.fmu, tuned.values.join(", ")));
    }
    let required = requirements.iter().fold(Verdict::None, |all, one| all.worst(one.verdict));
    // A requirement that failed before an FMU did stays failed.
    verdict = if required == Verdict::Fail { required } else { verdict.worst(required) };
    reasons.extend(requirements.iter().filter_map(RequirementResult::told));
    if requirements.is_empty() && must_require {
        verdict = verdict.worst(Verdict::Inconclusive);
        reasons.push("the system requires nothing, and --require wants it to".to_owned());
    } else if requirements.is_empty() && verdict == Verdict::None {
        reasons.push(NO_REQUIREMENT.to_owned());
    }
    (verdict, reasons)
}
