//! Derivation of the verdict from a summary, which happens only here.
//!
//! The verdict depends on the values and limits of the requirements, on the part of the plan that was
//! done, on refusals, faults and findings. All of them are in the summary, so that every reader can
//! derive its verdict again.

pub use super::finding::{Finding, FindingSubject};

use super::summary::{BaselineMethod, CalibrationScore, FaultResult, Summary, WITH_FINDINGS};
use super::verdict::{RequirementResult, evaluate};
use super::work::{RunPart, Short, Work};
use octant_verdict::Verdict;
use octant_verdict::verdict::{Comparison, LimitCheck};
use std::convert::Infallible;
use std::fmt::Display;

/// Reason of a run without requirements.
pub const NO_REQUIREMENT: &str = "nothing was required";

/// Text about a refused calibration.
pub fn refusal(method: &str, reason: &str) -> String {
    format!("calibration of {method} refused: {reason}")
}

/// Faults of both methods that never fired, with texts.
pub fn unfired(summary: &Summary) -> impl Iterator<Item = (&FaultResult, String)> {
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

/// Compares a summary with its requirements, and sets `requirements`, `findings`, `verdict` and
/// `reasons`.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn judge(
    summary: &mut Summary,
    requirements: &[LimitCheck],
    findings: &[Finding],
) -> Result<(), serde_json::Error> {
    judge_by(summary, requirements, findings, |_| Ok::<_, Infallible>(0.0))
}

/// Judges as [`judge`] does, with the expanded uncertainty of each measure's reference, or the reason
/// why it is unknown.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn judge_by<E: Display>(
    summary: &mut Summary,
    requirements: &[LimitCheck],
    findings: &[Finding],
    uncertainty: impl Fn(&str) -> Result<f64, E>,
) -> Result<(), serde_json::Error> {
    let document = serde_json::to_value(&*summary)?;
    summary.findings = findings.to_vec();
    let result = |requirement: &LimitCheck| {
        let result = evaluate(requirement, &document);
        match uncertainty(&requirement.measure) {
            Ok(uncertainty) => result.with_uncertainty(uncertainty),
            Err(_) if result.value.is_none() => result,
            // Without a value the result is inconclusive, now and when it is derived again.
            Err(reason) => RequirementResult {
                value: None,
                margin: None,
                verdict: Verdict::Inconclusive,
                reason: Some(reason.to_string()),
                ..result
            },
        }
    };
    summary.requirements = requirements.iter().map(result).collect();
    let results = std::mem::take(&mut summary.requirements);
    summary.requirements =
        results.into_iter().map(|result| as_far_as_done(summary, result)).collect();
    let derived = derive(summary);
    (summary.verdict, summary.reasons) = (derived.verdict, derived.reasons);
    Ok(())
}

/// A verdict with its reasons.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Derived {
    /// The verdict.
    pub verdict: Verdict,
    /// Reasons, in plain words.
    pub reasons: Vec<String>,
}

/// Derives the verdict of a summary from its contents, without `verdict` and `reasons`. The results of
/// its requirements are derived from value and limit again.
#[must_use]
pub fn derive(summary: &Summary) -> Derived {
    let results = summary.requirements.iter().map(|result| as_far_as_done(summary, result.again()));
    let (about_unit, about_bench) = sides(summary, &mut results.collect::<Vec<_>>().iter());
    let mut reasons = Vec::new();
    let (mut unit, mut bench) = (Verdict::None, Verdict::None);
    for (verdict, reason) in about_bench {
        bench = bench.worst(verdict);
        reasons.push(reason);
    }
    for (verdict, reason) in about_unit {
        unit = unit.worst(verdict);
        reasons.extend(reason);
    }
    // A requirement that failed before the bench did stays failed; otherwise the verdict of the bench
    // counts too.
    let mut verdict = if unit == Verdict::Fail { unit } else { unit.worst(bench) };
    if summary.requirements.is_empty() {
        reasons.push(NO_REQUIREMENT.to_owned());
        if verdict == Verdict::Pass {
            verdict = Verdict::None;
        }
    }
    if summary.schema < WITH_FINDINGS {
        // Findings of that schema were not stored: the verdict can't be better than the stored one.
        verdict = verdict.worst(summary.verdict);
        if verdict == Verdict::Pass && summary.requirements.is_empty() {
            verdict = Verdict::None;
        }
    }
    Derived { verdict, reasons }
}

/// A verdict with its reason, where it needs one.
type Reasoned = (Verdict, Option<String>);

/// Verdicts that affect the result: of the unit and the run, and of the bench.
fn sides(
    summary: &Summary,
    results: &mut dyn Iterator<Item = &RequirementResult>,
) -> (Vec<Reasoned>, Vec<(Verdict, String)>) {
    let (mut unit, mut bench) = (Vec::new(), Vec::new());
    for finding in &summary.findings {
        match finding.about {
            FindingSubject::Bench | FindingSubject::Equipment => {
                bench.push((finding.verdict, finding.reason.clone()));
            }
            FindingSubject::Unit | FindingSubject::Run => {
                unit.push((finding.verdict, Some(finding.reason.clone())))
            }
        }
    }
    for (method, calibration, primary) in refusals(summary) {
        let Some(reason) = calibration.refused.as_ref() else { continue };
        let told = refusal(method, reason);
        // The baseline is only for comparison: its refusal is reported, and the run stands. After a
        // failure of the bench a refusal is correct.
        let verdict = match (primary, bench_broke(summary) || is_uncertified(summary)) {
            (true, false) => Verdict::Fail,
            (true, true) => Verdict::Inconclusive,
            (false, _) => Verdict::None,
        };
        unit.push((verdict, Some(told)));
    }
    for (short, place) in shortfalls(summary) {
        unit.push((Verdict::Inconclusive, Some(format!("{}{place}", short.text))));
    }
    for (_, reason) in unfired(summary) {
        unit.push((Verdict::Inconclusive, Some(reason)));
    }
    unit.extend(results.map(|result| (result.verdict, result.told())));
    (unit, bench)
}

fn refusals(summary: &Summary) -> impl Iterator<Item = (&str, &CalibrationScore, bool)> {
    let primary = summary.calibration.iter().map(|c| (summary.method.as_str(), c, true));
    let baseline = summary.baseline.iter();
    primary.chain(baseline.filter_map(|b| Some((b.label.as_str(), b.calibration.as_ref()?, false))))
}

/// Shortfalls of a run's methods from their plan. A refused method is reported as refused only, unless
/// the bench failed.
fn shortfalls(summary: &Summary) -> Vec<(Short, String)> {
    let broke = bench_broke(summary);
    let refused = |calibration: Option<&CalibrationScore>| {
        !broke && calibration.is_some_and(|calibration| calibration.refused.is_some())
    };
    let of = |planned: Option<&Work>, done: Option<&Work>, refused: bool, place: String| {
        let short = match (planned, done) {
            (Some(planned), Some(done)) if !refused => planned.short_of(done),
            _ => Vec::new(),
        };
        short.into_iter().map(move |short| (short, place.clone()))
    };
    let primary = refused(summary.calibration.as_ref());
    let mut all: Vec<_> =
        of(summary.planned.as_ref(), summary.done.as_ref(), primary, String::new()).collect();
    if let Some(b) = &summary.baseline {
        let refused = refused(b.calibration.as_ref());
        all.extend(of(b.planned.as_ref(), b.done.as_ref(), refused, format!(" in {}", b.label)));
    }
    all
}

/// True if the bench failed: nothing was judged from then on.
fn bench_broke(summary: &Summary) -> bool {
    summary.findings.iter().any(|finding| finding.about == FindingSubject::Bench)
}

/// True if equipment without a valid certificate was used.
fn is_uncertified(summary: &Summary) -> bool {
    summary.findings.iter().any(|finding| finding.about == FindingSubject::Equipment)
}

/// Result of a requirement as far as its part of the run was done: without the complete part it can't
/// be a pass, and after a failure of the bench it is no fail if it could still have become better.
pub(super) fn as_far_as_done(summary: &Summary, result: RequirementResult) -> RequirementResult {
    if is_uncertified(summary) && matches!(result.verdict, Verdict::Pass | Verdict::Fail) {
        let reason = Some("measured with equipment whose certificate didn't hold".to_owned());
        return RequirementResult { verdict: Verdict::Inconclusive, reason, ..result };
    }
    let part = RunPart::of(&result.measure);
    let baseline = result.measure.trim_start_matches('|').starts_with("baseline.");
    let short = shortfalls(summary)
        .into_iter()
        .find(|(short, place)| {
            place.is_empty() != baseline && part.is_none_or(|part| part == short.part)
        })
        .map(|(short, _)| short.text);
    let misbehaved = summary
        .findings
        .iter()
        .any(|finding| finding.about == FindingSubject::Unit && finding.verdict == Verdict::Fail);
    let broke = bench_broke(summary);
    let hidden = hidden(summary, &result);
    let reason = match result.verdict {
        Verdict::Pass if broke => "met until the bench failed, and not judged after".to_owned(),
        Verdict::Pass => match short {
            Some(short) => format!("met as far as it was done ({short})"),
            None if misbehaved => "met until an answer that may not be".to_owned(),
            None => {
                let nothing = hidden
                    .or_else(|| unsettled(summary, &result))
                    .or_else(|| without_effect(summary, &result));
                match nothing {
                    Some(reason) => reason,
                    None => return result,
                }
            }
        },
        Verdict::Fail if broke && !stays_broken(summary, &result) => {
            "not judged: the bench failed before its end".to_owned()
        }
        _ => return result,
    };
    RequirementResult { verdict: Verdict::Inconclusive, reason: Some(reason.to_string()), ..result }
}

/// Reason why an upper limit that holds where a solution was scored may not hold in its gaps.
fn hidden(summary: &Summary, result: &RequirementResult) -> Option<String> {
    if !matches!(result.comparison, Comparison::AtMost | Comparison::Below) {
        return None;
    }
    let path = result.measure.trim_matches('|');
    let navigation = match path.strip_prefix("baseline.") {
        Some(_) => summary.baseline.as_ref()?.navigation.as_ref()?,
        None => summary.navigation.as_ref()?,
    };
    let gaps = navigation.gaps.as_ref()?;
    let name = path.trim_start_matches("baseline.").strip_prefix("navigation.")?;
    let bound = *gaps.bounds.get(name)?;
    let plain = |value| octant_base::number::plain(value, 6);
    let [from_s, length_s] = gaps.longest_s.map(plain);
    let met = format!(
        "met where it was scored: of {}, the longest of {length_s} s from {from_s} s,",
        octant_base::number::counted(gaps.count, "gap", "gaps")
    );
    match bound {
        None => Some(format!("{met} one is too long to be bridged")),
        Some(bound) => {
            let most = bound + result.uncertainty.unwrap_or(0.0);
            let holds = result.comparison.holds(most, result.limit);
            (!holds).then(|| format!("{met} one may hide a value of up to {}", plain(most)))
        }
    }
}

/// Reason why a comparison with the twin shows nothing: a fault that never set in, or a twin that isn't whole.
fn without_effect(summary: &Summary, result: &RequirementResult) -> Option<String> {
    let path = result.measure.trim_matches('|');
    let (path, faults, difference) = match (path.strip_prefix("baseline."), &summary.baseline) {
        (Some(path), Some(baseline)) => (path, &baseline.faults, &baseline.counterfactual),
        _ => (path, &summary.faults, &summary.counterfactual),
    };
    path.strip_prefix("counterfactual.")?;
    let unfired: Vec<&str> =
        faults.iter().filter(|fault| !fault.fired).map(|fault| fault.id.as_str()).collect();
    if !unfired.is_empty() {
        return Some(format!("met without an effect of {}, which never fired", unfired.join(", ")));
    }
    let lacks = difference.as_ref()?.twin_lacks.as_ref()?;
    Some(format!("met against a twin without faults that isn't whole: {lacks}"))
}

/// Reason why a settling time below its limit shows nothing: the unit isn't settled, and the time is a lower bound.
fn unsettled(summary: &Summary, result: &RequirementResult) -> Option<String> {
    let heading = summary.heading.as_ref()?;
    let time_min = result.value?;
    heading.is_unsettled(result.measure.trim_matches('|')).then(|| {
        let earliest = octant_base::number::plain(time_min, 6);
        format!("the unit wasn't settled when its readings ended: {earliest} min is the earliest time at which it could be")
    })
}

/// True if a broken limit stays broken in any case: that of a maximum, a count, a mark that was
/// reached, or a result of a completed calibration.
fn stays_broken(summary: &Summary, result: &RequirementResult) -> bool {
    let upper = matches!(result.comparison, Comparison::AtMost | Comparison::Below);
    let path = result.measure.trim_matches('|');
    let name = path.rsplit('.').next().unwrap_or(path);
    let grows = name == "max"
        || name.ends_with("_max_arcmin")
        || name.ends_with("_max_nmi")
        || path.contains(".health.")
        || path.starts_with("pacing.");
    let baseline = path.starts_with("baseline.");
    let works = match (&summary.baseline, baseline) {
        (Some(BaselineMethod { planned, done, .. }), true) => (planned, done),
        _ => (&summary.planned, &summary.done),
    };
    let calibrated = match works {
        (Some(planned), Some(done)) => {
            !planned.short_of(done).iter().any(|short| short.part == RunPart::Calibration)
        }
        _ => false,
    };
    (upper && grows)
        || path.contains(".marks.")
        || (calibrated && RunPart::of(path) == Some(RunPart::Calibration))
}

/// Worst verdict of a judged summary without its requirements: of a refused calibration, a fault that
/// never fired, a finding, a shortfall, or missing requirements.
#[must_use]
pub fn except_requirements(summary: &Summary) -> Verdict {
    let (unit, bench) = sides(summary, &mut std::iter::empty());
    let worst = |told: &mut dyn Iterator<Item = Verdict>| told.fold(Verdict::Pass, Verdict::worst);
    let unit = worst(&mut unit.iter().map(|told| told.0));
    let bench = worst(&mut bench.iter().map(|told| told.0));
    let worst = if unit == Verdict::Fail { unit } else { unit.worst(bench) };
    if summary.requirements.is_empty() { worst.worst(Verdict::Inconclusive) } else { worst }
}
