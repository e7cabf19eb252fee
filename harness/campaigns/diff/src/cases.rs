//! Two campaigns, compared over their pairs of cases: the same scenario, seed, replicate and factors.

use super::SCHEMA;
use super::error::DiffError;
use super::settings::{SettingDiff, compare};
use octant_campaign::plan;
use octant_evidence::Manifest;
use octant_evidence::manifest::Machine;
use octant_nightly::compare::{self as nights, Change, NightComparison, Side, Thresholds};
use octant_nightly::night::{self, CampaignNight, Night, Program};
use octant_nightly::results::{self, CaseRow};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// Name under which both campaigns are compared.
const NAME: &str = "campaign";

/// Origin of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CampaignAbout {
    /// Folder.
    pub path: PathBuf,
    /// Program that ran it, as text; null without a manifest.
    pub program: Option<String>,
    /// Id of its plan; null without a plan.
    pub plan: Option<String>,
    /// Number of cases.
    pub cases: usize,
}

/// Streams of the pairs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PairedStreams {
    /// Number of pairs with a stream hash in both campaigns.
    pub pairs: usize,
    /// Number of those whose hashes differ.
    pub differing: usize,
    /// First case of the second campaign with another stream; null if there is none.
    pub first: Option<String>,
}

/// Measure of every pair: for a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct PairedMeasure {
    /// Path of the measure.
    pub measure: String,
    /// Scenario.
    pub scenario: String,
    /// Values of the first and the second campaign.
    pub values: Vec<(f64, f64)>,
}

/// Difference between two campaigns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CampaignDiff {
    /// Version of this form.
    pub schema: u32,
    /// True if both have the same cases with the same results.
    pub equal: bool,
    /// The two campaigns.
    pub campaigns: [CampaignAbout; 2],
    /// Differences between the plans, without their cases.
    pub settings: Vec<SettingDiff>,
    /// Streams of the pairs.
    pub streams: PairedStreams,
    /// Paired tests; the first campaign is the `baseline`, the second `tonight`.
    pub comparison: NightComparison,
    /// Values of the measures that a test found different.
    #[serde(skip)]
    pub measures: Vec<PairedMeasure>,
}

impl CampaignDiff {
    /// Compares two campaigns.
    ///
    /// # Errors
    /// If the tables of one can't be read.
    pub fn of(first: &Path, second: &Path) -> Result<Self, DiffError> {
        let rows = [first, second].map(results::read);
        let [of_first, of_second] = rows;
        let (of_first, of_second) = (of_first?, of_second?);
        let plans = [plan(first)?, plan(second)?];
        let sides = [(first, &of_first, &plans[0]), (second, &of_second, &plans[1])];
        let nights = sides.map(|(path, _, plan)| as_night(path, plan.as_ref()));
        let campaigns = [0, 1].map(|i| {
            let (path, rows, plan) = sides[i];
            CampaignAbout {
                path: path.to_owned(),
                program: Manifest::read(path).ok().map(|_| nights[i].program.in_words()),
                plan: plan.as_ref().map(|plan| plan.id.clone()),
                cases: rows.len(),
            }
        });
        let settings = match &plans {
            [Some(one), Some(other)] => compare(&settings_of(one), &settings_of(other)),
            _ => Vec::new(),
        };
        let [named_first, named_second] =
            [&of_first, &of_second].map(|rows| BTreeMap::from([(NAME.to_owned(), rows.clone())]));
        let comparison = nights::compare(
            Side { night: &nights[0], rows: &named_first },
            Side { night: &nights[1], rows: &named_second },
            Thresholds::default(),
            &|_, case| format!("case {case} of {}", second.display()),
        );
        let pairs = pairs(&of_first, &of_second);
        let streams = streams(&pairs);
        let measures = measures(&comparison, &pairs);
        let equal = settings.is_empty()
            && streams.differing == 0
            && comparison.pairings.iter().all(|pairing| {
                pairing.changed_results == 0
                    && pairing.cases == pairing.pairs
                    && pairing.baseline_cases == pairing.pairs
            });
        Ok(Self { schema: SCHEMA, equal, campaigns, settings, streams, comparison, measures })
    }
}

fn plan(folder: &Path) -> Result<Option<plan::Plan>, DiffError> {
    let path = folder.join(plan::FILE_NAME);
    if !path.is_file() {
        return Ok(None);
    }
    let wrong = |reason: String| DiffError::File { path: path.clone(), reason };
    plan::Plan::read(&path).map(Some).map_err(|error| wrong(error.to_string()))
}

/// Plan without its cases and what follows from them, as a table for the comparison of settings.
fn settings_of(plan: &plan::Plan) -> toml::Table {
    let mut document = serde_json::to_value(plan).unwrap_or_default();
    if let Some(parts) = document.as_object_mut() {
        for name in ["cases", "id", "campaign", "schema"] {
            parts.remove(name);
        }
        // A scenario is named by its hash: the same file may stand elsewhere.
        let scenarios = parts.get_mut("scenarios").and_then(serde_json::Value::as_array_mut);
        for scenario in scenarios.into_iter().flatten() {
            scenario.as_object_mut().map(|scenario| scenario.remove("file"));
        }
    }
    match as_toml(&document) {
        Some(toml::Value::Table(table)) => table,
        _ => toml::Table::new(),
    }
}

/// JSON as TOML, which has no null.
fn as_toml(value: &serde_json::Value) -> Option<toml::Value> {
    Some(match value {
        serde_json::Value::Null => return None,
        serde_json::Value::Bool(value) => (*value).into(),
        serde_json::Value::Number(number) => match number.as_i64() {
            Some(number) => number.into(),
            None => number.as_f64()?.into(),
        },
        serde_json::Value::String(text) => text.as_str().into(),
        serde_json::Value::Array(all) => {
            toml::Value::Array(all.iter().filter_map(as_toml).collect())
        }
        serde_json::Value::Object(parts) => toml::Value::Table(
            parts.iter().filter_map(|(name, part)| Some((name.clone(), as_toml(part)?))).collect(),
        ),
    })
}

/// Campaign as a night with nothing else, which the nightly regression compares.
fn as_night(folder: &Path, plan: Option<&plan::Plan>) -> Night {
    let manifest = Manifest::read(folder).ok();
    let unknown = || Program {
        octant: "of an unknown version".to_owned(),
        numerics: None,
        git: None,
        rustc: None,
        lock_file: None,
        // Programs that aren't known aren't the same one.
        sha256: folder.display().to_string(),
        target: String::new(),
    };
    let program = manifest.as_ref().map_or_else(unknown, |manifest| Program {
        octant: manifest.octant.clone(),
        numerics: manifest.numerics,
        git: manifest.git.clone(),
        rustc: manifest.rustc.clone(),
        lock_file: manifest.lock_file.clone(),
        sha256: manifest.program_sha256.clone().unwrap_or_else(|| folder.display().to_string()),
        target: format!("{} {}", manifest.host.os, manifest.host.arch),
    });
    Night {
        schema: night::SCHEMA,
        id: folder.display().to_string(),
        started: String::new(),
        ended: None,
        program,
        host: manifest.map_or_else(Machine::this, |manifest| manifest.host),
        suite_blake3: None,
        suite: Vec::new(),
        campaigns: vec![CampaignNight {
            name: NAME.to_owned(),
            title: plan.map_or_else(String::new, |plan| plan.title.clone()),
            plan: plan.map_or_else(String::new, |plan| plan.id.clone()),
            verdict: None,
            requirements: BTreeMap::new(),
            differing: Vec::new(),
        }],
    }
}

fn pairs<'a>(first: &'a [CaseRow], second: &'a [CaseRow]) -> Vec<(&'a CaseRow, &'a CaseRow)> {
    let of_first: HashMap<&str, &CaseRow> =
        first.iter().map(|row| (row.pair.as_str(), row)).collect();
    second.iter().filter_map(|row| Some((*of_first.get(row.pair.as_str())?, row))).collect()
}

fn streams(pairs: &[(&CaseRow, &CaseRow)]) -> PairedStreams {
    let hash = |row: &CaseRow| {
        row.row.iter().find(|(name, _)| name == "stream_hash").map(|(_, hash)| hash.clone())
    };
    let mut all = PairedStreams::default();
    for (one, other) in pairs {
        let (Some(first), Some(second)) = (hash(one), hash(other)) else { continue };
        all.pairs += 1;
        if first != second {
            all.differing += 1;
            all.first.get_or_insert_with(|| other.case.clone());
        }
    }
    all
}

/// Collects the values of measures that differ in some pair.
fn measures(comparison: &NightComparison, pairs: &[(&CaseRow, &CaseRow)]) -> Vec<PairedMeasure> {
    let differs = comparison.tests.iter().filter(|test| test.change != Change::Same);
    differs
        .filter_map(|test| {
            let of_scenario = pairs.iter().filter(|(_, row)| row.scenario == test.scenario);
            let values: Vec<(f64, f64)> = of_scenario
                .filter_map(|(one, other)| {
                    let value = |row: &CaseRow| row.measures.get(&test.measure).copied();
                    value(one).zip(value(other))
                })
                .collect();
            (!values.is_empty()).then(|| PairedMeasure {
                measure: test.measure.clone(),
                scenario: test.scenario.clone(),
                values,
            })
        })
        .collect()
}
