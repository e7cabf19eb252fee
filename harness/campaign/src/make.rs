//! Builds the plan of a campaign file: every combination of scenarios, factors and replicates.

use super::case_id::{CaseId, NoCaseId};
use super::draw::At;
use super::factor_values::FactorValue;
use super::plan::{CASES_MAX, Case, Plan, PlanError, PlannedScenario, SCHEMA, StopRule, system};
use super::requirements::{self, Planned};
use super::shared::{SharedText, SharedTexts};
use super::shared_cases::SharedParts;
use octant_scenario::Scenario;
use octant_scenario::campaign::{Campaign, FactorSpec, Levels, Member};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// Returns the level of a factor in a cell of the grid; the last factor runs fastest.
fn level_of(factors: &[FactorSpec], cell: u64, index: usize) -> usize {
    let levels = |factor: &FactorSpec| factor.levels.grid().map_or(1, |levels| levels as u64);
    let faster: u64 = factors.iter().skip(index + 1).map(levels).product();
    factors.get(index).map_or(0, |factor| (cell / faster % levels(factor)) as usize)
}

impl Plan {
    /// Builds the plan of a campaign file.
    ///
    /// # Errors
    /// If the campaign, one of its scenarios or one of its cases isn't valid.
    pub fn of(path: &Path) -> Result<Self, PlanError> {
        let campaign = Campaign::load(path)?;
        let contradiction =
            |reason: String| PlanError::Contradiction { campaign: path.to_owned(), reason };
        let grid: u64 =
            campaign.factors.iter().filter_map(|f| f.levels.grid()).map(|n| n as u64).product();
        let count = grid
            .saturating_mul(u64::from(campaign.replicates))
            .saturating_mul(campaign.scenarios.len() as u64);
        if count > CASES_MAX {
            return Err(contradiction(format!(
                "it has {count} cases, at most {CASES_MAX} are expected"
            )));
        }
        if let Some(reason) = campaign.factors.iter().find_map(equal_values) {
            return Err(contradiction(reason));
        }
        let draws = super::draw::draws(&campaign).map_err(&contradiction)?;
        let file = campaign.requirements.as_deref().map(requirements::load).transpose()?;
        let of_file = file.as_ref().map(requirements::planned).unwrap_or_default();
        let by_test = |id: &str| of_file.iter().any(|planned| planned.check.id == id);
        let not_by_test: Vec<String> = (file.iter().flat_map(|file| &file.requirements))
            .filter(|requirement| !by_test(&requirement.id))
            .map(|requirement| requirement.id.clone())
            .collect();
        let scenarios = (campaign.scenarios.iter())
            .map(|member| planned(member, &of_file, path))
            .collect::<Result<Vec<_>, _>>()?;
        let mut cases = Vec::with_capacity(usize::try_from(count).unwrap_or(0));
        let mut parts = SharedParts::default();
        // Additional replicates come at the end.
        for replicate in 0..campaign.replicates {
            for (member, planned) in campaign.scenarios.iter().zip(&scenarios) {
                for cell in 0..grid {
                    let (mut set, mut faults) = (member.set.clone(), None);
                    let mut values = Vec::new();
                    for (index, factor) in campaign.factors.iter().enumerate() {
                        let at = match factor.levels.grid() {
                            Some(_) => At::Level(level_of(&campaign.factors, cell, index)),
                            None => draws.at(index, replicate),
                        };
                        values.extend(give(&mut set, &mut faults, factor, at));
                    }
                    let seed = campaign.seed.wrapping_add(u64::from(replicate));
                    let set: SharedTexts = set.into_iter().collect();
                    let id = id_of(planned, &set, faults.as_ref(), seed).map_err(&contradiction)?;
                    cases.push(parts.share(Case {
                        id,
                        scenario: member.id.as_str().into(),
                        seed,
                        replicate,
                        set,
                        faults,
                        factors: values.into_iter().collect(),
                    }));
                }
            }
        }
        if let Some([other, case]) = same(&cases) {
            return Err(contradiction(format!(
                "scenario {:?} and scenario {:?} give the same case {}: expected something that \
                 differs between them",
                other.scenario, case.scenario, case.id
            )));
        }
        if let Some(stop) = &campaign.stop
            && !scenarios.iter().any(|s| s.requirements.contains(&stop.requirement))
        {
            return Err(contradiction(format!(
                "stop.requirement is {:?}, and no scenario checks it",
                stop.requirement
            )));
        }
        let mut plan = Self {
            schema: SCHEMA,
            id: String::new(),
            title: campaign.title,
            campaign: absolute(path)?,
            limits: campaign.limits.into(),
            stop: campaign.stop.map(StopRule::from),
            factors: campaign.factors.iter().map(|factor| factor.name.clone()).collect(),
            requirements: of_file,
            not_by_test,
            bundled: None,
            scenarios,
            cases,
        };
        plan.check_cases()?;
        plan.id = plan.hash();
        Ok(plan)
    }
}

/// Finds the first case that was there before, with the one before it.
fn same(cases: &[Case]) -> Option<[&Case; 2]> {
    // A list: a map of the ids would take more memory than the cases.
    let mut order: Vec<u32> = (0..).take(cases.len()).collect();
    let id = |at: &u32| cases.get(*at as usize).map(|case| case.id);
    order.sort_unstable_by_key(|at| (id(at), *at));
    let pairs = order.windows(2).filter(|pair| id(&pair[0]) == id(&pair[1]));
    let first = pairs.min_by_key(|pair| pair[1])?;
    Some([cases.get(first[0] as usize)?, cases.get(first[1] as usize)?])
}

/// Finds two values of a grid that are equal in another spelling: they would be the same runs under
/// two names.
fn equal_values(factor: &FactorSpec) -> Option<String> {
    let spelled: Vec<(String, String)> = match &factor.levels {
        Levels::Values { values, drawn: false, .. } => {
            values.iter().map(|value| (value.clone(), meaning(value))).collect()
        }
        Levels::Faults { lists, drawn: false, .. } => (lists.iter())
            .map(|list| {
                let mut sorted = list.clone();
                sorted.sort();
                sorted.dedup();
                (format!("{list:?}"), format!("{sorted:?}"))
            })
            .collect(),
        _ => return None,
    };
    let mut seen: HashMap<&str, &str> = HashMap::new();
    spelled.iter().find_map(|(value, meaning)| {
        let other = seen.insert(meaning, value)?;
        Some(format!(
            "factor {:?} has the values {other} and {value}, which are the same: expected values that differ",
            factor.name
        ))
    })
}

/// Normalises a TOML value: numbers without their spelling, quantities in SI.
fn meaning(value: &str) -> String {
    fn of(value: &toml::Value) -> String {
        match value {
            toml::Value::Integer(number) => format!("{:?}", *number as f64 + 0.0),
            toml::Value::Float(number) => format!("{:?}", number + 0.0),
            toml::Value::String(text) => match octant_scenario::quantity_of(text) {
                // Twelve decimals hide the rounding of the conversion: 1 deg equals 60 arcmin.
                Ok(quantity) => format!("{:.12e} in SI", quantity.si + 0.0),
                Err(_) => format!("{:?}", text.trim()),
            },
            toml::Value::Array(all) => format!("{:?}", all.iter().map(of).collect::<Vec<_>>()),
            toml::Value::Table(all) => {
                let all: BTreeMap<&String, String> = all.iter().map(|(k, v)| (k, of(v))).collect();
                format!("{all:?}")
            }
            toml::Value::Boolean(value) => value.to_string(),
            toml::Value::Datetime(value) => value.to_string(),
        }
    }
    let parsed = format!("value = {value}").parse::<toml::Table>();
    let parsed = parsed.ok().and_then(|table| table.get("value").map(of));
    parsed.unwrap_or_else(|| value.trim().to_owned())
}

fn absolute(path: &Path) -> Result<PathBuf, PlanError> {
    system("find", path, std::path::absolute(path))
}

fn planned(
    member: &Member,
    of_file: &[Planned],
    campaign: &Path,
) -> Result<PlannedScenario, PlanError> {
    let contradiction =
        |reason: String| PlanError::Contradiction { campaign: campaign.to_owned(), reason };
    let bytes = system("read", &member.file, std::fs::read(&member.file))?;
    let base = Scenario::load(&member.file, &member.set)?;
    if let Some(piece) = base.equipment.first() {
        return Err(contradiction(format!(
            "scenario {:?} has equipment of a bench ({}), whose certificates are held against the day of a run; \
             cases of a campaign have none: expected no [[equipment]]",
            member.id,
            piece.named()
        )));
    }
    let named = member.verifies.iter().flatten();
    if let Some(unknown) = named.clone().find(|id| !of_file.iter().any(|p| p.check.id == **id)) {
        let known = of_file.iter().map(|planned| planned.check.id.as_str());
        let known = octant_base::names::suggestion(unknown, known, "verified by test");
        return Err(contradiction(format!(
            "scenario {:?} verifies {unknown:?}, which the requirements don't have, {known}",
            member.id
        )));
    }
    let wanted = |id: &String| member.verifies.as_ref().is_none_or(|ids| ids.contains(id));
    let mut requirements: Vec<String> =
        base.requirements.iter().map(|own| own.check.id.clone()).collect();
    let mut checks = Vec::new();
    for Planned { check, .. } in of_file {
        let own = base.requirements.iter().find(|own| own.check.id == check.id);
        match own {
            Some(own) if own.check != *check => {
                return Err(contradiction(format!(
                    "requirement {:?} is one thing in scenario {:?} and another in the file of \
                     requirements: {} {} {} and {} {} {}",
                    check.id,
                    member.id,
                    own.check.measure,
                    own.check.comparison.sign(),
                    own.check.limit,
                    check.measure,
                    check.comparison.sign(),
                    check.limit
                )));
            }
            Some(_) => {}
            None if wanted(&check.id) => {
                requirements.push(check.id.clone());
                checks.push(check.clone());
            }
            None => {}
        }
    }
    Ok(PlannedScenario {
        id: member.id.clone(),
        file: absolute(&member.file)?,
        blake3: blake3::hash(&bytes).to_hex().to_string(),
        requirements,
        checks,
        files: BTreeMap::new(),
    })
}

/// Sets a factor in a case, and returns its name and its value there.
fn give(
    set: &mut Vec<String>,
    faults: &mut Option<SharedTexts>,
    factor: &FactorSpec,
    at: At,
) -> Option<(SharedText, FactorValue)> {
    let value = match (&factor.levels, at) {
        (Levels::Values { key, values, .. }, At::Level(level)) => {
            set.push(format!("{key}={}", values[level]));
            plain(&values[level])
        }
        (Levels::Faults { lists, .. }, At::Level(level)) => {
            let list = &lists[level];
            *faults = Some(list.iter().map(String::as_str).collect());
            FactorValue::Text(if list.is_empty() { "none".into() } else { list.join(" ").into() })
        }
        (Levels::Distributed { key, unit, .. }, At::Number(number)) => {
            set.push(match unit {
                Some(unit) => format!("{key}=\"{number} {unit}\""),
                None => format!("{key}={number:?}"),
            });
            FactorValue::Number(number)
        }
        // Levels and draws come from the same factor.
        (_, At::Level(_) | At::Number(_)) => return None,
    };
    Some((factor.name.as_str().into(), value))
}

/// Converts a TOML value for statistics: a number, or a text, which includes quantities.
fn plain(value: &str) -> FactorValue {
    let text = value.trim().trim_matches('"');
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    number.map_or_else(|| FactorValue::Text(text.into()), FactorValue::Number)
}

/// Computes the BLAKE3 of everything that defines a case, hexadecimal.
#[must_use]
pub fn hash_of(scenario: &PlannedScenario, case: &Case) -> String {
    hash(scenario, &case.set, case.faults.as_ref(), case.seed)
}

fn hash(
    scenario: &PlannedScenario,
    set: &SharedTexts,
    faults: Option<&SharedTexts>,
    seed: u64,
) -> String {
    // One JSON text: different cases never give the same text.
    let content = serde_json::json!([scenario.blake3, scenario.checks, set, faults, seed]);
    blake3::hash(content.to_string().as_bytes()).to_hex().to_string()
}

/// Returns the id of a case, or the reason why there is none, as text.
fn id_of(
    scenario: &PlannedScenario,
    set: &SharedTexts,
    faults: Option<&SharedTexts>,
    seed: u64,
) -> Result<CaseId, String> {
    hash(scenario, set, faults, seed)[..16].parse().map_err(|error: NoCaseId| error.to_string())
}
