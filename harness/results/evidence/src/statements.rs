//! Reads what a folder of evidence states, and checks that its parts agree.
//!
//! Hashes show that no file was changed after the manifest was written. They don't show that the
//! content is consistent: a summary's verdict may contradict its values, and a recording may not be
//! the stream that was summarised.

use super::files;
use super::manifest::Manifest;
use super::planned::unplanned;
use octant_recorder::reader::{Recording, stream_hash};
use octant_scenario::Scenario;
use octant_score::equipment;
use octant_score::judge::{Finding, derive};
use octant_score::numerics::{differs, in_words};
use octant_score::rederive;
use octant_score::summary::Summary;
use octant_verdict::Verdict;
use octant_verdict::equipment::{Day, DayError};
use serde_json::Value;
use std::path::Path;

/// Name of the summary of a run.
pub const SUMMARY: &str = "summary.json";
/// Name of the scenario of a run.
pub const SCENARIO: &str = "scenario.toml";

/// Statements of a folder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FolderStatements {
    /// Title of the scenario, the system or the campaign.
    pub title: Option<String>,
    /// Seed of a run.
    pub seed: Option<u64>,
    /// Stream hash of a run, id of the plan of a campaign.
    pub run: Option<String>,
    /// Meaning of a numerics version that differs from this program's; `None` if it is the same.
    pub numerics: Option<String>,
    /// Verdict of the contents, derived again where possible.
    pub verdict: Option<Verdict>,
    /// Reasons for the verdict.
    pub reasons: Vec<String>,
    /// Requirements with their verdicts.
    pub checks: Vec<(String, Verdict)>,
    /// Contradictions between the parts, each beginning with the file's name.
    pub contradictions: Vec<String>,
}

/// Reads the folder of a run. Only regular files are opened.
#[must_use]
pub fn of_run(folder: &Path, manifest: &Manifest) -> FolderStatements {
    let mut stated = FolderStatements { seed: manifest.seed, ..FolderStatements::default() };
    let path = folder.join(SUMMARY);
    let text = match files::read(&path).map(String::from_utf8) {
        Ok(Ok(text)) => text,
        Ok(Err(_)) => {
            stated.contradictions.push(format!("{SUMMARY}: it is no text"));
            return stated;
        }
        Err(error) => {
            stated.contradictions.push(format!("{SUMMARY}: {error}"));
            return stated;
        }
    };
    let document: Value = match serde_json::from_str(&text) {
        Ok(document) => document,
        Err(error) => {
            stated.contradictions.push(format!("{SUMMARY}: {error}"));
            return stated;
        }
    };
    if document.get("system").is_some() {
        of_system(&document, &mut stated);
    } else {
        match Summary::from_json(&text) {
            Ok(summary) => {
                if summary.numerics != manifest.numerics {
                    stated.contradictions.push(format!(
                        "{SUMMARY}: it has {}, manifest.json has {}",
                        in_words(summary.numerics),
                        in_words(manifest.numerics)
                    ));
                }
                of_scenario(folder, &summary, &mut stated);
                of_equipment(folder, manifest, &summary, &mut stated);
                of_summary(folder, summary, &mut stated);
            }
            Err(error) => stated.contradictions.push(format!("{SUMMARY}: {error}")),
        }
    }
    if manifest.seed.is_some() && stated.seed != manifest.seed {
        let number = |seed: Option<u64>| seed.map_or("none".to_owned(), |seed| seed.to_string());
        stated.contradictions.push(format!(
            "{SUMMARY}: its seed is {}, that of the manifest {}",
            number(stated.seed),
            number(manifest.seed)
        ));
    }
    stated
}

/// Holds the requirements, limits and decisions of a summary against the scenario beside it.
fn of_scenario(folder: &Path, summary: &Summary, stated: &mut FolderStatements) {
    match Scenario::load(&folder.join(SCENARIO), &[]) {
        Ok(scenario) => {
            let found = unplanned(&scenario, summary).into_iter();
            stated.contradictions.extend(found.map(|what| format!("{SUMMARY}: {what}")));
        }
        Err(error) => stated.contradictions.push(format!(
            "{SCENARIO}: {error}: the limits of {SUMMARY} can't be held against those that were planned"
        )),
    }
}

/// Checks the certificates in a manifest against its own date: the resulting findings must be in
/// the summary.
fn of_equipment(
    folder: &Path,
    manifest: &Manifest,
    summary: &Summary,
    stated: &mut FolderStatements,
) {
    let scenario = Scenario::load(&folder.join(SCENARIO), &[]);
    // A scenario of an older form has no equipment; an unreadable one is reported above.
    if let Ok(scenario) = scenario
        && scenario.equipment != manifest.equipment
    {
        stated
            .contradictions
            .push("manifest.json: its equipment isn't that of scenario.toml".to_owned());
    }
    match certified(manifest) {
        Ok(expected) => {
            let silent = expected.iter().filter(|finding| !summary.findings.contains(finding));
            stated.contradictions.extend(
                silent.map(|finding| format!("{SUMMARY}: it doesn't tell that {}", finding.reason)),
            );
        }
        Err(error) => stated.contradictions.push(error.to_string()),
    }
}

/// A manifest without the day on which the run ended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("manifest.json: ended: {0}")]
pub struct NoEnd(#[from] pub DayError);

/// Returns the findings about a run's equipment on the day on which the run ended.
///
/// # Errors
/// If the manifest has no such day.
pub fn certified(manifest: &Manifest) -> Result<Vec<Finding>, NoEnd> {
    if manifest.equipment.is_empty() {
        return Ok(Vec::new());
    }
    let ended = Day::of_text(&manifest.ended)?;
    Ok(equipment::findings(&manifest.equipment, Some(&ended)))
}

fn of_summary(folder: &Path, summary: Summary, stated: &mut FolderStatements) {
    let found = rederive::contradictions(&summary);
    stated.contradictions.extend(found.into_iter().map(|what| format!("{SUMMARY}: {what}")));
    stated.verdict = Some(derive(&summary).verdict);
    let baseline = summary.baseline.as_ref().map(|baseline| baseline.stream_hash.as_str());
    for (name, hash) in
        [("recording.mcap", Some(summary.stream_hash.as_str())), ("baseline.mcap", baseline)]
    {
        // A run may record nothing, and a recording may hold only every n-th sample.
        let Some(hash) = hash else { continue };
        let Ok(file) = files::open(&folder.join(name)) else { continue };
        let found = Recording::new(std::io::BufReader::new(file)).and_then(stream_hash);
        match found {
            Err(error) => stated.contradictions.push(format!("{name}: {error}")),
            Ok(Some(found)) if found != hash => stated
                .contradictions
                .push(format!("{name}: its stream hash is {found}, that of {SUMMARY} {hash}")),
            Ok(_) => {}
        }
    }
    let checks = summary.requirements.iter().map(|result| (result.id.clone(), result.verdict));
    stated.checks = checks.collect();
    stated.numerics = differs(summary.numerics);
    stated.seed = Some(summary.seed);
    stated.title = Some(summary.scenario);
    stated.run = Some(summary.stream_hash);
    stated.reasons = summary.reasons;
}

/// Reads the folder of a system of FMUs: its summary has no requirements.
fn of_system(document: &Value, stated: &mut FolderStatements) {
    let text = |name: &str| document.get(name).and_then(Value::as_str).map(str::to_owned);
    (stated.title, stated.run) = (text("system"), text("stream_hash"));
    stated.seed = document.get("seed").and_then(Value::as_u64);
    let said = text("verdict");
    let said = Verdict::ALL.into_iter().find(|v| said.as_deref() == Some(v.name()));
    let reasons = document.get("reasons").and_then(Value::as_array);
    let reasons = reasons.into_iter().flatten().filter_map(Value::as_str);
    stated.reasons = reasons.map(str::to_owned).collect();
    let faults = document.get("faults").and_then(Value::as_array);
    let silent = faults.into_iter().flatten().any(|fault| fault["fired"] == Value::Bool(false));
    let least = match document.pointer("/ended/how").and_then(Value::as_str) {
        Some("failed") => Verdict::Error,
        Some("interrupted") => Verdict::Inconclusive,
        _ if silent => Verdict::Inconclusive,
        _ => Verdict::None,
    };
    stated.verdict = Some(said.unwrap_or(Verdict::Error).worst(least));
    if stated.verdict != said {
        let said = said.map_or("no verdict", Verdict::name);
        stated.contradictions.push(format!(
            "{SUMMARY}: it says {said}, its end and its faults come to {}",
            stated.verdict.unwrap_or(Verdict::Error).name()
        ));
    }
}
