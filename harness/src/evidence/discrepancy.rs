//! Discrepancies: everything in a run or a campaign that isn't a pass, each with an id that a person can
//! refer to.
//!
//! An id is made of what the discrepancy is, and of its cases: the same one has the same id in every
//! report, and one more case that fails makes another one, which nobody has disposed of yet.

use octant_requirements::Verdict;
use octant_score::judge;
use octant_score::summary::Summary;
use serde::Serialize;

/// Something that isn't a pass.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Discrepancy {
    /// Its id.
    pub id: String,
    /// What kind of thing it is.
    pub kind: &'static str,
    /// What it comes to.
    pub verdict: Verdict,
    /// The requirement that it is about, where it is about one.
    pub requirement: Option<String>,
    /// What it is, in plain words.
    pub what: String,
    /// Its cases, in the order of the plan.
    pub cases: Vec<String>,
}

/// What makes an id, besides the kind and the cases.
pub(crate) struct Subject<'a> {
    pub(crate) kind: &'static str,
    pub(crate) verdict: Verdict,
    pub(crate) requirement: Option<&'a str>,
    /// Where it is, or which one.
    pub(crate) of: &'a str,
}

impl Discrepancy {
    /// One whose cases belong to it.
    pub(crate) fn of_cases(subject: &Subject<'_>, what: String, cases: Vec<String>) -> Self {
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

    /// One that is of no cases, or stays the same while they change.
    pub(crate) fn whole(subject: &Subject<'_>, what: String) -> Self {
        Self::of_cases(subject, what, Vec::new())
    }
}

/// How many there are, in words.
pub(crate) fn counted(discrepancies: usize) -> String {
    match discrepancies {
        1 => "1 discrepancy".to_owned(),
        n => format!("{n} discrepancies"),
    }
}

/// Everything in a run that isn't a pass. The same scenario with the same seed has the same ids.
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
    // What the bench said. The refusal of a baseline is told, and bears on nothing; neither does a run
    // of which nothing is asked.
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
