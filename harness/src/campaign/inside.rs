//! Whether the folder of a campaign agrees with itself: plan, results, tables, statistics and manifest.

use super::chain;
use super::execute::Shard;
use super::merge::merged;
use super::plan::{FILE_NAME, Plan};
use super::report::{evidence::STATISTICS, rows};
use super::results::TABLES;
use super::status;
use crate::evidence::files;
use crate::evidence::inside::Inside;
use crate::evidence::manifest::CampaignFacts;
use serde_json::Value;
use std::path::Path;

/// Looks into the folder of a campaign, and derives its verdict from the results in it again.
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
    let status = status::of(&plan, folder, Shard::WHOLE)?;
    inside.verdict = Some(status.verdict());
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
        Some(rule) => status::decide(&plan, folder, rule)?.end(plan.cases.len()),
        None => plan.cases.len(),
    };
    let (_, results) = rows::read(&plan, folder, end).map_err(|error| error.to_string())?;
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
    if TABLES.iter().all(|(name, _)| merged(folder, name).is_file()) {
        let table = |name: &str| merged(folder, name);
        chain::check(&plan, folder, table).map_err(|error| error.to_string())?;
    }
    Ok(())
}
