//! What a folder of evidence says of itself, and whether its parts agree.
//!
//! Hashes tell that nobody changed a file after the manifest was written. They don't tell that what was written
//! is true of itself: a summary whose verdict isn't that of its values, a recording that isn't the stream that
//! was summed up.

use super::files;
use super::manifest::Manifest;
use octant_recorder::reader::{Recording, stream_hash};
use octant_requirements::Verdict;
use octant_requirements::equipment::Day;
use octant_scenario::Scenario;
use octant_score::equipment;
use octant_score::judge::{Finding, derive};
use octant_score::numerics::{differs, in_words};
use octant_score::rederive;
use octant_score::summary::Summary;
use serde_json::Value;
use std::path::Path;

/// Name of the summary of a run.
pub const SUMMARY: &str = "summary.json";

/// What a folder holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inside {
    /// Title of the scenario, the system or the campaign.
    pub title: Option<String>,
    /// Seed of a run.
    pub seed: Option<u64>,
    /// Stream hash of a run, id of the plan of a campaign.
    pub run: Option<String>,
    /// Where its results have another numerics version than this program, what that means.
    pub numerics: Option<String>,
    /// What its contents come to, derived again where they can be.
    pub verdict: Option<Verdict>,
    /// Why, as it is told.
    pub reasons: Vec<String>,
    /// Its requirements with what each comes to.
    pub checks: Vec<(String, Verdict)>,
    /// Where its parts contradict each other, with the file's name in front.
    pub contradictions: Vec<String>,
}

/// Looks into the folder of a run. Nothing but regular files is opened.
#[must_use]
pub fn of_run(folder: &Path, manifest: &Manifest) -> Inside {
    let mut inside = Inside { seed: manifest.seed, ..Inside::default() };
    let path = folder.join(SUMMARY);
    let text = match files::read(&path).map(String::from_utf8) {
        Ok(Ok(text)) => text,
        Ok(Err(_)) => {
            inside.contradictions.push(format!("{SUMMARY}: it is no text"));
            return inside;
        }
        Err(error) => {
            inside.contradictions.push(format!("{SUMMARY}: {error}"));
            return inside;
        }
    };
    let document: Value = match serde_json::from_str(&text) {
        Ok(document) => document,
        Err(error) => {
            inside.contradictions.push(format!("{SUMMARY}: {error}"));
            return inside;
        }
    };
    if document.get("system").is_some() {
        of_system(&document, &mut inside);
    } else {
        match Summary::from_json(&text) {
            Ok(summary) => {
                if summary.numerics != manifest.numerics {
                    inside.contradictions.push(format!(
                        "{SUMMARY}: it has {}, manifest.json has {}",
                        in_words(summary.numerics),
                        in_words(manifest.numerics)
                    ));
                }
                of_equipment(folder, manifest, &summary, &mut inside);
                of_summary(folder, summary, &mut inside);
            }
            Err(error) => inside.contradictions.push(format!("{SUMMARY}: {error}")),
        }
    }
    if manifest.seed.is_some() && inside.seed != manifest.seed {
        let number = |seed: Option<u64>| seed.map_or("none".to_owned(), |seed| seed.to_string());
        inside.contradictions.push(format!(
            "{SUMMARY}: its seed is {}, that of the manifest {}",
            number(inside.seed),
            number(manifest.seed)
        ));
    }
    inside
}

/// Holds the certificates in a manifest against its own date: what they come to has to be in the summary.
fn of_equipment(folder: &Path, manifest: &Manifest, summary: &Summary, inside: &mut Inside) {
    let scenario = Scenario::load(&folder.join("scenario.toml"), &[]);
    // A scenario of an older form has no equipment; one that can't be read is told elsewhere.
    if let Ok(scenario) = scenario
        && scenario.equipment != manifest.equipment
    {
        inside
            .contradictions
            .push("manifest.json: its equipment isn't that of scenario.toml".to_owned());
    }
    match certified(manifest) {
        Ok(expected) => {
            let silent = expected.iter().filter(|finding| !summary.findings.contains(finding));
            inside.contradictions.extend(
                silent.map(|finding| format!("{SUMMARY}: it doesn't tell that {}", finding.reason)),
            );
        }
        Err(reason) => inside.contradictions.push(reason),
    }
}

/// What the equipment of a run comes to on the day on which it ended.
///
/// # Errors
/// In words, if the manifest has no such day.
pub(crate) fn certified(manifest: &Manifest) -> Result<Vec<Finding>, String> {
    if manifest.equipment.is_empty() {
        return Ok(Vec::new());
    }
    let ended = Day::of_text(&manifest.ended)
        .map_err(|reason| format!("manifest.json: ended: {reason}"))?;
    Ok(equipment::findings(&manifest.equipment, Some(&ended)))
}

fn of_summary(folder: &Path, summary: Summary, inside: &mut Inside) {
    let found = rederive::contradictions(&summary);
    inside.contradictions.extend(found.into_iter().map(|what| format!("{SUMMARY}: {what}")));
    inside.verdict = Some(derive(&summary).verdict);
    let baseline = summary.baseline.as_ref().map(|baseline| baseline.stream_hash.as_str());
    for (name, hash) in
        [("recording.mcap", Some(summary.stream_hash.as_str())), ("baseline.mcap", baseline)]
    {
        // A run can be told to record nothing, and a recording can hold every so many-th sample alone.
        let Some(hash) = hash else { continue };
        let Ok(file) = files::open(&folder.join(name)) else { continue };
        let found = Recording::new(std::io::BufReader::new(file)).and_then(stream_hash);
        match found {
            Err(error) => inside.contradictions.push(format!("{name}: {error}")),
            Ok(Some(found)) if found != hash => inside
                .contradictions
                .push(format!("{name}: its stream hash is {found}, that of {SUMMARY} {hash}")),
            Ok(_) => {}
        }
    }
    let checks = summary.requirements.iter().map(|result| (result.id.clone(), result.verdict));
    inside.checks = checks.collect();
    inside.numerics = differs(summary.numerics);
    inside.seed = Some(summary.seed);
    inside.title = Some(summary.scenario);
    inside.run = Some(summary.stream_hash);
    inside.reasons = summary.reasons;
}

/// A system of FMUs: its summary holds no requirements.
fn of_system(document: &Value, inside: &mut Inside) {
    let text = |name: &str| document.get(name).and_then(Value::as_str).map(str::to_owned);
    (inside.title, inside.run) = (text("system"), text("stream_hash"));
    inside.seed = document.get("seed").and_then(Value::as_u64);
    let said = text("verdict");
    let said = Verdict::ALL.into_iter().find(|v| said.as_deref() == Some(v.name()));
    let reasons = document.get("reasons").and_then(Value::as_array);
    let reasons = reasons.into_iter().flatten().filter_map(Value::as_str);
    inside.reasons = reasons.map(str::to_owned).collect();
    let faults = document.get("faults").and_then(Value::as_array);
    let silent = faults.into_iter().flatten().any(|fault| fault["fired"] == Value::Bool(false));
    let least = match document.pointer("/ended/how").and_then(Value::as_str) {
        Some("failed") => Verdict::Error,
        Some("interrupted") => Verdict::Inconclusive,
        _ if silent => Verdict::Inconclusive,
        _ => Verdict::None,
    };
    inside.verdict = Some(said.unwrap_or(Verdict::Error).worst(least));
    if inside.verdict != said {
        let said = said.map_or("no verdict", Verdict::name);
        inside.contradictions.push(format!(
            "{SUMMARY}: it says {said}, its end and its faults come to {}",
            inside.verdict.unwrap_or(Verdict::Error).name()
        ));
    }
}
