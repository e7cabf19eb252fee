//! Plan: the list of a campaign's cases, each with an id derived from its content.
//!
//! A plan never changes after it is made. A campaign that grows makes another plan, in which every
//! earlier case keeps its id.

pub mod case_id;
mod draw;
mod equal_values;
mod error;
pub mod factor_values;
mod looked;
pub mod looks;
pub(crate) mod make;
pub mod planned;
mod possible;
pub mod progress;
pub mod requirements;
mod seed;
mod set_up;
pub(crate) mod shard;
pub mod shared;
mod shared_cases;

pub(crate) use error::system;
pub use error::{PlanError, short};
pub use planned::{Case, INPUTS, PlannedFile, PlannedScenario};

use crate::journal::{Journal, JournalEvent};
use case_id::CaseId;
use looks::Looks;
use octant_account::Account;
use octant_scenario::campaign::{LimitsSpec, StopSpec};
use octant_statistics::proportion::Demand;
use octant_verdict::requirement::EnsembleRequirement;
use requirements::Planned;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

/// Version of `plan.json`.
pub const SCHEMA: u32 = 1;
/// Name of a plan in the folder of its campaign.
pub const FILE_NAME: &str = "plan.json";
/// Maximum number of cases of a plan.
pub const CASES_MAX: u64 = 10_000_000;
/// Length of a plan up to which it is read at once.
const AT_ONCE_BYTES: u64 = 1 << 25;

/// Key of the cases in the file of a plan, up to their list.
const CASES_KEY: &[u8] = b"\n  \"cases\": ";
/// Length of the beginning of a plan's file in which this key is searched.
const HEAD_BYTES: u64 = 1 << 20;

/// The plan of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// BLAKE3 of everything below except names of files, hexadecimal.
    pub id: String,
    /// Name of the campaign.
    pub title: String,
    /// File of the campaign.
    pub campaign: PathBuf,
    /// Limits of a case.
    pub limits: CaseLimits,
    /// Early stopping.
    pub stop: Option<StopRule>,
    /// How often its results are looked at.
    #[serde(default, skip_serializing_if = "Looks::is_once")]
    pub looks: Looks,
    /// True if its seed comes from what it says, and wasn't given.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub seed_from_plan: bool,
    /// Names of the factors, in the order of the campaign.
    pub factors: Vec<String>,
    /// Requirements of the campaign's own file that are verified by runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub requirements: Vec<Planned>,
    /// Requirements of that file that no run can verify.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_by_test: Vec<String>,
    /// Accounts of the documents that this file came from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub accounts: Vec<Account>,
    /// Files of the campaign, if they came from a bundle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bundled: Option<BundledCampaign>,
    /// Folder with copies of the files, where the files themselves aren't there any more.
    #[serde(skip)]
    pub copies: Option<PathBuf>,
    /// The scenarios.
    pub scenarios: Vec<PlannedScenario>,
    /// Cases, in the order in which they are begun.
    #[serde(deserialize_with = "shared_cases::read")]
    pub cases: Vec<Case>,
}

/// Files of a campaign that came from a bundle, beside those of its scenarios.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BundledCampaign {
    /// The campaign's own file.
    pub campaign: PlannedFile,
    /// File of its requirements, if it names one.
    pub requirements: Option<PlannedFile>,
}

/// Content of a plan that makes its id: the plan without names of files, in the same form.
#[derive(Serialize)]
struct HashedPlan<'a, C: ?Sized> {
    schema: u32,
    id: &'static str,
    title: &'a str,
    campaign: &'static str,
    limits: CaseLimits,
    stop: &'a Option<StopRule>,
    #[serde(skip_serializing_if = "Looks::is_once")]
    looks: Looks,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    seed_from_plan: bool,
    factors: &'a [String],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    requirements: &'a [Planned],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    not_by_test: &'a [String],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    accounts: &'a [Account],
    scenarios: Vec<PlannedScenario>,
    cases: &'a C,
}

/// Limits of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseLimits {
    /// Time, s.
    pub time_s: f64,
    /// Address space, MiB.
    pub memory_mib: u64,
}

impl From<LimitsSpec> for CaseLimits {
    fn from(limits: LimitsSpec) -> Self {
        Self { time_s: limits.time_s, memory_mib: limits.memory_mib }
    }
}

/// Early stopping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StopRule {
    /// Requirement that decides.
    pub requirement: String,
    /// Evidence required.
    pub demand: Demand,
    /// Number of cases between evaluations, in the order of the plan.
    pub every: u64,
}

impl StopRule {
    /// Number of looks at a number of cases.
    #[must_use]
    pub fn looks(&self, cases: usize) -> u64 {
        (cases as u64).div_ceil(self.every.max(1)).max(1)
    }
}

impl From<StopSpec> for StopRule {
    fn from(stop: StopSpec) -> Self {
        Self {
            requirement: stop.requirement,
            demand: Demand { pass: stop.pass, confidence: stop.confidence },
            every: stop.every,
        }
    }
}

impl Plan {
    /// Reads a plan.
    ///
    /// # Errors
    /// If it can't be read, isn't a plan of this version, or was changed after it was made.
    pub fn read(path: &Path) -> Result<Self, PlanError> {
        let form = |reason: String| PlanError::Form { path: path.to_owned(), reason };
        let found: Result<Self, _> = json(path)?;
        // The version is in the first line: a plan of another one needs no second look.
        let version = match &found {
            Ok(plan) => Ok(plan.schema),
            Err(_) => json::<Version>(path)?.map(|version| version.schema),
        };
        let not_a_plan = |error| form(format!("expected a plan of a campaign: {error}"));
        let version = version.map_err(not_a_plan)?;
        if version != SCHEMA {
            return Err(form(format!(
                "found version {version}, this program reads version {SCHEMA}{}",
                if version > SCHEMA { ": a newer Octant wrote it" } else { "" }
            )));
        }
        let mut plan = found.map_err(not_a_plan)?;
        if !plan.has_id_of(path) {
            let hash = plan.hash();
            if hash != plan.id {
                return Err(form(format!(
                    "it was changed after it was made: its contents give the id {}, expected {}",
                    short(&hash),
                    short(&plan.id)
                )));
            }
        }
        if plan.seed_from_plan && plan.seed().is_some_and(|seed| seed != plan.own_seed()) {
            return Err(form(format!(
                "found {}, expected {} from what it says",
                plan.seed_in_words(),
                plan.own_seed()
            )));
        }
        if let Some(folder) = system("find", path, std::path::absolute(path))?.parent() {
            plan.place(folder);
        }
        Ok(plan)
    }

    /// Makes the names of files that are relative absolute: they start at the plan's folder.
    fn place(&mut self, folder: &Path) {
        let place = |file: &mut PathBuf| *file = folder.join(&*file);
        place(&mut self.campaign);
        if let Some(bundled) = &mut self.bundled {
            place(&mut bundled.campaign.file);
            bundled.requirements.iter_mut().for_each(|planned| place(&mut planned.file));
        }
        for scenario in &mut self.scenarios {
            place(&mut scenario.file);
            scenario.files.values_mut().for_each(|planned| place(&mut planned.file));
        }
    }

    /// Writes the plan as `plan.json` into a folder, which is created. An existing plan is kept if
    /// it is the same, and replaced if it is a part of this one and `extend` is set.
    ///
    /// # Errors
    /// If there is another plan, or the operating system refuses.
    pub fn write(&self, folder: &Path, extend: bool) -> Result<PlanWritten, PlanError> {
        let path = folder.join(FILE_NAME);
        let mut written = PlanWritten::New;
        let mut event = JournalEvent::Planned(self.in_journal());
        if path.exists() {
            let there = Self::read(&path)?;
            if there.id == self.id {
                return Ok(PlanWritten::There);
            }
            let ids: std::collections::HashSet<&str> = self.ids().collect();
            let gone = there.ids().filter(|id| !ids.contains(id)).count();
            let form = |reason: String| PlanError::Form { path: path.clone(), reason };
            if gone > 0 {
                return Err(form(format!(
                    "another plan is there, of which {gone} of {} cases are not in this one: expected \
                     an empty folder",
                    there.cases.len()
                )));
            }
            let looked = Journal::read(folder)?.cases_at_first_look().is_some();
            let is_prefix = self.ids().zip(there.ids()).all(|(new, old)| new == old);
            let is_same_claim = self.looks == there.looks
                && self.stop == there.stop
                && self.requirements == there.requirements;
            if extend && looked && !is_same_claim {
                return Err(form(
                    "it was looked at, and this plan has other looks or requirements: expected the same ones, or an \
                     empty folder"
                        .to_owned(),
                ));
            }
            if extend && looked && !is_prefix {
                return Err(form(
                    "it was looked at, and this plan has more cases of the draws that were seen: expected more \
                     replicates alone, or an empty folder"
                        .to_owned(),
                ));
            }
            if !extend {
                return Err(form(format!(
                    "a plan with {} of these {} cases is there: --extend takes it over, with its \
                     results",
                    there.cases.len(),
                    self.cases.len()
                )));
            }
            written = PlanWritten::Extended(self.cases.len() - there.cases.len());
            let (before, cases_before) = (there.id, there.cases.len());
            event = JournalEvent::Extended { before, cases_before, to: self.in_journal() };
        }
        system("create", folder, std::fs::create_dir_all(folder))?;
        octant_base::whole_file::clean(folder);
        let new = system("create a file in", folder, octant_base::whole_file::new_file(folder))?;
        let mut file = BufWriter::new(new.as_file());
        system("write", &path, self.write_json(&mut file).and_then(|()| file.flush()))?;
        drop(file);
        // Said before it is done: a plan that nobody wrote down would be one without looks.
        Journal::append(folder, event)?;
        system("write", &path, new.persist(&path).map_err(|error| error.error))?;
        Ok(written)
    }

    /// Writes the plan as it is in its file.
    fn write_json(&self, mut writer: impl Write) -> std::io::Result<()> {
        serde_json::to_writer_pretty(&mut writer, self)?;
        writer.write_all(b"\n")
    }

    /// Returns whether the id is that of the bytes of the cases in the plan's file, which takes a tenth of the time of
    /// writing them again. A file in another format has other bytes, and can still have the plan.
    fn has_id_of(&self, path: &Path) -> bool {
        let mut head = Vec::new();
        let content = self.hashed(&[(); 0]);
        if serde_json::to_writer_pretty(&mut head, &content).is_err() {
            return false;
        }
        let hash = || -> std::io::Result<Option<blake3::Hash>> {
            let mut file = std::fs::File::open(path)?;
            let mut start = Vec::new();
            Read::by_ref(&mut file).take(HEAD_BYTES).read_to_end(&mut start)?;
            // A text of JSON has no line feed: the key is one of the plan itself.
            let cases = start.windows(CASES_KEY.len()).position(|bytes| bytes == CASES_KEY);
            let Some((from, head)) = cases.zip(head.strip_suffix(b"[]\n}")) else {
                return Ok(None);
            };
            let mut hasher = blake3::Hasher::new();
            hasher.update(head).update(&start[from + CASES_KEY.len()..]);
            std::io::copy(&mut file, &mut hasher)?;
            Ok(Some(hasher.finalize()))
        };
        hash().is_ok_and(|hash| hash.is_some_and(|hash| hash.to_hex().as_str() == self.id))
    }

    fn ids(&self) -> impl Iterator<Item = &str> {
        self.cases.iter().map(|case| case.id.as_str())
    }

    /// Content of `plan.json`.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut text = Vec::new();
        // Values of these types can always be serialised, as text.
        let _ = self.write_json(&mut text);
        String::from_utf8(text).unwrap_or_default()
    }

    /// Computes the id from the contents, independent of the places of files.
    pub(super) fn hash(&self) -> String {
        self.hash_with(&self.cases)
    }

    /// Computes the id that the plan has with a list of cases in place of its own.
    pub(super) fn hash_with(&self, cases: &(impl Serialize + ?Sized)) -> String {
        let mut hasher = blake3::Hasher::new();
        // Values of these types can always be serialised, and a hash takes all bytes.
        let _ = serde_json::to_writer_pretty(BufWriter::new(&mut hasher), &self.hashed(cases));
        hasher.update(b"\n").finalize().to_hex().to_string()
    }

    /// Returns what makes the id, with a list of cases in place of its own.
    fn hashed<'a, C: ?Sized>(&'a self, cases: &'a C) -> HashedPlan<'a, C> {
        let Self { schema, id: _, title, campaign: _, limits, stop, factors, .. } = self;
        let Self { requirements, not_by_test, accounts, scenarios, looks, seed_from_plan, .. } =
            self;
        let placeless = |scenario: &PlannedScenario| PlannedScenario {
            file: PathBuf::new(),
            files: BTreeMap::new(),
            ..scenario.clone()
        };
        HashedPlan {
            schema: *schema,
            id: "",
            title,
            campaign: "",
            limits: *limits,
            stop,
            looks: *looks,
            seed_from_plan: *seed_from_plan,
            factors,
            requirements,
            not_by_test,
            accounts,
            scenarios: scenarios.iter().map(placeless).collect(),
            cases,
        }
    }

    /// Uses the copies in the folder of the campaign in place of files that are gone or were changed.
    pub fn use_copies(&mut self, folder: &Path) {
        self.copies = Some(folder.join(INPUTS));
        for scenario in &mut self.scenarios {
            if scenario.check_file().is_err() {
                *scenario = scenario.copied(folder);
            }
        }
    }

    /// Returns a case by its id.
    #[must_use]
    pub fn case(&self, id: &str) -> Option<&Case> {
        self.cases.iter().find(|case| case.id == id)
    }

    /// Returns the scenario of a case.
    ///
    /// # Errors
    /// If there is none of its name.
    pub fn planned(&self, case: &Case) -> Result<&PlannedScenario, PlanError> {
        let found = self.scenarios.iter().find(|scenario| scenario.id == case.scenario);
        found.ok_or_else(|| PlanError::Contradiction {
            campaign: self.campaign.clone(),
            reason: format!(
                "case {} is of scenario {:?}, which isn't there",
                case.id, case.scenario
            ),
        })
    }

    /// Returns the requirement on all cases together, for a requirement of the plan.
    pub(super) fn ensemble(&self, id: &str) -> Option<EnsembleRequirement> {
        self.requirements.iter().find(|planned| planned.check.id == id)?.ensemble
    }

    /// Checks that the scenarios' files, and all that came from a bundle, are those that were planned.
    ///
    /// # Errors
    /// If one can't be read, or was changed.
    pub fn check_files(&self) -> Result<(), PlanError> {
        if let Some(bundled) = &self.bundled {
            bundled.campaign.check()?;
            bundled.requirements.iter().try_for_each(PlannedFile::check)?;
        }
        self.scenarios.iter().try_for_each(PlannedScenario::check_file)
    }
}

/// Outcome of writing a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanWritten {
    /// Plan written where none was.
    New,
    /// The same plan was there already.
    There,
    /// The plan replaced a smaller one; holds the number of new cases.
    Extended(usize),
}

/// Reads a file as JSON: a long one piece by piece, a short one at once, which takes less time.
fn json<T: DeserializeOwned>(path: &Path) -> Result<serde_json::Result<T>, PlanError> {
    let mut file = system("read", path, std::fs::File::open(path))?;
    let bytes = system("read", path, file.metadata())?.len();
    let found = if bytes > AT_ONCE_BYTES {
        serde_json::from_reader(BufReader::with_capacity(1 << 16, file))
    } else {
        let mut text = Vec::new();
        system("read", path, file.read_to_end(&mut text))?;
        serde_json::from_slice(&text)
    };
    match found {
        Err(error) if error.is_io() => system("read", path, Err(error.into())),
        found => Ok(found),
    }
}

#[derive(Deserialize)]
struct Version {
    schema: u32,
}

/// Places of the cases of a plan by their ids: a sorted list, as a map of millions of cases would take ten
/// times the memory.
#[derive(Debug)]
pub(crate) struct CasePlaces<'a> {
    cases: &'a [Case],
    /// Places in the order of the ids.
    order: Vec<u32>,
}

impl<'a> CasePlaces<'a> {
    pub(crate) fn of(plan: &'a Plan) -> Self {
        let cases = plan.cases.as_slice();
        let mut order: Vec<u32> = (0..).take(cases.len()).collect();
        // The last case with an id counts.
        order.sort_unstable_by_key(|at| (cases[*at as usize].id, u32::MAX - at));
        Self { cases, order }
    }

    /// Returns the place of a case; `None` if the plan doesn't have it.
    pub(crate) fn get(&self, id: &str) -> Option<usize> {
        let id: CaseId = id.parse().ok()?;
        let case = |at: &u32| self.cases.get(*at as usize);
        let from = self.order.partition_point(|at| case(at).is_some_and(|case| case.id < id));
        let found = self.order.get(from).filter(|at| case(at).is_some_and(|case| case.id == id))?;
        Some(*found as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_in_another_format_is_the_same_plan_and_a_changed_one_is_refused() {
        let case = |seed: u64| Case {
            id: format!("{seed:016x}").parse().unwrap(),
            scenario: "a".into(),
            seed,
            replicate: 0,
            set: ["x=\"ü\""].into_iter().collect(),
            faults: None,
            factors: [("f".into(), factor_values::FactorValue::Number(0.1))].into_iter().collect(),
        };
        let mut plan = Plan {
            schema: SCHEMA,
            id: String::new(),
            title: "\n  \"cases\": ".to_owned(),
            campaign: "/campaign.toml".into(),
            limits: CaseLimits { time_s: 1.0, memory_mib: 1 },
            stop: None,
            looks: Looks::Planned(2),
            seed_from_plan: false,
            factors: vec!["f".to_owned()],
            requirements: Vec::new(),
            not_by_test: Vec::new(),
            accounts: Vec::new(),
            bundled: None,
            copies: None,
            scenarios: Vec::new(),
            cases: (0..3).map(case).collect(),
        };
        plan.id = plan.hash();
        let folder = tempfile::tempdir().unwrap();
        plan.write(folder.path(), false).unwrap();
        let path = folder.path().join(FILE_NAME);
        assert!(plan.has_id_of(&path));
        assert_eq!(Plan::read(&path).unwrap(), plan);
        std::fs::write(&path, serde_json::to_string(&plan).unwrap()).unwrap();
        assert!(!plan.has_id_of(&path));
        assert_eq!(Plan::read(&path).unwrap(), plan);
        let changed = plan.to_json().replace("\"seed\": 2", "\"seed\": 3");
        std::fs::write(&path, changed).unwrap();
        let error = Plan::read(&path).unwrap_err().to_string();
        assert!(error.contains("changed after it was made"), "{error}");
        std::fs::write(
            &path,
            plan.to_json().replace("\n  \"factors\"", "\n  \"cases\": [],\n  \"factors\""),
        )
        .unwrap();
        assert!(Plan::read(&path).is_err(), "two lists of cases");
    }
}
