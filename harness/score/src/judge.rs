//! From a summary to its verdict: the one place where one is derived.
//!
//! It rests on the values and limits of the requirements, on what was done of the plan, on refusals, faults and findings;
//! all of them are in the summary, so that whoever reads one can derive its verdict again.

use super::summary::{Baseline, Calibration, FaultResult, Summary, WITH_FINDINGS};
use super::verdict::{RequirementResult, evaluate};
use super::work::{Part, Short, Work};
use octant_requirements::Verdict;
use octant_requirements::verdict::LimitCheck;
use serde::{Deserialize, Serialize};

/// Whom a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum About {
    /// The unit under test: what it did wrong counts against it.
    Unit,
    /// The bench: the unit isn't judged by what follows.
    Bench,
    /// Equipment of the bench whose certificate doesn't hold: nothing that was measured with it is shown.
    Equipment,
    /// The run: somebody ended it, or left out what it needs.
    Run,
}

/// Something other than a requirement that bears on the verdict: an answer that may not be, an overrun, a
/// dropped record, a bench that failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finding {
    /// What it comes to.
    pub verdict: Verdict,
    /// Whom it is about.
    pub about: About,
    /// What happened, in plain words.
    pub reason: String,
}

impl Finding {
    /// That the unit did what no unit may.
    #[must_use]
    pub fn of_unit(verdict: Verdict, reason: String) -> Self {
        Self { verdict, about: About::Unit, reason }
    }

    /// That the bench broke its promise.
    #[must_use]
    pub fn of_bench(verdict: Verdict, reason: String) -> Self {
        Self { verdict, about: About::Bench, reason }
    }

    /// That the run doesn't show what it was to show.
    #[must_use]
    pub fn of_run(reason: String) -> Self {
        Self { verdict: Verdict::Inconclusive, about: About::Run, reason }
    }
}

/// Reason of a run of which nothing was asked.
pub const NO_REQUIREMENT: &str = "nothing was required";

/// What is told of a calibration that was refused.
pub fn refusal(method: &str, reason: &str) -> String {
    format!("calibration of {method} refused: {reason}")
}

/// Faults of both methods that never fired, with what is told of them.
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

/// Holds a summary against its requirements, and sets `requirements`, `findings`, `verdict` and `reasons`.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn judge(
    summary: &mut Summary,
    requirements: &[LimitCheck],
    findings: &[Finding],
) -> Result<(), serde_json::Error> {
    judge_by(summary, requirements, findings, |_| Ok(0.0))
}

/// As [`judge`], with the expanded uncertainty of what each measure is held against, or why nobody knows it.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn judge_by(
    summary: &mut Summary,
    requirements: &[LimitCheck],
    findings: &[Finding],
    uncertainty: impl Fn(&str) -> Result<f64, String>,
) -> Result<(), serde_json::Error> {
    let document = serde_json::to_value(&*summary)?;
    summary.findings = findings.to_vec();
    let result = |requirement: &LimitCheck| {
        let result = evaluate(requirement, &document);
        match uncertainty(&requirement.measure) {
            Ok(uncertainty) => result.with_uncertainty(uncertainty),
            Err(_) if result.value.is_none() => result,
            // Without a value nothing of it is decided, now or when it is derived again.
            Err(reason) => RequirementResult {
                value: None,
                margin: None,
                verdict: Verdict::Inconclusive,
                reason: Some(reason),
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
    /// Why, in plain words.
    pub reasons: Vec<String>,
}

/// The verdict of a summary, from what is in it: not from `verdict` and `reasons`, which are what was said of
/// it. The results of its requirements are held against value and limit again.
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
    // What was broken before the bench failed stays broken; else the bench has the last word.
    let mut verdict = if unit == Verdict::Fail { unit } else { unit.worst(bench) };
    if summary.requirements.is_empty() {
        reasons.push(NO_REQUIREMENT.to_owned());
        if verdict == Verdict::Pass {
            verdict = Verdict::None;
        }
    }
    if summary.schema < WITH_FINDINGS {
        // Its findings were not kept: what they came to can't be less than was said.
        verdict = verdict.worst(summary.verdict);
        if verdict == Verdict::Pass && summary.requirements.is_empty() {
            verdict = Verdict::None;
        }
    }
    Derived { verdict, reasons }
}

type Told = (Verdict, Option<String>);

/// What bears on the verdict: of the unit and the run, and of the bench.
fn sides(
    summary: &Summary,
    results: &mut dyn Iterator<Item = &RequirementResult>,
) -> (Vec<Told>, Vec<(Verdict, String)>) {
    let (mut unit, mut bench) = (Vec::new(), Vec::new());
    for finding in &summary.findings {
        match finding.about {
            About::Bench | About::Equipment => {
                bench.push((finding.verdict, finding.reason.clone()));
            }
            About::Unit | About::Run => unit.push((finding.verdict, Some(finding.reason.clone()))),
        }
    }
    for (method, calibration, primary) in refusals(summary) {
        let Some(reason) = calibration.refused.as_ref() else { continue };
        let told = refusal(method, reason);
        // The baseline is there to be compared with: its refusal is told, the run stands. After the bench
        // failed a refusal is what it should be.
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

fn refusals(summary: &Summary) -> impl Iterator<Item = (&str, &Calibration, bool)> {
    let primary = summary.calibration.iter().map(|c| (summary.method.as_str(), c, true));
    let baseline = summary.baseline.iter();
    primary.chain(baseline.filter_map(|b| Some((b.label.as_str(), b.calibration.as_ref()?, false))))
}

/// Where the methods of a run fall short of their plan. What was refused is told as that, unless it was the
/// bench's doing.
fn shortfalls(summary: &Summary) -> Vec<(Short, String)> {
    let broke = bench_broke(summary);
    let refused = |calibration: Option<&Calibration>| {
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

/// The bench broke its promise: nothing was judged from then on.
fn bench_broke(summary: &Summary) -> bool {
    summary.findings.iter().any(|finding| finding.about == About::Bench)
}

/// It was measured with equipment whose certificate didn't hold.
fn is_uncertified(summary: &Summary) -> bool {
    summary.findings.iter().any(|finding| finding.about == About::Equipment)
}

/// What a result comes to where its part of the run was not done as planned: no pass; and where the unit
/// could not be judged to the end, no fail of what might have become better.
pub(super) fn as_far_as_done(summary: &Summary, result: RequirementResult) -> RequirementResult {
    if is_uncertified(summary) && matches!(result.verdict, Verdict::Pass | Verdict::Fail) {
        let reason = Some("measured with equipment whose certificate didn't hold".to_owned());
        return RequirementResult { verdict: Verdict::Inconclusive, reason, ..result };
    }
    let part = Part::of(&result.measure);
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
        .any(|finding| finding.about == About::Unit && finding.verdict == Verdict::Fail);
    let broke = bench_broke(summary);
    let reason = match result.verdict {
        Verdict::Pass if broke => "met until the bench failed, and not judged after".to_owned(),
        Verdict::Pass => match short {
            Some(short) => format!("met as far as it was done ({short})"),
            None if misbehaved => "met until an answer that may not be".to_owned(),
            None => return result,
        },
        Verdict::Fail if broke && !stays_broken(summary, &result) => {
            "not judged: the bench failed before its end".to_owned()
        }
        _ => return result,
    };
    RequirementResult { verdict: Verdict::Inconclusive, reason: Some(reason), ..result }
}

/// Whether a limit that is broken can't be kept any more, whatever comes: a maximum, a count, a mark that
/// was reached, what a calibration that is over came to.
fn stays_broken(summary: &Summary, result: &RequirementResult) -> bool {
    use octant_requirements::Comparison;
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
        (Some(Baseline { planned, done, .. }), true) => (planned, done),
        _ => (&summary.planned, &summary.done),
    };
    let calibrated = match works {
        (Some(planned), Some(done)) => {
            !planned.short_of(done).iter().any(|short| short.part == Part::Calibration)
        }
        _ => false,
    };
    (upper && grows)
        || path.contains(".marks.")
        || (calibrated && Part::of(path) == Some(Part::Calibration))
}

/// The worst of a judged summary but for its requirements: a calibration that was refused, a fault that
/// never fired, a finding, work that wasn't done, and that it checks nothing.
#[must_use]
pub fn besides(summary: &Summary) -> Verdict {
    let (unit, bench) = sides(summary, &mut std::iter::empty());
    let worst = |told: &mut dyn Iterator<Item = Verdict>| told.fold(Verdict::Pass, Verdict::worst);
    let unit = worst(&mut unit.iter().map(|told| told.0));
    let bench = worst(&mut bench.iter().map(|told| told.0));
    let besides = if unit == Verdict::Fail { unit } else { unit.worst(bench) };
    if summary.requirements.is_empty() { besides.worst(Verdict::Inconclusive) } else { besides }
}
