//! How far a campaign is, and what failed.

use super::case::{self, CaseResult};
use super::execute::{Shard, differing};
use super::plan::{Plan, StopRule};
use super::stop::{self, Decision};
use crate::report::number::plain;
use crate::score::verdict::Verdict;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Cases that are named at most.
const NAMED: usize = 10;

/// The state of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Status {
    /// Name of the campaign.
    pub title: String,
    /// Its plan.
    pub plan: String,
    /// Its cases.
    pub cases: usize,
    /// Cases without a result.
    pub open: usize,
    /// Cases by verdict.
    pub verdicts: BTreeMap<&'static str, usize>,
    /// Checks of each requirement, by verdict.
    pub requirements: BTreeMap<String, BTreeMap<&'static str, usize>>,
    /// The first cases that failed or ended as errors, and why.
    pub bad: Vec<Bad>,
    /// Cases that came to two results.
    pub differing: Vec<String>,
    /// Why no more cases are run; null: all are.
    pub stopped: Option<String>,
}

/// A case that isn't good.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Bad {
    /// The case.
    pub case: String,
    /// Its verdict.
    pub verdict: Verdict,
    /// The first reason.
    pub reason: String,
}

/// The state of a part of the campaign in a folder.
///
/// # Errors
/// If a result is there and can't be read.
pub fn of(plan: &Plan, folder: &Path, shard: Shard) -> Result<Status, String> {
    let mine = || plan.cases.iter().enumerate().filter(|(index, _)| shard.has(*index));
    let mut status = Status {
        title: plan.title.clone(),
        plan: plan.id.clone(),
        cases: 0,
        open: 0,
        verdicts: BTreeMap::new(),
        requirements: BTreeMap::new(),
        bad: Vec::new(),
        differing: Vec::new(),
        stopped: None,
    };
    let end = match &plan.stop {
        None => plan.cases.len(),
        Some(rule) => {
            let decision = decide(plan, folder, rule);
            status.stopped = in_words(rule, decision);
            decision.end(plan.cases.len())
        }
    };
    status.cases = mine().filter(|(index, _)| *index < end).count();
    for (_, case) in mine().filter(|(index, _)| *index < end) {
        let path = case::file(folder, &case.id);
        if !path.exists() {
            status.open += 1;
            continue;
        }
        let result = CaseResult::read(&path).map_err(|reason| format!("failed to {reason}"))?;
        *status.verdicts.entry(result.verdict.name()).or_default() += 1;
        for check in result.summary.iter().flat_map(|summary| &summary.requirements) {
            let counts = status.requirements.entry(check.id.clone()).or_default();
            *counts.entry(check.verdict.name()).or_default() += 1;
        }
        if differing(&path, &case.id).is_some() {
            status.differing.push(case.id.clone());
        }
        if result.verdict > Verdict::Inconclusive && status.bad.len() < NAMED {
            let reasons = result.summary.map(|summary| summary.reasons).unwrap_or_default();
            let reason = result.error.or_else(|| reasons.into_iter().next()).unwrap_or_default();
            status.bad.push(Bad { case: case.id.clone(), verdict: result.verdict, reason });
        }
    }
    Ok(status)
}

/// Looks at the results in a folder.
#[must_use]
pub fn decide(plan: &Plan, folder: &Path, rule: &StopRule) -> Decision {
    stop::decide(plan, rule, |case| {
        let result = CaseResult::read(&case::file(folder, &case.id)).ok()?;
        Some(result.check(&rule.requirement))
    })
}

fn in_words(rule: &StopRule, decision: Decision) -> Option<String> {
    let StopRule { requirement, demand, .. } = rule;
    let asked = format!(
        "{} % at a confidence of {} %",
        plain(100.0 * demand.pass, 6),
        plain(100.0 * demand.confidence, 6)
    );
    match decision {
        Decision::Shown { end } => Some(format!(
            "{requirement} is shown to be kept with {asked} after {end} cases: no more are needed"
        )),
        Decision::Refuted { end } => Some(format!(
            "{requirement} is shown not to be kept with {asked} after {end} cases: no more are needed"
        )),
        Decision::Open { .. } => None,
    }
}

impl Status {
    /// What it comes to: the worst of all cases, an error where a case came to two results, and no pass
    /// before all have run, or where there is none.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if !self.differing.is_empty() {
            return Verdict::Error;
        }
        let there = |verdict: &&Verdict| self.verdicts.contains_key(verdict.name());
        let worst = Verdict::ALL.iter().filter(there).max().copied();
        let unfinished = if self.open > 0 { Verdict::Inconclusive } else { Verdict::Pass };
        worst.unwrap_or(Verdict::Inconclusive).worst(unfinished)
    }

    /// The state for people.
    #[must_use]
    pub fn text(&self) -> String {
        let counts = |counts: &BTreeMap<&'static str, usize>| {
            let one = |verdict: &Verdict| {
                let count = counts.get(verdict.name())?;
                Some(format!("{count} {}", verdict.name()))
            };
            Verdict::ALL.iter().filter_map(one).collect::<Vec<_>>().join(", ")
        };
        let mut text = format!(
            "{}: {}\n  {} of {} cases have run: {}\n",
            self.title,
            self.verdict().name(),
            self.cases - self.open,
            self.cases,
            counts(&self.verdicts)
        );
        for (id, checks) in &self.requirements {
            _ = writeln!(text, "  {id}: {}", counts(checks));
        }
        if self.requirements.is_empty() {
            text += "  no requirement checked\n";
        }
        if let Some(stopped) = &self.stopped {
            _ = writeln!(text, "  {stopped}");
        }
        for Bad { case, verdict, reason } in &self.bad {
            _ = writeln!(text, "  case {case}: {}: {reason}", verdict.name());
        }
        let bad: usize = [Verdict::Fail, Verdict::Error]
            .iter()
            .filter_map(|verdict| self.verdicts.get(verdict.name()))
            .sum();
        if bad > self.bad.len() {
            _ = writeln!(text, "  and {} more", bad - self.bad.len());
        }
        for case in &self.differing {
            _ = writeln!(
                text,
                "  case {case} came to two results: this is no deterministic program"
            );
        }
        text
    }
}
