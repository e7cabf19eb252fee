//! One case: run to its summary, and its result as a file.

pub use super::make::hash_of;
use super::plan::{Case, Plan, PlanError, PlannedScenario};
use crate::run::method::MethodError;
use crate::run::{Control, Recording, assemble, run_method};
use octant_requirements::{Comparison, Verdict};
use octant_scenario::Method;
use octant_score::rederive;
use octant_score::summary::Summary;
use octant_score::verdict::RequirementResult;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// Version of the file of a result.
pub const SCHEMA: u32 = 2;
/// The first version whose results hold the hashes of what they are made of; older ones are read without.
const CHAINED: u32 = 2;

/// What came of a case. Nothing of host or clock is in it, where it came to a summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseResult {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// The case.
    pub case: String,
    /// BLAKE3 of everything that makes the case, hexadecimal: its scenario, what is checked besides, what is
    /// set, its faults and its seed. Its first digits are the case's id. Null in files of version 1.
    #[serde(default)]
    pub case_blake3: Option<String>,
    /// BLAKE3 of the summary as [`hash_of_summary`] takes it; null without one.
    #[serde(default)]
    pub summary_blake3: Option<String>,
    /// The worst of everything: an error where the case came to no summary, inconclusive where it
    /// checks no requirement.
    pub verdict: Verdict,
    /// Why it came to no summary; null: it did.
    pub error: Option<String>,
    /// The summary of the run.
    pub summary: Option<Summary>,
}

/// Why a case gave no summary.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// Its scenario isn't the planned one, or not right.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// It could not be run.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// Its summary can't be written.
    #[error("write the summary: {0}")]
    Json(#[from] serde_json::Error),
}

/// What a process of its own is given, on its standard input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The case.
    pub case: Case,
    /// Its scenario.
    pub scenario: PlannedScenario,
    /// The most memory that it may have, MiB.
    pub memory_mib: u64,
    /// The folder of the campaign.
    pub folder: PathBuf,
}

/// Runs a case.
///
/// # Errors
/// If its scenario isn't the planned one, or can't be run.
pub fn run(
    planned: &PlannedScenario,
    case: &Case,
    control: &Control,
) -> Result<CaseResult, CaseError> {
    let scenario = planned.scenario(case)?;
    let one = |method| run_method(&scenario, method, case.seed, Recording::HashAlone, control);
    let primary = one(Method::Primary)?;
    let baseline = match &scenario.baseline {
        Some(_) => Some(one(Method::Baseline)?),
        None => None,
    };
    let summary = assemble(&scenario, case.seed, primary, baseline)?.summary;
    Ok(CaseResult::of(&case.id, Some(hash_of(planned, case)), summary)?)
}

/// BLAKE3 of a summary as JSON with sorted keys and without white space, hexadecimal: the same whoever wrote
/// the file around it, and with what a newer program may have added.
#[must_use]
pub fn hash_of_summary(summary: &serde_json::Value) -> String {
    blake3::hash(summary.to_string().as_bytes()).to_hex().to_string()
}

/// The verdict of a case whose run came to `verdict`: one that checks nothing shows nothing.
fn verdict_of(verdict: Verdict, summary: &Summary) -> Verdict {
    let nothing = summary.requirements.is_empty();
    verdict.worst(if nothing { Verdict::Inconclusive } else { Verdict::Pass })
}

impl CaseResult {
    /// The result of a case that came to a summary.
    ///
    /// # Errors
    /// If the summary can't be written as JSON.
    pub fn of(
        case: &str,
        case_blake3: Option<String>,
        summary: Summary,
    ) -> Result<Self, serde_json::Error> {
        Ok(Self {
            schema: SCHEMA,
            case: case.to_owned(),
            case_blake3,
            summary_blake3: Some(hash_of_summary(&serde_json::to_value(&summary)?)),
            verdict: verdict_of(summary.verdict, &summary),
            error: None,
            summary: Some(summary),
        })
    }

    /// The result of a case that came to no summary.
    #[must_use]
    pub fn broken(case: &str, error: String) -> Self {
        Self {
            schema: SCHEMA,
            case: case.to_owned(),
            case_blake3: None,
            summary_blake3: None,
            verdict: Verdict::Error,
            error: Some(error),
            summary: None,
        }
    }

    /// The verdict of a requirement in it: an error where it came to no summary, inconclusive where it
    /// wasn't checked.
    #[must_use]
    pub fn check(&self, requirement: &str) -> Verdict {
        let Some(summary) = &self.summary else { return Verdict::Error };
        let checks = summary.requirements.iter().filter(|check| check.id == requirement);
        // Checked more than once: all have to hold.
        checks.map(|check| check.verdict).reduce(Verdict::worst).unwrap_or(Verdict::Inconclusive)
    }

    /// The bytes of its file.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Reads the file of a result, and holds it against itself: its hashes, and its verdict against the
    /// values and limits in it.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub fn read(path: &Path) -> Result<Self, String> {
        let bytes =
            std::fs::read(path).map_err(|error| format!("read {}: {error}", path.display()))?;
        Self::from_bytes(path, &bytes)
    }

    /// [`CaseResult::read`] of a file whose bytes are there.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, String> {
        let result = Self::unjudged(path, bytes)?;
        match result.contradictions(bytes).as_slice() {
            [] => Ok(result),
            all => {
                Err(format!("read {}: it contradicts itself: {}", path.display(), all.join("; ")))
            }
        }
    }

    /// The result in the file of a case as it stands there: what it says of itself isn't to be believed
    /// before it was derived again.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub fn unjudged(path: &Path, bytes: &[u8]) -> Result<Self, String> {
        let form =
            |error| format!("read {}: expected the result of a case: {error}", path.display());
        // The version first: nothing else can be relied on in a newer one.
        let Version { schema } = serde_json::from_slice(bytes).map_err(form)?;
        if !(1..=SCHEMA).contains(&schema) {
            return Err(format!(
                "read {}: found version {schema}, this program reads versions 1 to {SCHEMA}{}",
                path.display(),
                if schema > SCHEMA { ": a newer Octant wrote it" } else { "" }
            ));
        }
        let result: Self = serde_json::from_slice(bytes).map_err(form)?;
        let name = path.file_name().map_or("".into(), |name| name.to_string_lossy());
        if name.split('.').next() != Some(result.case.as_str()) {
            return Err(format!(
                "read {}: it is the result of case {}, expected that of the case it is named for",
                path.display(),
                result.case
            ));
        }
        Ok(result)
    }

    /// Reads the result of a case of a plan in the folder of its campaign; with it comes the BLAKE3 of its
    /// file. `None`: it has none.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub fn of_plan(
        plan: &Plan,
        folder: &Path,
        case: &Case,
    ) -> Result<Option<(Self, String)>, String> {
        let path = file(folder, &case.id);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(format!("read {}: {error}", path.display())),
        };
        let result = Self::from_bytes(&path, &bytes)?;
        if let Ok(planned) = plan.planned(case) {
            result.belongs(&path, planned, case)?;
        }
        Ok(Some((result, blake3::hash(&bytes).to_hex().to_string())))
    }

    /// That it is the result of a case of a plan, with its seed and checks.
    fn belongs(&self, path: &Path, planned: &PlannedScenario, case: &Case) -> Result<(), String> {
        let wrong = |what: &str, found: &str, expected: &str| {
            Err(format!("read {}: its {what} is {found}, the plan has {expected}", path.display()))
        };
        let Some(summary) = &self.summary else { return Ok(()) };
        if self.schema >= CHAINED {
            let expected = hash_of(planned, case);
            let found = self.case_blake3.as_deref().unwrap_or("none");
            if found != expected {
                return wrong("case_blake3", found, &expected);
            }
        }
        if summary.seed != case.seed {
            return wrong("seed", &summary.seed.to_string(), &case.seed.to_string());
        }
        for check in &planned.checks {
            let of_it = |result: &&RequirementResult| result.id == check.id;
            let same = |result: &&RequirementResult| {
                (result.measure.as_str(), result.comparison, result.limit)
                    == (check.measure.as_str(), check.comparison, check.limit)
            };
            let mut found = summary.requirements.iter().filter(of_it).peekable();
            // One that isn't there is told as not checked.
            if let Some(first) = found.peek().copied()
                && !found.any(|result| same(&result))
            {
                let sign =
                    |comparison: Comparison, limit: f64| format!("{} {limit}", comparison.sign());
                return wrong(
                    &format!("requirement {}", check.id),
                    &format!("{} {}", first.measure, sign(first.comparison, first.limit)),
                    &format!("{} {}", check.measure, sign(check.comparison, check.limit)),
                );
            }
        }
        Ok(())
    }

    /// Where it contradicts itself.
    fn contradictions(&self, bytes: &[u8]) -> Vec<String> {
        let mut found = Vec::new();
        if let Some(hash) = self.case_blake3.as_ref().filter(|hash| !hash.starts_with(&self.case)) {
            found.push(format!("its case_blake3 {hash} is not that of case {}", self.case));
        }
        let Some(summary) = &self.summary else {
            if self.verdict != Verdict::Error {
                found.push(format!("it says {} without a summary", self.verdict.name()));
            }
            return found;
        };
        if self.schema >= CHAINED {
            let hash = serde_json::from_slice::<serde_json::Value>(bytes)
                .ok()
                .and_then(|mut all| Some(hash_of_summary(&all.get_mut("summary")?.take())));
            if hash != self.summary_blake3 {
                let none = || "none".to_owned();
                found.push(format!(
                    "its summary_blake3 is {}, its summary gives {}",
                    self.summary_blake3.clone().unwrap_or_else(none),
                    hash.unwrap_or_else(none)
                ));
            }
        }
        found.extend(rederive::contradictions(summary));
        let expected = match &self.error {
            None => verdict_of(summary.verdict, summary),
            Some(_) => Verdict::Error,
        };
        if self.verdict != expected {
            let [said, expected] = [self.verdict, expected].map(Verdict::name);
            found.push(format!("it says {said}, its summary comes to {expected}"));
        }
        found
    }
}

#[derive(Deserialize)]
struct Version {
    schema: u32,
}

/// What became of a result that was to be kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kept {
    /// It is there now.
    New,
    /// It was there, the same to the byte.
    Same,
    /// Another one is there: the same case came to two results. This one is kept beside it.
    Differs(PathBuf),
}

/// File of the result of a case in the folder of its campaign.
#[must_use]
pub fn file(folder: &Path, id: &str) -> PathBuf {
    folder.join("cases").join(id.get(..2).unwrap_or("")).join(format!("{id}.json"))
}

/// Keeps a result: whole or not at all, and never over another one.
///
/// # Errors
/// If the system refuses.
pub fn keep(folder: &Path, id: &str, bytes: &[u8]) -> io::Result<Kept> {
    let path = file(folder, id);
    let parent = path.parent().unwrap_or(folder);
    std::fs::create_dir_all(parent)?;
    let new = super::new_file(parent)?;
    std::fs::write(new.path(), bytes)?;
    new.as_file().sync_data()?;
    match new.persist_noclobber(&path) {
        Ok(_) => Ok(Kept::New),
        Err(refused) if refused.error.kind() == io::ErrorKind::AlreadyExists => {
            if std::fs::read(&path)? == bytes {
                return Ok(Kept::Same);
            }
            let hash = blake3::hash(bytes).to_hex();
            let other = path.with_file_name(format!("{id}.differs-{}.json", &hash.as_str()[..8]));
            refused.file.persist(&other).map_err(|error| error.error)?;
            Ok(Kept::Differs(other))
        }
        Err(refused) => Err(refused.error),
    }
}
