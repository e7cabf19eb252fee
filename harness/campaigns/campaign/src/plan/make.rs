//! Builds the plan of a campaign file: every combination of scenarios, factors and replicates.

use super::case_id::{CaseId, NoCaseId};
use super::draw::{At, Draws};
use super::equal_values::equal_values;
use super::factor_values::FactorValue;
use super::looks::Looks;
use super::possible::{key_of, why_not};
use super::progress::{PlanStage, Tell, told};
use super::requirements::{self, Planned};
use super::seed::seed_of;
use super::shared::{SharedText, SharedTexts};
use super::shared_cases::SharedParts;
use crate::plan::{CASES_MAX, Case, Plan, PlanError, PlannedScenario, SCHEMA, StopRule, system};
use octant_account::Account;
use octant_scenario::Scenario;
use octant_scenario::campaign::{Campaign, FactorSpec, Levels, Member};
use octant_verdict::verdict::LimitCheck;
use serde::{Serialize, Serializer};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Returns the level of a factor in a cell of the grid; the last factor runs fastest.
fn level_of(factors: &[FactorSpec], cell: u64, index: usize) -> usize {
    let levels = |factor: &FactorSpec| factor.levels.grid().map_or(1, |levels| levels as u64);
    let faster: u64 = factors.iter().skip(index + 1).map(levels).product();
    factors.get(index).map_or(0, |factor| (cell / faster % levels(factor)) as usize)
}

/// A campaign file, from which the cases of a plan are made.
pub(super) struct PlanMaker {
    pub(super) campaign: Campaign,
    /// Seed of the draws, and of the first replicate.
    seed: u64,
    path: PathBuf,
    /// Number of cells of the grid.
    pub(super) grid: u64,
    /// Number of cases.
    count: u64,
    pub(super) draws: Draws,
    of_file: Vec<Planned>,
    not_by_test: Vec<String>,
    accounts: Vec<Account>,
    pub(super) scenarios: Vec<PlannedScenario>,
}

impl PlanMaker {
    fn of(path: &Path) -> Result<Self, PlanError> {
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
        let seeds = |factor: &&FactorSpec| key_of(&factor.levels) == Some("seed");
        if let Some(factor) = campaign.factors.iter().find(seeds) {
            return Err(contradiction(format!(
                "factor {:?} sets seed, which the campaign gives to each case: expected another key, or more replicates",
                factor.name
            )));
        }
        let sets = |member: &&Member| member.set.iter().any(|set| set.starts_with("seed="));
        if let Some(member) = campaign.scenarios.iter().find(sets) {
            return Err(contradiction(format!(
                "scenario {:?} sets seed, which the campaign gives to each case: expected seed of the campaign",
                member.id
            )));
        }
        let file = campaign.requirements.as_deref().map(requirements::load).transpose()?;
        let of_file = file.as_ref().map(requirements::planned).unwrap_or_default();
        let by_test = |id: &str| of_file.iter().any(|planned| planned.check.id == id);
        let not_by_test: Vec<String> = (file.iter().flat_map(|file| &file.requirements))
            .filter(|requirement| !by_test(&requirement.id))
            .map(|requirement| requirement.id.clone())
            .collect();
        let scenarios = (campaign.scenarios.iter())
            .map(|member| planned(member, &of_file, &campaign.factors, path))
            .collect::<Result<Vec<_>, _>>()?;
        let stop = campaign.stop.clone().map(StopRule::from);
        let factors: Vec<String> = factor_names(&campaign);
        let looks = Looks::from(campaign.looks);
        let seed = campaign.seed.unwrap_or_else(|| {
            seed_of(&scenarios, (&of_file, &not_by_test), &factors, &stop, looks)
        });
        let draws = super::draw::draws(&campaign, seed).map_err(&contradiction)?;
        let path = path.to_owned();
        let accounts = file.map(|file| file.accounts).unwrap_or_default();
        Ok(Self {
            campaign,
            seed,
            path,
            grid,
            count,
            draws,
            of_file,
            not_by_test,
            accounts,
            scenarios,
        })
    }

    /// Makes the cases one after another. Additional replicates come at the end.
    fn cases(&self) -> impl Iterator<Item = Result<Case, PlanError>> {
        let members = || self.campaign.scenarios.iter().zip(&self.scenarios);
        (0..self.campaign.replicates).flat_map(move |replicate| {
            members().flat_map(move |(member, planned)| {
                (0..self.grid).map(move |cell| {
                    let drawn = |index| self.draws.at(index, replicate);
                    self.case_with(replicate, member, planned, cell, drawn)
                })
            })
        })
    }

    /// Makes a case of a cell of the grid; `drawn` are the draws by the index of the factor.
    pub(super) fn case_with(
        &self,
        replicate: u32,
        member: &Member,
        planned: &PlannedScenario,
        cell: u64,
        drawn: impl Fn(usize) -> At,
    ) -> Result<Case, PlanError> {
        let (mut set, mut faults) = (member.set.clone(), None);
        let mut values = Vec::new();
        let factors = &self.campaign.factors;
        for (index, factor) in factors.iter().enumerate() {
            let at = match factor.levels.grid() {
                Some(_) => At::Level(level_of(factors, cell, index)),
                None => drawn(index),
            };
            values.extend(give(&mut set, &mut faults, factor, at));
        }
        let seed = self.seed.wrapping_add(u64::from(replicate));
        let set: SharedTexts = set.into_iter().collect();
        let id = id_of(planned, &set, faults.as_ref(), seed);
        Ok(Case {
            id: id.map_err(|reason| self.contradiction(reason))?,
            scenario: member.id.as_str().into(),
            seed,
            replicate,
            set,
            faults,
            factors: values.into_iter().collect(),
        })
    }

    fn contradiction(&self, reason: String) -> PlanError {
        PlanError::Contradiction { campaign: self.path.clone(), reason }
    }

    /// Makes the plan without its cases, and without an id.
    fn head(&self) -> Result<Plan, PlanError> {
        let campaign = &self.campaign;
        Ok(Plan {
            schema: SCHEMA,
            id: String::new(),
            title: campaign.title.clone(),
            campaign: absolute(&self.path)?,
            limits: campaign.limits.into(),
            stop: campaign.stop.clone().map(StopRule::from),
            looks: Looks::from(campaign.looks),
            seed_from_plan: campaign.seed.is_none(),
            factors: factor_names(campaign),
            requirements: self.of_file.clone(),
            not_by_test: self.not_by_test.clone(),
            accounts: self.accounts.clone(),
            bundled: None,
            copies: None,
            scenarios: self.scenarios.clone(),
            cases: Vec::new(),
        })
    }

    /// Checks that no two cases are the same, and that a requirement that stops the campaign is checked.
    fn check(&self, cases: &[Case]) -> Result<(), PlanError> {
        if let Some([other, case]) = same(cases) {
            return Err(self.contradiction(format!(
                "scenario {:?} and scenario {:?} give the same case {}: expected something that \
                 differs between them",
                other.scenario, case.scenario, case.id
            )));
        }
        if let Some(stop) = &self.campaign.stop
            && !self.scenarios.iter().any(|s| s.requirements.contains(&stop.requirement))
        {
            return Err(self.contradiction(format!(
                "stop.requirement is {:?}, and no scenario checks it",
                stop.requirement
            )));
        }
        Ok(())
    }
}

fn factor_names(campaign: &Campaign) -> Vec<String> {
    campaign.factors.iter().map(|factor| factor.name.clone()).collect()
}

/// Cases that come one after another while they are written.
struct CaseStream<I>(RefCell<I>);

impl<I: Iterator<Item: Serialize>> Serialize for CaseStream<I> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&mut *self.0.borrow_mut())
    }
}

impl Plan {
    /// Builds the plan of a campaign file.
    ///
    /// # Errors
    /// If the campaign, one of its scenarios or one of its cases isn't valid.
    pub fn of(path: &Path) -> Result<Self, PlanError> {
        Self::of_told(path, &|_, _, _| ())
    }

    /// Builds the plan of a campaign file, and tells how far it is.
    ///
    /// # Errors
    /// As [`Plan::of`].
    pub fn of_told(path: &Path, tell: Tell<'_>) -> Result<Self, PlanError> {
        let maker = PlanMaker::of(path)?;
        let count = usize::try_from(maker.count).unwrap_or(0);
        let mut cases = Vec::with_capacity(count);
        let mut parts = SharedParts::default();
        for case in told(maker.cases(), PlanStage::Making, count, tell) {
            cases.push(parts.share(case?));
        }
        maker.check(&cases)?;
        let head = maker.head()?;
        maker.check_set_up(&head, &cases, tell)?;
        let hashed = told(cases.iter(), PlanStage::Hashing, count, tell);
        let id = head.hash_with(&CaseStream(RefCell::new(hashed)));
        Ok(Self { id, cases, ..head })
    }

    /// Returns whether a campaign file gives this plan, without a second list of its cases.
    #[must_use]
    pub fn is_of(&self, path: &Path) -> bool {
        let is_same = || -> Result<bool, PlanError> {
            let maker = PlanMaker::of(path)?;
            let head = maker.head()?;
            // A case that can't be made ends the list, which then has another hash.
            let cases = RefCell::new(maker.cases().map_while(Result::ok));
            if head.hash_with(&CaseStream(cases)) != self.id {
                return Ok(false);
            }
            maker.check(&self.cases)?;
            maker.check_set_up(&head, &self.cases, &|_, _, _| ()).map(|()| true)
        };
        is_same().unwrap_or(false)
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

fn absolute(path: &Path) -> Result<PathBuf, PlanError> {
    system("find", path, std::path::absolute(path))
}

fn planned(
    member: &Member,
    of_file: &[Planned],
    factors: &[FactorSpec],
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
    if let Some(step) = base.operator.first() {
        return Err(contradiction(format!(
            "scenario {:?} asks a person (step {:?}), and nobody is at a case of a campaign: expected no [[operator]]",
            member.id, step.id
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
    let own = base.requirements.iter().map(|own| &own.check);
    if let Some(reason) = own.chain(&checks).find_map(|check| why_not(&base, check, factors)) {
        return Err(contradiction(format!("scenario {:?}: {reason}", member.id)));
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
    thread_local! {
        /// Beginnings for the settings of cases that came last: those of a plan share few.
        static LAST: RefCell<[Option<HashBegin>; 16]> = const { RefCell::new([const { None }; 16]) };
    }
    LAST.with_borrow_mut(|last| {
        let place = case.set.as_ptr() as usize / size_of::<SharedText>() % last.len();
        let slot = &mut last[place];
        let begin = match slot {
            Some(begin) if begin.is_of(scenario, case) => begin,
            _ => slot.insert(HashBegin::of(scenario, case)),
        };
        hash(&begin.text, case.seed)
    })
}

/// Everything that defines cases but their seeds.
struct HashBegin {
    scenario: String,
    checks: Vec<LimitCheck>,
    set: SharedTexts,
    faults: Option<SharedTexts>,
    text: String,
}

impl HashBegin {
    fn of(scenario: &PlannedScenario, case: &Case) -> Self {
        Self {
            scenario: scenario.blake3.clone(),
            checks: scenario.checks.clone(),
            set: case.set.clone(),
            faults: case.faults.clone(),
            text: begin(scenario, &case.set, case.faults.as_ref()),
        }
    }

    /// Returns whether a case has the same settings; without a comparison of texts that aren't shared.
    fn is_of(&self, scenario: &PlannedScenario, case: &Case) -> bool {
        let same_faults = match (&self.faults, &case.faults) {
            (None, None) => true,
            (Some(one), Some(other)) => one.is_shared(other),
            _ => false,
        };
        same_faults
            && self.set.is_shared(&case.set)
            && self.scenario == scenario.blake3
            && self.checks == scenario.checks
    }
}

/// Begins the JSON text of everything that defines a case: its seed follows, and a bracket. Different cases never give
/// the same text.
fn begin(scenario: &PlannedScenario, set: &SharedTexts, faults: Option<&SharedTexts>) -> String {
    let mut text = serde_json::json!([scenario.blake3, scenario.checks, set, faults]).to_string();
    // The bracket at the end.
    text.pop();
    text + ","
}

fn hash(begin: &str, seed: u64) -> String {
    blake3::hash(format!("{begin}{seed}]").as_bytes()).to_hex().to_string()
}

/// Returns the id of a case, or the reason why there is none, as text.
fn id_of(
    scenario: &PlannedScenario,
    set: &SharedTexts,
    faults: Option<&SharedTexts>,
    seed: u64,
) -> Result<CaseId, String> {
    let hash = hash(&begin(scenario, set, faults), seed);
    hash[..16].parse().map_err(|error: NoCaseId| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_of_a_case_is_that_of_its_text() {
        let scenario = PlannedScenario {
            id: "a".to_owned(),
            file: PathBuf::new(),
            blake3: "00ff".to_owned(),
            requirements: Vec::new(),
            checks: Vec::new(),
            files: BTreeMap::new(),
        };
        let case = |set: &str, faults: Option<&str>, seed| Case {
            id: "00ff00ff00ff00ff".parse().unwrap(),
            scenario: "a".into(),
            seed,
            replicate: 0,
            set: [set].into_iter().collect(),
            faults: faults.map(|faults| [faults].into_iter().collect()),
            factors: std::iter::empty().collect(),
        };
        let expected = |case: &Case, blake3: &str| {
            let content = serde_json::json!([blake3, [], case.set, case.faults, case.seed]);
            blake3::hash(content.to_string().as_bytes()).to_hex().to_string()
        };
        let one = case("x=\"ü\"", None, 7);
        let other = PlannedScenario { blake3: "ff00".to_owned(), ..scenario.clone() };
        let more = [Case { seed: u64::MAX, ..one.clone() }, case("x=1", Some("b"), 7)];
        // More settings than are remembered, and the first ones again.
        let many: Vec<Case> = (0..100).map(|k| case(&k.to_string(), None, k)).collect();
        for case in [&one, &more[0], &more[1]].into_iter().chain(&many).chain([&one]) {
            assert_eq!(hash_of(&scenario, case), expected(case, "00ff"));
            assert_eq!(hash_of(&other, case), expected(case, "ff00"));
        }
    }
}
