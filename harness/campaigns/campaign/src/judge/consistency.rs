//! Checks that the folder of a campaign is consistent: plan, results, tables, statistics and
//! manifest.

use super::status;
use super::twins::{SharedTwins, TwinsSaid};
use crate::journal::FILE_NAME as JOURNAL;
use crate::merge::chain;
use crate::merge::merged;
use crate::merge::results::TABLES;
use crate::plan::shard::Shard;
use crate::plan::shared::{SharedText, SharedTexts};
use crate::plan::{Case, FILE_NAME, Plan, PlannedScenario};
use crate::report::file_names::STATISTICS;
use crate::store::CampaignResults;
use crate::store::in_plan_order::{RESULTS_AT_ONCE, read_in_order};
use octant_evidence::files;
use octant_evidence::manifest::CampaignFacts;
use octant_evidence::statements::FolderStatements;
use octant_score::summary::Summary;
use octant_score::verdict::RequirementResult;
use octant_verdict::Comparison;
use octant_verdict::verdict::LimitCheck;
use serde_json::Value;
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// Checks the folder of a campaign, and derives its verdict again from its results.
#[must_use]
pub fn look(folder: &Path, facts: &CampaignFacts) -> FolderStatements {
    let mut stated = FolderStatements {
        title: Some(facts.title.clone()),
        run: Some(facts.plan.clone()),
        ..FolderStatements::default()
    };
    if let Err(reason) = derive(folder, facts, &mut stated) {
        stated.contradictions.push(reason);
    }
    stated
}

fn derive(
    folder: &Path,
    facts: &CampaignFacts,
    stated: &mut FolderStatements,
) -> Result<(), String> {
    let plan = Plan::read(&folder.join(FILE_NAME)).map_err(|error| error.to_string())?;
    if plan.id != facts.plan {
        stated.contradictions.push(format!(
            "{FILE_NAME}: its id is {}, that of the manifest {}",
            plan.id, facts.plan
        ));
    }
    let stored = CampaignResults::open(folder).map_err(|error| error.to_string())?;
    let status =
        status::of_results(&plan, &stored, Shard::WHOLE).map_err(|error| error.to_string())?;
    stated.verdict = Some(status.verdict());
    stated.numerics = (!status.numerics.is_empty()).then(|| status.numerics.join("; "));
    let checks = status.requirements.iter().map(|(id, found)| (id.clone(), found.verdict));
    stated.checks = checks.collect();
    stated.reasons = status
        .requirements
        .iter()
        .map(|(id, found)| format!("{id}: {}: {}", found.verdict.name(), found.reason))
        .chain(status.doubts.iter().map(|doubt| format!("requirements may be missing: {doubt}")))
        .collect();
    let mut differs = |file: &str, what: &str, said: &str, now: &str| {
        if said != now {
            stated
                .contradictions
                .push(format!("{file}: its {what} is {said}, the results give {now}"));
        }
    };
    let verdict = status.verdict().name();
    differs("manifest.json", "verdict", facts.verdict.name(), verdict);
    let end = match &plan.stop {
        Some(rule) => status::decide_by(&plan, &stored, rule)
            .map_err(|error| error.to_string())?
            .end(plan.cases.len()),
        None => plan.cases.len(),
    };
    let Read { results, limits, error } = read(&plan, folder, &stored, end);
    if let Some((_, reason)) = error.as_ref().filter(|(place, _)| *place < end) {
        return Err(reason.clone());
    }
    differs("manifest.json", "results_blake3", &facts.results_blake3, &results);
    match files::read(&folder.join(STATISTICS)) {
        Ok(bytes) => {
            let statistics: Value =
                serde_json::from_slice(&bytes).map_err(|error| format!("{STATISTICS}: {error}"))?;
            let text = |name: &str| statistics[name].as_str().unwrap_or("none").to_owned();
            differs(STATISTICS, "verdict", &text("verdict"), verdict);
            differs(STATISTICS, "results_blake3", &text("results_blake3"), &results);
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
        Err(error) => return Err(format!("{STATISTICS}: {error}")),
    }
    let cases = || plan.cases.iter().take(end);
    let first = cases().filter_map(|case| stored.time(&case.id)).min();
    stated.contradictions.extend(of_journal(&stored, facts, first));
    stated.contradictions.extend(limits);
    if let Some((_, reason)) = error {
        return Err(reason);
    }
    if TABLES.iter().all(|(name, _)| merged(folder, name).is_file()) {
        let table = |name: &str| merged(folder, name);
        chain::check(&plan, &stored, table).map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Describes where the journal contradicts results and manifest. Folders of older versions have none.
fn of_journal(
    stored: &CampaignResults,
    facts: &CampaignFacts,
    first_result: Option<SystemTime>,
) -> Vec<String> {
    let journal = &stored.journal;
    let Some(counts) = facts.journal else { return Vec::new() };
    if !journal.is_there {
        return vec![format!(
            "{JOURNAL} is missing, the manifest tells of {} entries",
            counts.entries
        )];
    }
    let mut found = journal.contradictions(&facts.plan, stored.taken_back(), first_result);
    let looks = journal.entries.iter().filter(|entry| entry.is_look()).count();
    let now = [journal.entries.len(), looks];
    for (what, then, now) in [("entries", counts.entries, now[0]), ("looks", counts.looks, now[1])]
    {
        if then != now {
            found.push(format!("{JOURNAL} has {now} {what}, the manifest tells of {then}"));
        }
    }
    found
}

/// Hash and findings of all results of a campaign.
struct Read {
    /// BLAKE3 over all that count, as in `statistics.json`.
    results: String,
    /// Limits that aren't those of their scenarios, and twins that differ between cases that share them.
    limits: Vec<String>,
    /// First case whose result can't be read, by its place, and the reason.
    error: Option<(usize, String)>,
}

/// Line of a case that is hashed, the limits of its result that differ, and what it says of its twins.
type OfCase = (String, Vec<String>, Option<TwinsSaid>);

/// Reads each result once: hashes those of the cases up to `end`, and compares the limits in all of them with those of
/// their scenarios, if the folder has these. Limits of the requirements' file are in the plan, and are compared
/// whenever a result is read.
fn read(plan: &Plan, folder: &Path, stored: &CampaignResults, end: usize) -> Read {
    let of_scenarios = ScenarioLimits::of(plan, folder);
    let mut hasher = blake3::Hasher::new();
    let mut limits = Vec::new();
    let of_case = |place: usize| -> Result<Option<OfCase>, (usize, String)> {
        let Some(case) = plan.cases.get(place) else { return Ok(None) };
        let expected = of_scenarios.limits(case);
        if place >= end && expected.is_none() {
            return Ok(None);
        }
        let read = stored.of_plan(plan, case).map_err(|error| (place, error.to_string()))?;
        let hash = read.as_ref().map_or_else(|| "-".to_owned(), |(_, hash)| hash.clone());
        let summary = read.and_then(|(result, _)| result.summary);
        let told = match (&expected, &summary) {
            (Some(expected), Some(summary)) => differing(case, expected, summary),
            // Without the copy the scenario's limits aren't known.
            _ => Vec::new(),
        };
        let twins = TwinsSaid::of(case, summary.as_ref());
        Ok(Some((format!("{} {hash}\n", case.id), told, twins)))
    };
    let mut shared = SharedTwins::default();
    let error = read_in_order(plan.cases.len(), RESULTS_AT_ONCE, of_case, |place, of_case| {
        let (line, told, twins) = of_case;
        if place < end {
            hasher.update(line.as_bytes());
        }
        limits.extend(told);
        limits.extend(shared.contradiction(twins));
        Ok(())
    });
    Read { results: hasher.finalize().to_hex().to_string(), limits, error: error.err() }
}

/// Tells which limits of a scenario a result doesn't have.
fn differing(case: &Case, limits: &[LimitCheck], summary: &Summary) -> Vec<String> {
    let mut told = Vec::new();
    for check in limits {
        let words = |measure: &str, comparison: Comparison, limit: f64, secant: bool| {
            format!(
                "{measure} {} {limit}{}",
                comparison.sign(),
                if secant { " × sec φ" } else { "" }
            )
        };
        let expected = words(&check.measure, check.comparison, check.limit, check.secant_latitude);
        let found = summary.requirements.iter().filter(|result| result.id == check.id);
        let of = |r: &RequirementResult| {
            words(&r.measure, r.comparison, r.written_limit(), r.at_equator.is_some())
        };
        let found: Vec<String> = found.map(of).collect();
        if found.is_empty() {
            told.push(format!(
                "case {}: it didn't check {}, which its scenario requires",
                case.id, check.id
            ));
        } else if !found.contains(&expected) {
            told.push(format!(
                "case {}: {} is {}, its scenario has {expected}",
                case.id,
                check.id,
                found.join(" and ")
            ));
        }
    }
    told
}

/// Everything besides the seed that makes the scenario of a case.
type Settings = (SharedText, SharedTexts, Option<SharedTexts>);
/// Limits of a scenario; `None` if its copy isn't there.
type Limits = Option<Arc<[LimitCheck]>>;

/// Limits of scenarios by their copies in the folder. Those of the last settings are kept: drawn settings are
/// different in each case.
struct ScenarioLimits<'p> {
    plan: &'p Plan,
    copies: Vec<PlannedScenario>,
    known: Mutex<HashMap<Settings, Limits>>,
}

/// Largest number of settings whose limits are kept.
const KNOWN_MAX: usize = 4096;

impl<'p> ScenarioLimits<'p> {
    fn of(plan: &'p Plan, folder: &Path) -> Self {
        let copies = plan.scenarios.iter().map(|scenario| scenario.copied(folder)).collect();
        Self { plan, copies, known: Mutex::default() }
    }

    /// Returns the limits of the scenario of a case.
    fn limits(&self, case: &Case) -> Limits {
        let settings = (case.scenario.clone(), case.set.clone(), case.faults.clone());
        let lock = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = lock().get(&settings) {
            return known.clone();
        }
        let place = self.plan.scenarios.iter().position(|planned| planned.id == case.scenario);
        let scenario = place.and_then(|place| self.copies.get(place)?.scenario(case).ok());
        let limits = scenario.map(|scenario| {
            scenario.requirements.into_iter().map(|requirement| requirement.check).collect()
        });
        let mut known = lock();
        if known.len() >= KNOWN_MAX {
            known.clear();
        }
        known.insert(settings, limits.clone());
        limits
    }
}
