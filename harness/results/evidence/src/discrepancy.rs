//! Discrepancies: everything in a run or a campaign that isn't a pass, each with an id for
//! reference.
//!
//! An id is derived from the discrepancy and its cases: the same discrepancy has the same id in
//! every report, and one more failing case makes a new one, which has no disposition yet.

use octant_score::judge;
use octant_score::summary::Summary;
use octant_verdict::Verdict;
use serde::Serialize;

/// Finding that isn't a pass.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Discrepancy {
    /// Id.
    pub id: String,
    /// Kind of the finding.
    pub kind: &'static str,
    /// Overall verdict.
    pub verdict: Verdict,
    /// Requirement concerned, if any.
    pub requirement: Option<String>,
    /// Description, in plain words.
    pub what: String,
    /// Cases, in the order of the plan.
    pub cases: Vec<String>,
}

/// Parts of an id, besides the cases.
pub struct Subject<'a> {
    /// Kind of the discrepancy.
    pub kind: &'static str,
    /// Verdict that it stands for.
    pub verdict: Verdict,
    /// Requirement that it breaks, by its id.
    pub requirement: Option<&'a str>,
    /// Place or name of the finding.
    pub of: &'a str,
}

impl Discrepancy {
    /// Creates a discrepancy that its cases belong to.
    pub fn of_cases(subject: &Subject<'_>, what: String, cases: Vec<String>) -> Self {
        let content = serde_json::json!([
            subject.kind,
            subject.verdict.name(),
            subject.requirement,
            subject.of,
            cases
        ]);
        let hash = blake3::hash(content.to_string().as_bytes()).to_hex();
        Self {
            id: format!("D-{}", &hash.as_str()[..10]),
            kind: subject.kind,
            verdict: subject.verdict,
            requirement: subject.requirement.map(str::to_owned),
            what,
            cases,
        }
    }

    /// Creates a discrepancy without cases, or one whose id doesn't depend on them.
    pub fn whole(subject: &Subject<'_>, what: String) -> Self {
        Self::of_cases(subject, what, Vec::new())
    }
}

/// Renders the number of discrepancies.
pub fn counted(discrepancies: usize) -> String {
    match discrepancies {
        1 => "1 discrepancy".to_owned(),
        n => format!("{n} discrepancies"),
    }
}

/// Lists everything in a run that isn't a pass. The same scenario with the same seed has the same
/// ids.
#[must_use]
pub fn of_run(summary: &Summary) -> Vec<Discrepancy> {
    let mut all: Vec<Discrepancy> = Vec::new();
    if matches!(summary.verdict, Verdict::None | Verdict::Pass) {
        return all;
    }
    let run = format!("{}\n{}", summary.scenario, summary.seed);
    let found = |kind, verdict, requirement, which: &str, what: String| {
        let of = format!("{run}\n{which}");
        Discrepancy::whole(&Subject { kind, verdict, requirement, of: &of }, what)
    };
    for check in &summary.requirements {
        if let Some(what) = check.told() {
            all.push(found("requirement", check.verdict, Some(&check.id), &check.measure, what));
        }
    }
    if let Some(reason) = summary.calibration.as_ref().and_then(|found| found.refused.as_ref()) {
        let what = judge::refusal(&summary.method, reason);
        all.push(found("refused", Verdict::Fail, None, &summary.method, what));
    }
    for (fault, what) in judge::unfired(summary) {
        all.push(found("fault", Verdict::Inconclusive, None, &fault.id, what));
    }
    // Reasons of the bench. The refusal of a baseline is reported without effect on the verdict, as
    // is a run without requirements.
    let baseline = summary.baseline.as_ref().and_then(|baseline| {
        let reason = baseline.calibration.as_ref()?.refused.as_ref()?;
        Some(judge::refusal(&baseline.label, reason))
    });
    let told: Vec<&str> = all
        .iter()
        .map(|found| found.what.as_str())
        .chain(baseline.as_deref())
        .chain([judge::NO_REQUIREMENT])
        .collect();
    let rest: Vec<&String> =
        summary.reasons.iter().filter(|reason| !told.contains(&reason.as_str())).collect();
    let explained = all.iter().any(|found| found.verdict == summary.verdict);
    let verdict = if explained { Verdict::Inconclusive } else { summary.verdict };
    all.extend(rest.into_iter().map(|reason| found("run", verdict, None, reason, reason.clone())));
    all
}
