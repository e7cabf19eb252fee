//! Checks that the folder of a campaign is consistent: plan, results, tables, statistics and
//! manifest.

use super::chain;
use super::merge::merged;
use super::plan::{FILE_NAME, Plan};
use super::report::{file_names::STATISTICS, rows};
use super::results::TABLES;
use super::shard::Shard;
use super::status;
use super::store::CampaignResults;
use octant_evidence::files;
use octant_evidence::inside::Inside;
use octant_evidence::manifest::CampaignFacts;
use octant_requirements::Comparison;
use serde_json::Value;
use std::path::Path;

/// Checks the folder of a campaign, and derives its verdict again from its results.
#[must_use]
pub fn look(folder: &Path, facts: &CampaignFacts) -> Inside {
    let mut inside = Inside {
        title: Some(facts.title.clone()),
        run: Some(facts.plan.clone()),
        ..Inside::default()
    };
    if let Err(reason) = derive(folder, facts, &mut inside) {
        inside.contradictions.push(reason);
    }
    inside
}

fn derive(folder: &Path, facts: &CampaignFacts, inside: &mut Inside) -> Result<(), String> {
    let plan = Plan::read(&folder.join(FILE_NAME)).map_err(|error| error.to_string())?;
    if plan.id != facts.plan {
        inside.contradictions.push(format!(
            "{FILE_NAME}: its id is {}, that of the manifest {}",
            plan.id, facts.plan
        ));
    }
    let stored = CampaignResults::open(folder).map_err(|error| error.to_string())?;
    let status =
        status::of_results(&plan, &stored, Shard::WHOLE).map_err(|error| error.to_string())?;
    inside.verdict = Some(status.verdict());
    inside.numerics = (!status.numerics.is_empty()).then(|| status.numerics.join("; "));
    let checks = status.requirements.iter().map(|(id, found)| (id.clone(), found.verdict));
    inside.checks = checks.collect();
    inside.reasons = status
        .requirements
        .iter()
        .map(|(id, found)| format!("{id}: {}: {}", found.verdict.name(), found.reason))
        .collect();
    let mut differs = |file: &str, what: &str, said: &str, now: &str| {
        if said != now {
            inside
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
    let results = rows::hash(&plan, &stored, end).map_err(|error| error.to_string())?;
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
    limits(&plan, folder, &stored, inside)?;
    if TABLES.iter().all(|(name, _)| merged(folder, name).is_file()) {
        let table = |name: &str| merged(folder, name);
        chain::check(&plan, &stored, table).map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Compares the limits in each case's result with those of its scenario, if the folder has it.
/// Limits of the requirements' file are in the plan, and are compared whenever a result is read.
fn limits(
    plan: &Plan,
    folder: &Path,
    stored: &CampaignResults,
    inside: &mut Inside,
) -> Result<(), String> {
    for case in &plan.cases {
        let Ok(planned) = plan.planned(case) else { continue };
        let planned = planned.copied(folder);
        // Without the copy the scenario's limits aren't known.
        let Ok(scenario) = planned.scenario(case) else { continue };
        let read = stored.of_plan(plan, case).map_err(|error| error.to_string())?;
        let Some((result, _)) = read else { continue };
        let Some(summary) = result.summary else { continue };
        let mut tell =
            |what: String| inside.contradictions.push(format!("case {}: {what}", case.id));
        for requirement in &scenario.requirements {
            let check = &requirement.check;
            let words = |measure: &str, comparison: Comparison, limit: f64| {
                format!("{measure} {} {limit}", comparison.sign())
            };
            let expected = words(&check.measure, check.comparison, check.limit);
            let found = summary.requirements.iter().filter(|result| result.id == check.id);
            let found: Vec<String> =
                found.map(|r| words(&r.measure, r.comparison, r.limit)).collect();
            if found.is_empty() {
                tell(format!("it didn't check {}, which its scenario requires", check.id));
            } else if !found.contains(&expected) {
                tell(format!(
                    "{} is {}, its scenario has {expected}",
                    check.id,
                    found.join(" and ")
                ));
            }
        }
    }
    Ok(())
}
